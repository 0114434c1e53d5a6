// Looks at a system that does what a look might be deceived by. A token goes from thread to thread
// by everything that wakes a thread: futexes, pipes, eventfds, sockets, new connections, new
// threads, limits that pass. Whoever holds it puts descriptors of other kinds under the numbers of
// old ones, and some of its bytes wait for Nagle's algorithm while all threads sleep. The token's
// own stamps tell the truth: a verdict is wrong if the token moved through all of its look.
//
// MAIDE_STRESS_SECONDS=<seconds a test> (3 if unset) makes long runs.
#include <arpa/inet.h>
#include <fcntl.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sched.h>
#include <semaphore.h>
#include <sys/epoll.h>
#include <sys/eventfd.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <condition_variable>
#include <cstdlib>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "busy_machine.hpp"
#include "maide/base/file.hpp"
#include "maide/base/random.hpp"
#include "maide/wire/observe/quiescence.hpp"

namespace maide {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

// Numbers for the system's descriptors, far from all others. Free ones carry junk of any kind.
class NumberPool {
 public:
  explicit NumberPool(Random& random) : random_(random) {}
  ~NumberPool() {
    for (int i = 0; i < size; ++i) ::close(first + i);
  }
  NumberPool(const NumberPool&) = delete;
  NumberPool& operator=(const NumberPool&) = delete;

  // Moves it to a number that is free, over the junk there.
  int place(Descriptor descriptor) {
    const int number = first + pick_free();
    EXPECT_EQ(::dup3(descriptor.get(), number, O_CLOEXEC), number);
    is_taken_[static_cast<std::size_t>(number - first)] = true;
    return number;
  }
  void release(int number) {
    is_taken_[static_cast<std::size_t>(number - first)] = false;
    put_junk(number);
  }
  void shuffle() { put_junk(first + pick_free()); }

 private:
  static constexpr int first = 300;
  static constexpr int size = 24;

  int pick_free() {
    while (true) {
      const auto place = random_.below(size);
      if (!is_taken_[place]) return static_cast<int>(place);
    }
  }
  void put_junk(int number) {
    const auto put = [number](int made) {
      const Descriptor junk(made);
      EXPECT_EQ(::dup3(junk.get(), number, O_CLOEXEC), number);
    };
    switch (random_.below(7)) {
      case 0: put(::open("/dev/null", O_RDONLY | O_CLOEXEC)); break;
      case 1: put(::eventfd(0, EFD_CLOEXEC)); break;
      case 2: put(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0)); break;
      case 3: put(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)); break;
      case 4: put(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)); break;
      case 5: put(::epoll_create1(EPOLL_CLOEXEC)); break;
      default: ::close(number);
    }
  }

  Random& random_;
  std::array<bool, size> is_taken_{};
};

// Where a thread waits for the token. One thread takes, whoever holds the token gives.
struct Inbox {
  virtual ~Inbox() = default;
  virtual void give() = 0;
  virtual void take() = 0;
  virtual void renumber() {}  // its descriptors; while nobody uses it
};

class ConditionInbox : public Inbox {
 public:
  // Waits in pieces that end by themselves, unless that is zero.
  explicit ConditionInbox(std::chrono::microseconds piece) : piece_(piece) {}
  void give() override {
    const std::scoped_lock lock(mutex_);
    is_there_ = true;
    changed_.notify_one();
  }
  void take() override {
    std::unique_lock lock(mutex_);
    while (!is_there_) {
      if (piece_ == 0us) {
        changed_.wait(lock);
      } else {
        changed_.wait_until(lock, Clock::now() + piece_);
      }
    }
    is_there_ = false;
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  bool is_there_ = false;
  std::chrono::microseconds piece_;
};

class SemaphoreInbox : public Inbox {
 public:
  SemaphoreInbox() { ::sem_init(&semaphore_, 0, 0); }
  ~SemaphoreInbox() override { ::sem_destroy(&semaphore_); }
  void give() override { ::sem_post(&semaphore_); }
  void take() override {
    while (::sem_wait(&semaphore_) != 0) {
    }
  }

