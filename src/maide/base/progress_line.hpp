// A line on the terminal that says how far long work has come, rewritten in place. It exists only
// while standard error is a terminal, and gives way to everything else that is written there: call
// clear_progress_line() first (the log and the command line do).
#pragma once

#include <chrono>
#include <string>

#include "maide/base/run_control.hpp"

namespace maide {

class ProgressLine : public ProgressObserver {
 public:
  // At most one at a time is on the terminal. `enabled` false: shows nothing (-q, --json).
  explicit ProgressLine(bool enabled);
  ~ProgressLine() override;
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  // Draws at most ten times a second. Safe from any thread.
  void on_progress(const Progress& progress) override;

 private:
  bool enabled_;
  std::chrono::steady_clock::time_point last_drawn_{};
};

// Takes a progress line off the terminal, if one is there. Safe from any thread.
void clear_progress_line();

// "learning: 12 states, 340 words, 2100 symbols, 30 of 120"; counters that are zero are left out.
std::string to_string(const Progress& progress);

}  // namespace maide
