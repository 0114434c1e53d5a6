#include "maide/wire/observe/quiescence.hpp"

#include <sys/prctl.h>
#include <time.h>

#include <algorithm>

#include "maide/wire/observe/socket_scan.hpp"
#include "maide/wire/observe/thread_scan.hpp"

namespace maide {
namespace {

using namespace std::chrono_literals;

// Between scans: without a pause the scanning itself delays what it waits for.
constexpr std::chrono::nanoseconds shortest_pause = 20us;
constexpr std::chrono::nanoseconds longest_pause = 500us;
// A longer sleep is cut into pieces, so that a cancelled word ends at once.
constexpr std::chrono::nanoseconds sleep_piece = 5ms;

void sleep(std::chrono::nanoseconds duration) {
  // The default slack of 50 microseconds would more than double the shortest pause.
  thread_local const int slack = ::prctl(PR_SET_TIMERSLACK, 1UL, 0UL, 0UL, 0UL);
  static_cast<void>(slack);
  const timespec time{static_cast<time_t>(duration.count() / 1'000'000'000),
                      static_cast<long>(duration.count() % 1'000'000'000)};
  ::nanosleep(&time, nullptr);
}

}  // namespace

struct Quiescence::Scans {
  ThreadScan threads;
  SocketScan sockets;
  SocketPicture before, after;
};

Quiescence::Quiescence(QuiescenceSettings settings)
    : settings_(settings), scans_(settings.observed ? std::make_unique<Scans>() : nullptr) {}

Quiescence::~Quiescence() = default;

void Quiescence::ignore_socket(int descriptor) {
  if (scans_) scans_->sockets.ignore(descriptor);
}

void Quiescence::watch_process(pid_t process) {
  if (!scans_) return;
  scans_->threads.watch_process(process);
  scans_->sockets.watch_process(process);
}

bool Quiescence::observe(const std::function<bool()>& polls_in_vain) {
  const bool polls = polls_in_vain();
  if (!scans_->threads.begin(polls)) return false;
  scans_->sockets.take(scans_->before);
  if (!scans_->sockets.is_at_rest(scans_->before)) return false;
  sleep(shortest_pause);
  scans_->sockets.take_again(scans_->after);
  return scans_->before == scans_->after && scans_->threads.end() && polls == polls_in_vain();
}

Quiescence::Verdict Quiescence::wait(const std::function<Clock::time_point()>& last_event,
                                     const std::function<bool()>& is_aborted,
                                     const std::function<bool()>& polls_in_vain) {
  return settings_.observed ? wait_observed(last_event, is_aborted, polls_in_vain)
                            : wait_fixed(is_aborted);
}

Quiescence::Verdict Quiescence::wait_observed(const std::function<Clock::time_point()>& last_event,
                                              const std::function<bool()>& is_aborted,
                                              const std::function<bool()>& polls_in_vain) {
  const Clock::time_point start = Clock::now();
  std::chrono::nanoseconds pause = shortest_pause;
  while (true) {
    if (is_aborted()) return Verdict::aborted;
    const Clock::time_point now = Clock::now();
    if (now - start > settings_.limit) return Verdict::hang;
    const Clock::time_point due = std::max(start, last_event()) + settings_.floor;
    if (now < due) {
      sleep(std::min<std::chrono::nanoseconds>(due - now, sleep_piece));
      continue;
    }
    // An event during the observation moves the floor.
    if (observe(polls_in_vain) &&
        (settings_.floor == 0ms || last_event() + settings_.floor <= now)) {
      return Verdict::quiescent;
    }
    sleep(pause);
    // A system that works for long is looked at less often.
    if (now - start > 1ms) pause = std::min(pause + pause / 4, longest_pause);
  }
}

Quiescence::Verdict Quiescence::wait_fixed(const std::function<bool()>& is_aborted) const {
  const Clock::time_point end = Clock::now() + std::max(settings_.delay, settings_.floor);
  for (auto now = Clock::now(); now < end; now = Clock::now()) {
    if (is_aborted()) return Verdict::aborted;
    sleep(std::min<std::chrono::nanoseconds>(end - now, sleep_piece));
  }
  return Verdict::quiescent;
}

}  // namespace maide