 private:
  sem_t semaphore_{};
};

// Two descriptors, or one twice; eight bytes are a token.
class DescriptorInbox : public Inbox {
 public:
  DescriptorInbox(NumberPool& pool, Descriptor writer, Descriptor reader, bool polls)
      : pool_(pool),
        writer_(pool.place(std::move(writer))),
        reader_(pool.place(std::move(reader))),
        polls_(polls) {}
  ~DescriptorInbox() override {
    pool_.release(writer_);
    pool_.release(reader_);
  }
  void give() override { put(token); }
  void take() override {
    std::uint64_t read = 0;
    while (read != token) {
      pollfd ready{reader_, POLLIN, 0};
      if (polls_) ::poll(&ready, 1, -1);
      if (::read(reader_, &read, sizeof read) != sizeof read) std::abort();
    }
  }
  void renumber() override {
    for (int* number : {&writer_, &reader_}) {
      const int old = *number;
      *number = pool_.place(Descriptor(::fcntl(old, F_DUPFD_CLOEXEC, 0)));
      pool_.release(old);
    }
  }

 protected:
  static constexpr std::uint64_t token = 1, filling = 2;
  void put(std::uint64_t value) const {
    if (::write(writer_, &value, sizeof value) != sizeof value) std::abort();
  }

 private:
  NumberPool& pool_;
  int writer_, reader_;
  bool polls_;
};

struct SocketPair {
  Descriptor writer, reader;
};

SocketPair local_pair(int type) {
  int ends[2];
  EXPECT_EQ(::socketpair(AF_UNIX, type | SOCK_CLOEXEC, 0, ends), 0);
  return {Descriptor(ends[0]), Descriptor(ends[1])};
}

// Bound to a port of the loopback device, which it tells.
Descriptor bound_socket(int type, sockaddr_in& address) {
  Descriptor made(::socket(AF_INET, type | SOCK_CLOEXEC, 0));
  address = {};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  auto* generic = reinterpret_cast<sockaddr*>(&address);
  EXPECT_EQ(::bind(made.get(), generic, size), 0);
  if (type == SOCK_STREAM) {
    EXPECT_EQ(::listen(made.get(), 4), 0);
  }
  EXPECT_EQ(::getsockname(made.get(), generic, &size), 0);
  return made;
}

Descriptor connected_socket(int type, const sockaddr_in& address) {
  Descriptor made(::socket(AF_INET, type | SOCK_CLOEXEC, 0));
  EXPECT_EQ(::connect(made.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  return made;
}

SocketPair datagram_pair() {
  sockaddr_in address;
  Descriptor reader = bound_socket(SOCK_DGRAM, address);
  return {connected_socket(SOCK_DGRAM, address), std::move(reader)};
}

SocketPair stream_pair() {
  sockaddr_in address;
  const Descriptor listener = bound_socket(SOCK_STREAM, address);
  Descriptor writer = connected_socket(SOCK_STREAM, address);
  return {std::move(writer), Descriptor(::accept4(listener.get(), nullptr, nullptr, SOCK_CLOEXEC))};
}

// The token waits in the writer's buffer until what was sent before it is acknowledged, which takes
// some 40 ms in which nobody is awake.
class NagleInbox : public DescriptorInbox {
 public:
  NagleInbox(NumberPool& pool, SocketPair pair)
      : DescriptorInbox(pool, std::move(pair.writer), delaying(std::move(pair.reader)), false) {}
  void give() override {
    put(filling);
    put(token);
  }

 private:
  static Descriptor delaying(Descriptor reader) {
    const int at_once = 0;
    EXPECT_EQ(::setsockopt(reader.get(), IPPROTO_TCP, TCP_QUICKACK, &at_once, sizeof at_once), 0);
    return reader;
  }
};

// A new connection each time: while its thread waits in accept() it holds a number that no list
// shows.
class AcceptInbox : public Inbox {
 public:
  explicit AcceptInbox(NumberPool& pool)
      : pool_(pool), listener_(pool.place(bound_socket(SOCK_STREAM, address_))) {}
  ~AcceptInbox() override { pool_.release(listener_); }
  void give() override {
    const Descriptor sender = connected_socket(SOCK_STREAM, address_);
    if (::write(sender.get(), "t", 1) != 1) std::abort();
  }
  void take() override {
    const Descriptor accepted(::accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC));
    char byte = 0;
    if (::read(accepted.get(), &byte, 1) != 1) std::abort();
  }

 private:
  NumberPool& pool_;
  sockaddr_in address_{};
  int listener_;
};

// What the token did in one round.
class Truth {
 public:
  void start() {
    naps_ = 0;
    done_ = never;
  }
  void end() { done_ = now(); }
  bool is_done() const { return done_ != never; }
  // Whoever holds the token sleeps until that limit; to see it asleep before is to see rest.
  void nap(std::int64_t limit) {
    const std::size_t count = naps_;
    if (count == log_.size()) return;
    log_[count] = {now(), limit};
    naps_ = count + 1;
  }
  bool can_nap() const { return naps_ < log_.size(); }
  // Did the token move all the time between the two stamps?
  bool moved_from_to(std::int64_t from, std::int64_t to) const {
    if (done_ <= to) return false;
    for (std::size_t i = 0; i < naps_; ++i) {
      if (log_[i].start <= to && log_[i].limit >= from) return false;
    }
    return true;
  }
  static std::int64_t now() { return Clock::now().time_since_epoch().count(); }

 private:
  struct Nap {
    std::int64_t start = 0, limit = 0;
  };
  static constexpr std::int64_t never = INT64_MAX;
  std::array<Nap, 64> log_{};
  std::atomic<std::size_t> naps_ = 0;
  std::atomic<std::int64_t> done_ = 0;
};

class TokenSystem {
 public:
  explicit TokenSystem(std::uint64_t seed) : random_(seed), pool_(random_) {
    for (std::size_t i = 0; i < threads; ++i) inboxes_.push_back(make_inbox());
    for (std::size_t i = 0; i < threads; ++i) workers_.emplace_back([this, i] { work(i); });
  }
  ~TokenSystem() {
    is_ending_ = true;
    inboxes_.front()->give();
    for (std::thread& worker : workers_) worker.join();
  }
  TokenSystem(const TokenSystem&) = delete;
  TokenSystem& operator=(const TokenSystem&) = delete;

  // After the last round is over and its last thread went back to sleep.
  void start() {
    truth_.start();
    left_ = 1 + random_.below(12);
    inboxes_[random_.below(threads)]->give();
  }
  const Truth& truth() const { return truth_; }

 private:
  static constexpr std::size_t threads = 5;

  // All below is the token holder's: its random numbers, its descriptors, all inboxes.
  std::unique_ptr<Inbox> make_inbox() {
    const bool polls = random_.chance(0.5);
    const auto two_ends = [&](SocketPair pair) {
      return std::make_unique<DescriptorInbox>(pool_, std::move(pair.writer),
                                               std::move(pair.reader), polls);
    };
    switch (random_.below(40)) {
      case 0: return std::make_unique<NagleInbox>(pool_, stream_pair());
      case 1: return std::make_unique<ConditionInbox>(300us);
      default: break;
    }
    switch (random_.below(9)) {
      case 0: return std::make_unique<ConditionInbox>(random_.chance(0.5) ? 0us : 10'000'000us);
      case 1: return std::make_unique<SemaphoreInbox>();
      case 2: return std::make_unique<AcceptInbox>(pool_);
      case 3: return two_ends(stream_pair());
      case 4: return two_ends(datagram_pair());
      case 5: return two_ends(local_pair(SOCK_STREAM));
      case 6: return two_ends(local_pair(SOCK_DGRAM));
      case 7: {
        Descriptor event(::eventfd(0, EFD_CLOEXEC));
        Descriptor twin(::fcntl(event.get(), F_DUPFD_CLOEXEC, 0));
        return two_ends({std::move(event), std::move(twin)});
      }
      default: {
        int ends[2];
        EXPECT_EQ(::pipe2(ends, O_CLOEXEC), 0);
        return two_ends({Descriptor(ends[1]), Descriptor(ends[0])});
      }
    }
  }

  void work(std::size_t place) {
    while (true) {
      inboxes_[place]->take();
      if (is_ending_) {
        if (place + 1 < threads) inboxes_[place + 1]->give();
        return;
      }
      do_something(place);
      if (--left_ == 0) {
        truth_.end();
        continue;
      }
      std::size_t next = random_.below(threads - 1);
      if (next >= place) ++next;
      if (random_.chance(0.1)) {
        std::thread([&] { inboxes_[next]->give(); }).join();
      } else {
        inboxes_[next]->give();
      }
    }
  }

  void do_something(std::size_t place) {
    const std::uint64_t spins = random_.chance(0.1) ? random_.below(100'000) : random_.below(500);
    for (volatile std::uint64_t i = 0; i < spins;) i = i + 1;
    if (random_.chance(0.2)) std::this_thread::yield();
    if (random_.chance(0.03)) std::this_thread::sleep_for(50us);
    if (random_.chance(0.03)) wait_late();
    if (random_.chance(0.05) && truth_.can_nap()) nap();
    if (random_.chance(0.2)) pool_.shuffle();
    if (random_.chance(0.2)) inboxes_[place]->renumber();
    if (random_.chance(0.2)) {
      inboxes_[place].reset();
      inboxes_[place] = make_inbox();
    }
  }

  // Until a time that is past, with a timer that may be late.
  static void wait_late() {
    ::prctl(PR_SET_TIMERSLACK, 2'000'000UL, 0UL, 0UL, 0UL);
    wait_until(Clock::now());
    ::prctl(PR_SET_TIMERSLACK, 0UL, 0UL, 0UL, 0UL);
  }
  void nap() {
    const Clock::time_point limit = Clock::now() + 200us;
    truth_.nap(limit.time_since_epoch().count());
    wait_until(limit);
  }
  static void wait_until(Clock::time_point limit) {
    std::mutex mutex;
    std::condition_variable changed;
    std::unique_lock lock(mutex);
    changed.wait_until(lock, limit);
  }

  Random random_;
  NumberPool pool_;
  Truth truth_;
  std::uint64_t left_ = 0;
  std::atomic<bool> is_ending_ = false;
  std::vector<std::unique_ptr<Inbox>> inboxes_;
  std::vector<std::thread> workers_;
};

std::chrono::milliseconds time_for_a_test() {
  const char* seconds = std::getenv("MAIDE_STRESS_SECONDS");
  return seconds == nullptr ? 3s : std::chrono::seconds(std::atoi(seconds));
}

// Looks at round after round.
void expect_no_wrong_verdicts(std::uint64_t seed) {
#if defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "the system changes descriptors under the look, which the sanitizer calls a race";
#endif
  TokenSystem system(seed);
  Quiescence quiescence{QuiescenceSettings()};
  std::size_t rounds = 0, looks = 0, verdicts = 0, wrong = 0;
  const Clock::time_point end = Clock::now() + time_for_a_test();
  for (; Clock::now() < end; ++rounds) {
    system.start();
    const Clock::time_point began = Clock::now();
    bool is_over = false;
    while (!is_over) {
      ASSERT_LT(Clock::now() - began, 30s) << "no look ever found rest";
      const bool was_done = system.truth().is_done();
      const std::int64_t from = Truth::now();
      ++looks;
      if (quiescence.observe()) {
        ++verdicts;
        if (system.truth().moved_from_to(from, Truth::now())) ++wrong;
        is_over = was_done;
      } else {
        std::this_thread::sleep_for(20us);
      }
    }
  }
  EXPECT_EQ(wrong, 0u) << "of " << verdicts;
  EXPECT_GT(rounds, 20u);
  std::printf("%zu rounds, %zu looks, %zu of them found rest, %zu wrongly\n", rounds, looks,
              verdicts, wrong);
}

// All that this thread starts while it lives stays on one processor.
class OneProcessor {
 public:
  OneProcessor() {
    ::sched_getaffinity(0, sizeof before_, &before_);
    cpu_set_t one;
    CPU_ZERO(&one);
    CPU_SET(::sched_getcpu(), &one);
    ::sched_setaffinity(0, sizeof one, &one);
  }
  ~OneProcessor() { ::sched_setaffinity(0, sizeof before_, &before_); }
  OneProcessor(const OneProcessor&) = delete;
  OneProcessor& operator=(const OneProcessor&) = delete;

 private:
  cpu_set_t before_{};
};

TEST(LookStress, NoVerdictIsWrong) { expect_no_wrong_verdicts(1); }

TEST(LookStress, NoVerdictIsWrongBesideBusyProcesses) {
  const test::BusyMachine load(3);
  expect_no_wrong_verdicts(2);
}

TEST(LookStress, NoVerdictIsWrongOnOneProcessor) {
  const OneProcessor one;
  expect_no_wrong_verdicts(3);
}

TEST(LookStress, NoVerdictIsWrongOnOneProcessorBesideABusyProcess) {
  const OneProcessor one;
  const test::BusyMachine load(1);
  expect_no_wrong_verdicts(4);
}

}  // namespace
}  // namespace maide
