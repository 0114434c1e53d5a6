// What every long call takes: a stop token (Ctrl-C), a deadline, and an observer of its progress.
// A long call tests `should_stop()` at least a few times a second and then ends by throwing
// Interrupted, or by returning a partial result where its contract says so.
#pragma once

#include <chrono>
#include <cstdint>
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

// Receives progress from the thread that works; must return at once.
class ProgressObserver {
 public:
  virtual ~ProgressObserver() = default;
  virtual void on_progress(const Progress& progress) = 0;
};

// So many seconds from now.
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

}  // namespace maide
