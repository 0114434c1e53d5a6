#include "delivery_race.hpp"

#include <fmt/core.h>
#include <poll.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <csignal>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <new>
#include <random>
#include <stdexcept>
#include <string>
#include <string_view>
#include <thread>

#include "maide/base/numbers.hpp"

namespace maide::deliveries {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

// In memory that both processes share.
struct Page {
  std::atomic<std::uint32_t> asked = 0;     // the round that the reader is ready for
  std::atomic<std::uint32_t> returned = 0;  // the round whose map is written: the call returned
  std::atomic<bool> is_over = false;
  std::atomic<pid_t> writer = 0, reader = 0;  // threads
  std::array<int, 2> pipe{};                  // a byte for each call that returned
};

// Connections that are matched may still lose what is written first, so round 0 is repeated until
// it comes.
constexpr std::chrono::milliseconds again{100}, start_limit{20'000};
// How long something that was sent may take: a reliable writer sends again what was lost.
constexpr std::chrono::milliseconds reliable_limit{10'000}, unreliable_limit{100};

void share_one_processor(pid_t thread) {
  cpu_set_t allowed, first;
  CPU_ZERO(&allowed);
  CPU_ZERO(&first);
  ::sched_getaffinity(thread, sizeof(allowed), &allowed);
  std::size_t number = 0;
  while (number + 1 < CPU_SETSIZE && !CPU_ISSET(number, &allowed)) ++number;
  CPU_SET(number, &first);
  ::sched_setaffinity(thread, sizeof(first), &first);
}

class Race {
 public:
  Race(const Settings& settings, Page& page)
      : page_(page),
        notice_(settings.text("notice", "topic")),
        size_(settings.number("size", 100)),
        rounds_(settings.number("rounds", 200)),
        library_is_slow_(settings.is("library", "slow", "normal")),
        limit_(settings.is_reliable() ? reliable_limit : unreliable_limit) {}

  void play_writer(Writer& writer) {
    page_.writer = ::gettid();
    while (page_.asked == 0) {
      if (page_.is_over) return;
      for (const Topic topic : both_topics) writer.write(topic, 0, size_of(topic));
      wait_until([this] { return page_.asked > 0; }, again);
    }
    slow_library_down();
    for (std::uint32_t round = 1; round <= rounds_; ++round) {
      while (page_.asked < round) {
        rest();
      }
      if (notice_ == "look") pause();
      writer.write(Topic::map, round, size_);
      if (notice_ != "call") writer.write(Topic::notice, round, size_of(Topic::notice));
      page_.returned = round;
      if (notice_ == "call") static_cast<void>(::write(page_.pipe[1], &round, 1) == 1);
    }
    // What is on its way is not to die with the writer.
    while (!page_.is_over) std::this_thread::sleep_for(1ms);
  }

  // The line to print.
  std::string play_reader(Reader& reader) {
    page_.reader = ::gettid();
    for (const Topic topic : both_topics) {
      if (!comes(reader, topic, 0, start_limit)) throw std::runtime_error("nothing comes");
    }
    // What was repeated, and is still on its way.
    std::this_thread::sleep_for(2 * again);
    for (const Topic topic : both_topics) static_cast<void>(reader.take(topic));
    slow_library_down();
    for (std::uint32_t round = 1; round <= rounds_; ++round) {
      page_.asked = round;
      notice_ == "look" ? look(reader, round) : miss(reader, round);
    }
    return fmt::format(R"({{"rounds": {}, "misses": {}, "late": {}, "lost": {}, "unnoticed": {}}})",
                       rounds_, late_ + lost_, late_, lost_, unnoticed_);
  }

 private:
  std::size_t size_of(Topic topic) const { return topic == Topic::map ? size_ : 4; }

  void slow_library_down() const {
    if (!library_is_slow_) return;
    for (const auto& task : std::filesystem::directory_iterator("/proc/self/task")) {
      const auto thread = static_cast<pid_t>(std::stol(task.path().filename()));
      if (thread == page_.writer || thread == page_.reader) {
        share_one_processor(thread);
      } else {
        slow_down(thread);
      }
    }
  }

  // While nothing but the library can go on.
  void rest() const {
    if (page_.is_over) throw std::runtime_error("the other end has ended");
    if (library_is_slow_) {
      std::this_thread::sleep_for(20us);
    } else {
      std::this_thread::yield();
    }
  }

  // Else all rounds would meet the look at the same place.
  void pause() {
    const auto end = Clock::now() + std::chrono::microseconds(random_() % longest_pause_us);
    while (Clock::now() < end) {
    }
  }

  template <typename Condition>
  static bool wait_until(const Condition& holds, std::chrono::milliseconds limit) {
    const auto end = Clock::now() + limit;
    while (!holds()) {
      if (Clock::now() > end) return false;
      std::this_thread::yield();
    }
    return true;
  }

  // Tries until `finds()` is true, or was still false so long after the writer's calls of this
  // round had returned.
  template <typename Finds>
  bool try_until(const Finds& finds, std::uint32_t round, std::chrono::milliseconds limit) const {
    std::optional<Clock::time_point> end;
    while (true) {
      if (!end && page_.returned >= round) end = Clock::now() + limit;
      if (finds()) return true;
      if (end && Clock::now() > *end) return false;
      rest();
    }
  }

  bool comes(Reader& reader, Topic topic, std::uint32_t round,
             std::chrono::milliseconds limit) const {
    return try_until([&] { return reader.take(topic) == round; }, round, limit);
  }

  // What the reader has of a round when it has the notice.
  void count(Reader& reader, std::uint32_t round, bool has_notice, bool has_map) {
    if (!has_notice) {
      ++unnoticed_;
      static_cast<void>(reader.take(Topic::map));
    } else if (!has_map) {
      ++(comes(reader, Topic::map, round, limit_) ? late_ : lost_);
    }
  }

  // Who sleeps meanwhile is woken at once, and before a slow library's threads.
  bool call_returns(std::uint32_t round) const {
    if (!library_is_slow_) wait_until([&] { return page_.returned == round; }, reliable_limit);
    pollfd byte{page_.pipe[0], POLLIN, 0};
    char read = 0;
    return ::poll(&byte, 1, static_cast<int>(reliable_limit.count())) == 1 &&
           ::read(page_.pipe[0], &read, 1) == 1;
  }

  // The notice, then the map.
  void miss(Reader& reader, std::uint32_t round) {
    const bool has_notice =
        notice_ == "call" ? call_returns(round) : comes(reader, Topic::notice, round, limit_);
    count(reader, round, has_notice, has_notice && reader.take(Topic::map) == round);
  }

  // Looks until one finds the notice. Only what a look found is taken.
  void look(Reader& reader, std::uint32_t round) {
    bool has_map = false;
    const auto finds_notice = [&] {
      const Found found = reader.look(0ms);
      if (found.map && reader.take(Topic::map) == round) has_map = true;
      return found.notice && reader.take(Topic::notice) == round;
    };
    const bool has_notice = try_until(finds_notice, round, limit_);
    count(reader, round, has_notice, has_map);
  }

  static constexpr std::uint32_t longest_pause_us = 200;

  Page& page_;
  std::mt19937 random_;
  const std::string notice_;
  const std::size_t size_;
  const std::uint32_t rounds_;
  const bool library_is_slow_;
  const std::chrono::milliseconds limit_;
  std::uint32_t late_ = 0, lost_ = 0, unnoticed_ = 0;
};

Page& make_page() {
  void* const memory =
      ::mmap(nullptr, sizeof(Page), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (memory == MAP_FAILED) throw std::bad_alloc();
  auto& page = *new (memory) Page;
  if (::pipe(page.pipe.data()) != 0) throw std::runtime_error("no pipe");
  return page;
}

// What goes wrong at one end is not to keep the other one waiting.
template <typename Part>
bool succeeds(Page& page, const Part& part) {
  try {
    part();
    return true;
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    page.is_over = true;
    return false;
  }
}

bool run_writer(const Settings& settings, Page& page, Middleware& middleware) {
  return succeeds(page, [&] {
    const std::unique_ptr<Writer> writer = middleware.make_writer();
    Race(settings, page).play_writer(*writer);
  });
}

bool run_reader(const Settings& settings, Page& page, Reader& reader) {
  return succeeds(page, [&] {
    fmt::print("{}\n", Race(settings, page).play_reader(reader));
    page.is_over = true;
  });
}

bool run_in_two_processes(const Settings& settings, Page& page, const Program& program) {
  const pid_t reader_process = ::getpid();
  const pid_t writer_process = ::fork();
  if (writer_process < 0) throw std::runtime_error("no second process");
  if (writer_process == 0) {
    // An end that is killed takes the other with it.
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    bool succeeded = ::getppid() == reader_process;
    succeeded = succeeded && succeeds(page, [&] {
                  const std::unique_ptr<Middleware> middleware = program.start(settings);
                  succeeded = run_writer(settings, page, *middleware);
                });
    std::_Exit(succeeded ? 0 : 1);
  }
  bool succeeded = succeeds(page, [&] {
    const std::unique_ptr<Middleware> middleware = program.start(settings);
    const std::unique_ptr<Reader> reader = middleware->make_reader();
    succeeded = run_reader(settings, page, *reader);
  });
  int status = 0;
  succeeded = ::waitpid(writer_process, &status, 0) == writer_process && status == 0 && succeeded;
  return succeeded;
}

bool run_in_one_process(const Settings& settings, Page& page, const Program& program) {
  return succeeds(page, [&] {
    const std::unique_ptr<Middleware> middleware = program.start(settings);
    const std::unique_ptr<Reader> reader = middleware->make_reader();
    bool has_written = false;
    std::thread writer([&] { has_written = run_writer(settings, page, *middleware); });
    const bool has_read = run_reader(settings, page, *reader);
    writer.join();
    if (!has_written || !has_read) throw std::runtime_error("not all rounds were played");
  });
}

}  // namespace

Settings::Settings(int count, const char* const* words) {
  for (int i = 1; i < count; ++i) {
    const std::string_view word = words[i];
    const std::size_t sign = word.find('=');
    if (sign == std::string_view::npos) throw std::runtime_error("settings are KEY=VALUE");
    values_[std::string(word.substr(0, sign))] = word.substr(sign + 1);
  }
}

std::string Settings::text(const std::string& key, const std::string& otherwise) const {
  const auto place = values_.find(key);
  return place == values_.end() ? otherwise : place->second;
}

std::uint32_t Settings::number(const std::string& key, std::uint32_t otherwise) const {
  const auto place = values_.find(key);
  if (place == values_.end()) return otherwise;
  const auto number = parse_number<std::uint32_t>(place->second);
  if (!number) throw std::runtime_error(key + " is a number");
  return *number;
}

void slow_down(pid_t thread) {
  share_one_processor(thread);
  const sched_param priority{};
  ::sched_setscheduler(thread, SCHED_IDLE, &priority);
}

int run(int count, char** words, const Program& program) {
  Page& page = make_page();
  const bool succeeded = succeeds(page, [&] {
    Settings settings(count, words);
    // Names that no other run has.
    settings.add("id", std::to_string(::getpid()));
    if (program.prepare) program.prepare(settings);
    const bool played = settings.has_two_processes() ? run_in_two_processes(settings, page, program)
                                                     : run_in_one_process(settings, page, program);
    if (!played) throw std::runtime_error("the race was not run to its end");
  });
  return succeeded ? 0 : 1;
}

}  // namespace maide::deliveries
