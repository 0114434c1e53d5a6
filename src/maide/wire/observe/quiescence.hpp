// Tells when a step has ended, that is, when the system under learning does nothing more of its own
// accord. Three things must hold. Every thread of its processes is asleep, at one instant. No bytes
// are on their way in its sockets. The floor has passed that the wrapper declares for its
// protocol's timers, which nobody can observe. For a middleware that polls, there is a fixed delay
// instead. Load makes an observation slower, never wrong; a fixed delay is wrong under load.
//
// Invariant of an observed verdict: at some instant after the input and after the last event, no
// thread of the system ran or was about to run.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>

namespace maide {

struct QuiescenceSettings {
  bool observed = true;
  std::chrono::milliseconds delay{0};     // the fixed delay, if not observed
  std::chrono::milliseconds floor{0};     // least time from the input and from the last event
  std::chrono::milliseconds limit{5000};  // longer than this: the step hangs
};

class Quiescence {
 public:
  using Clock = std::chrono::steady_clock;
  enum class Verdict : std::uint8_t { quiescent, hang, aborted };

  // Throws UsageError where observation is asked for and the kernel does not allow it.
  explicit Quiescence(QuiescenceSettings settings);
  ~Quiescence();

  // The SDK's own socket, not the system's.
  void ignore_socket(int descriptor);

  // Another process that belongs to the system: a child of this one.
  void watch_process(pid_t process);

  // Blocks until quiescence, the limit, or `is_aborted`. `last_event` is asked for the time of the
  // last event (any time in the past if there was none). The input has just been given. A thread in
  // a timed sleep is at rest only while `polls_in_vain` says so (SystemInstance::polls_in_vain).
  Verdict wait(const std::function<Clock::time_point()>& last_event,
               const std::function<bool()>& is_aborted,
               const std::function<bool()>& polls_in_vain = never);

  // One observation: was there an instant just now at which nothing was going on?
  bool observe(const std::function<bool()>& polls_in_vain = never);

 private:
  static bool never() { return false; }

  struct Scans;
  Verdict wait_observed(const std::function<Clock::time_point()>& last_event,
                        const std::function<bool()>& is_aborted,
                        const std::function<bool()>& polls_in_vain);
  Verdict wait_fixed(const std::function<bool()>& is_aborted) const;

  QuiescenceSettings settings_;
  std::unique_ptr<Scans> scans_;
};

}  // namespace maide
