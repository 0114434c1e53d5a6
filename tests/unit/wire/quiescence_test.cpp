#include "maide/wire/observe/quiescence.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/prctl.h>
#include <sys/socket.h>

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include "busy_machine.hpp"
#include "maide/base/file.hpp"
#include "maide/wire/observe/socket_scan.hpp"
#include "maide/wire/observe/thread_scan.hpp"
#include "maide/wire/protocol/line_io.hpp"
#include "thread_chain.hpp"

namespace maide {
namespace {

using namespace std::chrono_literals;
using Clock = Quiescence::Clock;
using Verdict = Quiescence::Verdict;

Clock::time_point never() { return {}; }
bool not_aborted() { return false; }

QuiescenceSettings with_limit(std::chrono::milliseconds limit) {
  QuiescenceSettings settings;
  settings.limit = limit;
  return settings;
}

// The claim itself: after the verdict the work is done, whatever the scheduler does.
void expect_no_wrong_verdicts(std::size_t trials, std::uint64_t seed) {
  test::ThreadChain chain(4, seed);
  Quiescence quiescence(with_limit(60s));
  Random random(seed);
  std::size_t wrong = 0;
  for (std::size_t trial = 0; trial < trials; ++trial) {
    chain.start(1 + random.below(12));
    ASSERT_EQ(quiescence.wait(never, not_aborted), Verdict::quiescent);
    if (!chain.is_done()) ++wrong;
    // The next one must start from rest.
    while (!chain.is_done()) std::this_thread::yield();
  }
  EXPECT_EQ(wrong, 0u) << "of " << trials;
}

TEST(Quiescence, IsNeverSeenTooEarly) { expect_no_wrong_verdicts(4000, 1); }

TEST(Quiescence, IsNeverSeenTooEarlyUnderLoad) {
  const test::BusyMachine load(4);
  expect_no_wrong_verdicts(1000, 2);
}

TEST(Quiescence, ThreadsThatComeAndGoAreSeen) {
  Quiescence quiescence(with_limit(60s));
  for (int trial = 0; trial < 200; ++trial) {
    std::atomic<int> done = 0;
    constexpr int depth = 5;
    // Each thread starts the next one and ends: none of those at the first look does the work.
    const std::function<void(int)> descend = [&](int level) {
      if (level == depth) {
        done = 1;
        return;
      }
      std::thread([&descend, level] { descend(level + 1); }).join();
    };
    std::thread first([&] { descend(0); });
    ASSERT_EQ(quiescence.wait(never, not_aborted), Verdict::quiescent);
    EXPECT_EQ(done, 1);
    first.join();
  }
}

TEST(Quiescence, ASleepForASetTimeIsNotQuiescence) {
  Quiescence quiescence(with_limit(60s));
  for (int trial = 0; trial < 10; ++trial) {
    std::atomic<bool> awake = false;
    std::thread sleeper([&] {
      std::this_thread::sleep_for(20ms);
      awake = true;
    });
    ASSERT_EQ(quiescence.wait(never, not_aborted), Verdict::quiescent);
    EXPECT_TRUE(awake);
    sleeper.join();
  }
}

// A thread whose timers may be late by 5 ms waits for what never comes until a time that is past.
template <typename Clock>
void expect_late_waits_are_seen() {
  Quiescence quiescence(with_limit(60s));
  for (int trial = 0; trial < 20; ++trial) {
    std::atomic<bool> done = false;
    std::thread waiter([&] {
      ::prctl(PR_SET_TIMERSLACK, 5'000'000UL, 0UL, 0UL, 0UL);
      std::mutex mutex;
      std::condition_variable changed;
      std::unique_lock lock(mutex);
      const auto past = Clock::now();
      for (int i = 0; i < 3; ++i) changed.wait_until(lock, past);
      done = true;
    });
    ASSERT_EQ(quiescence.wait(never, not_aborted), Verdict::quiescent);
    EXPECT_TRUE(done);
    waiter.join();
  }
}

TEST(Quiescence, AWaitWhoseTimeIsPastIsNotQuiescence) {
  expect_late_waits_are_seen<std::chrono::steady_clock>();
  expect_late_waits_are_seen<std::chrono::system_clock>();
}

TEST(Quiescence, AWaitWhoseTimeHasNotComeIsQuiescence) {
  Quiescence quiescence(with_limit(60s));
  std::mutex mutex;
  std::condition_variable changed;
  bool is_over = false;
  std::atomic<bool> ended = false;
  std::thread waiter([&] {
    std::unique_lock lock(mutex);
    changed.wait_for(lock, 600s, [&] { return is_over; });
    ended = true;
  });
  EXPECT_EQ(quiescence.wait(never, not_aborted), Verdict::quiescent);
  EXPECT_FALSE(ended);
  {
    const std::scoped_lock lock(mutex);
    is_over = true;
  }
  changed.notify_one();
  waiter.join();
}

TEST(Quiescence, APollThatFindsNothingIsQuiescence) {
  Quiescence quiescence(with_limit(60s));
  std::atomic<bool> there = false;
  std::thread poller([&] {
    while (!there) std::this_thread::sleep_for(1ms);
  });
  ASSERT_EQ(quiescence.wait(never, not_aborted, [&] { return !there; }), Verdict::quiescent);
  EXPECT_FALSE(there);
  there = true;
  ASSERT_EQ(quiescence.wait(never, not_aborted, [&] { return !there; }), Verdict::quiescent);
  poller.join();
}

// A thread that computes until it is told to stop.
class Spinner {
 public:
  explicit Spinner(bool is_sdk_thread)
      : thread_([this, is_sdk_thread] {
          std::optional<SdkThread> own;
          if (is_sdk_thread) own.emplace();
          ready_ = true;
          while (!stop_) std::this_thread::yield();
        }) {
    while (!ready_) std::this_thread::yield();
  }
  ~Spinner() {
    stop_ = true;
    thread_.join();
  }

