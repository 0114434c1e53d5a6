// What every long call takes: a stop token, a deadline, and an observer of its progress. A long
// call tests `should_stop()` at least a few times a second. Then it ends by throwing Interrupted,
// or by returning a partial result where its contract says so. `Interrupt` makes a stop token of
// Ctrl-C.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <stop_token>
#include <string_view>

namespace maide {

// One report of how far a long call has come. Counters that do not apply are zero.
struct Progress {
  std::string_view phase;     // "learning", "testing", "checking", ...
  std::uint64_t states = 0;   // states of the hypothesis, or states explored
  std::uint64_t words = 0;    // words run on the system so far
  std::uint64_t symbols = 0;  // symbols sent to the system so far
  std::uint64_t done = 0;     // units of this phase done, of `total` (0: unknown)
  std::uint64_t total = 0;    // units of this phase in all
};

// Hears of progress, on the thread that works. It must return at once.
class ProgressObserver {
 public:
  virtual ~ProgressObserver() = default;
  virtual void on_progress(const Progress& progress) = 0;
};

// The time that many seconds from now.
inline std::chrono::steady_clock::time_point deadline_in(double seconds) {
  return std::chrono::steady_clock::now() +
         std::chrono::duration_cast<std::chrono::steady_clock::duration>(
             std::chrono::duration<double>(seconds));
}

struct RunControl {
  std::stop_token stop;
  std::optional<std::chrono::steady_clock::time_point> deadline;
  ProgressObserver* progress = nullptr;  // not owned; null: nobody is told

  bool should_stop() const {
    return stop.stop_requested() || (deadline && std::chrono::steady_clock::now() >= *deadline);
  }
  // Throws Interrupted if should_stop(); `what` names the work ("learning", "equivalence test").
  void check(std::string_view what) const;
  void report(const Progress& state) const {
    if (progress != nullptr) progress->on_progress(state);
  }
};

// Ctrl-C and `kill` as a stop token. The first SIGINT or SIGTERM asks for a clean stop. A later one
// ends the process at once (exit status 3), unless it comes within a quarter of a second.
// timeout(1) signals the process and then its group, and means one request.
class Interrupt {
 public:
  // Installs the signal handlers. At most one in a process at a time (std::logic_error).
  Interrupt();
  // Puts the earlier handlers back.
  ~Interrupt();
  Interrupt(const Interrupt&) = delete;
  Interrupt& operator=(const Interrupt&) = delete;

  // Stops when the signal comes.
  std::stop_token token() const;

 private:
  class State;
  std::unique_ptr<State> state_;
};

}  // namespace maide