 private:
  std::atomic<bool> ready_ = false, stop_ = false;
  std::thread thread_;
};

TEST(Quiescence, WorkWithoutEndIsAHang) {
  const Spinner spinner(false);
  Quiescence quiescence(with_limit(30ms));
  EXPECT_EQ(quiescence.wait(never, not_aborted), Verdict::hang);
}

TEST(Quiescence, EndsWhenTold) {
  const Spinner spinner(false);
  Quiescence quiescence(with_limit(600s));
  int asked = 0;
  EXPECT_EQ(quiescence.wait(never, [&] { return ++asked > 20; }), Verdict::aborted);
}

TEST(Quiescence, TheSdksOwnThreadsDoNotCount) {
  const Spinner spinner(true);
  Quiescence quiescence(with_limit(60s));
  EXPECT_EQ(quiescence.wait(never, not_aborted), Verdict::quiescent);
}

// As many threads as before are not the same threads.
TEST(Quiescence, AThreadThatTakesAnSdkThreadsPlaceIsSeen) {
  Quiescence quiescence(with_limit(30ms));
  {
    const Spinner own(true);
    EXPECT_EQ(quiescence.wait(never, not_aborted), Verdict::quiescent);
  }
  const Spinner other(false);
  EXPECT_EQ(quiescence.wait(never, not_aborted), Verdict::hang);
}

TEST(Quiescence, AThreadThatTakesASleepingThreadsPlaceIsSeen) {
  Quiescence quiescence(with_limit(30ms));
  {
    const test::ThreadChain sleeping(1, 1);
    std::this_thread::sleep_for(10ms);
    for (int look = 0; look < 30; ++look) {
      ASSERT_EQ(quiescence.wait(never, not_aborted), Verdict::quiescent);
    }
  }
  const Spinner other(false);
  EXPECT_EQ(quiescence.wait(never, not_aborted), Verdict::hang);
}

TEST(Quiescence, TheFloorCoversTimersThatNobodySees) {
  QuiescenceSettings settings = with_limit(60s);
  settings.floor = 500ms;
  Quiescence quiescence(settings);
  std::mutex mutex;
  std::condition_variable timer;
  std::atomic<Clock::time_point> last_event = Clock::time_point();
  std::thread protocol([&] {
    std::unique_lock lock(mutex);
    timer.wait_for(lock, 20ms, [] { return false; });
    last_event = Clock::now();
  });
  EXPECT_EQ(quiescence.wait([&] { return last_event.load(); }, not_aborted), Verdict::quiescent);
  EXPECT_NE(last_event.load(), Clock::time_point());
  protocol.join();
}

TEST(Quiescence, AFixedDelayDoesNotLook) {
  const Spinner spinner(false);
  QuiescenceSettings settings;
  settings.observed = false;
  settings.delay = 1ms;
  Quiescence quiescence(settings);
  EXPECT_EQ(quiescence.wait(never, not_aborted), Verdict::quiescent);
}

// Two ends of a TCP connection over loopback.
struct TcpPair {
  Descriptor writer, reader;
  TcpPair() {
    const Descriptor listener(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    auto* generic = reinterpret_cast<sockaddr*>(&address);
    EXPECT_EQ(::bind(listener.get(), generic, size), 0);
    EXPECT_EQ(::listen(listener.get(), 1), 0);
    EXPECT_EQ(::getsockname(listener.get(), generic, &size), 0);
    writer = Descriptor(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
    EXPECT_EQ(::connect(writer.get(), generic, size), 0);
    reader = Descriptor(::accept4(listener.get(), nullptr, nullptr, SOCK_CLOEXEC));
  }
};

TEST(SocketScan, BytesThatCannotArriveAreInFlightAndThenAtRest) {
  const TcpPair pair;
  SocketScan scan;
  SocketPicture picture;
  scan.take(picture);
  EXPECT_TRUE(scan.is_at_rest(picture));
  // Nobody reads: once both kernel buffers are full, bytes stay unacknowledged.
  const std::string block(65536, 'x');
  while (::send(pair.writer.get(), block.data(), block.size(), MSG_DONTWAIT) > 0) {
  }
  scan.take(picture);
  EXPECT_TRUE(picture.in_flight);
  EXPECT_FALSE(scan.is_at_rest(picture));
  bool is_at_rest = false;
  while (!is_at_rest) {
    std::this_thread::sleep_for(10ms);
    scan.take(picture);
    is_at_rest = scan.is_at_rest(picture);
  }
  EXPECT_TRUE(picture.in_flight);
}

// After the first few, TCP acknowledges what nobody answers only after some 40 ms.
TEST(SocketScan, BytesThatArrivedAreNotInFlightWhateverIsAcknowledged) {
  const TcpPair pair;
  const int at_once = 1;
  ASSERT_EQ(::setsockopt(pair.writer.get(), IPPROTO_TCP, TCP_NODELAY, &at_once, sizeof at_once), 0);
  SocketScan scan;
  SocketPicture picture;
  for (int sent = 1; sent <= 100; ++sent) {
    EXPECT_TRUE(write_all(pair.writer.get(), "x"));
    const auto has_arrived = [&](const SocketPicture::Socket& socket) {
      return socket.descriptor == pair.reader.get() &&
             socket.arrived == static_cast<std::uint64_t>(sent);
    };
    do {
      scan.take(picture);
    } while (std::none_of(picture.sockets.begin(), picture.sockets.end(), has_arrived));
    scan.take(picture);  // the one before was perhaps half taken when it arrived
    ASSERT_FALSE(picture.in_flight) << sent;
  }
}

// The end of a connection counts as a byte that was received, not as one that was sent.
TEST(SocketScan, AClosedConnectionIsAtRest) {
  TcpPair pair;
  EXPECT_TRUE(write_all(pair.writer.get(), "hello"));
  ASSERT_EQ(::shutdown(pair.writer.get(), SHUT_WR), 0);
  char text[8];
  while (::recv(pair.reader.get(), text, sizeof text, 0) > 0) {
  }
  SocketScan scan;
  SocketPicture picture;
  scan.take(picture);
  EXPECT_FALSE(picture.in_flight);
  EXPECT_TRUE(write_all(pair.reader.get(), "farewell"));
  while (::recv(pair.writer.get(), text, 1, MSG_PEEK | MSG_DONTWAIT) <= 0) {
  }
  scan.take(picture);
  EXPECT_FALSE(picture.in_flight);
}

TEST(SocketScan, SeesArrivedBytesAndIgnoresWhatItIsTold) {
  const TcpPair pair;
  SocketScan scan;
  SocketPicture before, after;
  scan.take(before);
  EXPECT_TRUE(write_all(pair.writer.get(), "hello"));
  scan.take(after);
  EXPECT_FALSE(before == after);
  SocketScan blind;
  blind.ignore(pair.writer.get());
  blind.ignore(pair.reader.get());
  blind.take(after);
  EXPECT_EQ(before.sockets.size(), after.sockets.size() + 2);
}

TEST(SocketScan, LeavesTheSdksDescriptorsOut) {
  const TcpPair pair;
  SocketScan scan;
  SocketPicture all, rest;
  scan.take(all);
  {
    const SdkDescriptor own(pair.writer.get());
    scan.take(rest);
    EXPECT_EQ(rest.sockets.size() + 1, all.sockets.size());
  }
  scan.take(rest);
  EXPECT_EQ(rest, all);
}

TEST(SocketScan, TakeAgainSeesWhatArrives) {
  const TcpPair stream;
  int local[2], datagrams[2];
  ASSERT_EQ(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, local), 0);
  ASSERT_EQ(::socketpair(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0, datagrams), 0);
  const Descriptor ends[] = {Descriptor(local[0]), Descriptor(local[1]), Descriptor(datagrams[0]),
                             Descriptor(datagrams[1])};
  SocketScan scan;
  SocketPicture before, after;
  for (const int writer : {stream.writer.get(), local[0], datagrams[0]}) {
    scan.take(before);
    scan.take_again(after);
    EXPECT_EQ(before, after);
    EXPECT_TRUE(write_all(writer, "hello"));
    scan.take_again(after);
    EXPECT_FALSE(before == after);
  }
}

// One number stands for one kind of thing after the other, as when it is closed and given anew.
TEST(SocketScan, ANumberThatStandsForSomethingElseIsSeen) {
  const TcpPair first, second;
  int local[2];
  ASSERT_EQ(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, local), 0);
  const Descriptor local_end(local[0]), other_local_end(local[1]);
  const Descriptor file(::open("/dev/null", O_RDONLY | O_CLOEXEC));
  const Descriptor datagrams(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  EXPECT_TRUE(write_all(first.writer.get(), "hello"));
  EXPECT_TRUE(write_all(second.writer.get(), "hi"));
  EXPECT_TRUE(write_all(local[0], "farewell"));
  const Descriptor number(::fcntl(file.get(), F_DUPFD_CLOEXEC, 100));
  // What has arrived there; nothing where it is no socket.
  const std::pair<int, std::optional<std::uint64_t>> things[] = {{file.get(), std::nullopt},
                                                                 {first.reader.get(), 5},
                                                                 {local[1], 8},
                                                                 {datagrams.get(), 0},
                                                                 {second.reader.get(), 2}};
  SocketScan scan;
  SocketPicture picture;
  for (const auto& [old, unused] : things) {
    for (const auto& [next, arrived] : things) {
      ASSERT_EQ(::dup3(old, number.get(), O_CLOEXEC), number.get());
      scan.take(picture);
      ASSERT_EQ(::dup3(next, number.get(), O_CLOEXEC), number.get());
      scan.take(picture);
      const auto found =
          std::find_if(picture.sockets.begin(), picture.sockets.end(),
                       [&](const auto& socket) { return socket.descriptor == number.get(); });
      ASSERT_EQ(found != picture.sockets.end(), arrived.has_value());
      if (arrived) {
        EXPECT_EQ(found->arrived, *arrived);
      }
    }
  }
}

}  // namespace
}  // namespace maide
