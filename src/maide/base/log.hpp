// What a program says while it works: log lines, the progress line, and what the terminal can show.
// Log lines go to standard error, one line a message: "maide: warning: ...". Results never go here,
// nor do the errors that end a program.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "maide/base/run_control.hpp"

namespace maide {

enum class LogLevel : std::uint8_t {
  quiet,    // warnings only (-q)
  normal,   // and notes
  verbose,  // and details (-v)
};

// Names the program in every line and sets what is said. Without a call: "maide", normal.
void set_up_log(const std::string& program, LogLevel level);

void log_warning(std::string_view message);  // something may be wrong
void log_note(std::string_view message);     // worth knowing
void log_detail(std::string_view message);   // for those who asked with -v

// ---- The progress line ----
//
// A line on the terminal that says how far long work has come, rewritten in place. It exists only
// while standard error is a terminal. Whoever writes anything else there calls
// clear_progress_line() first, as the log and the command line do.
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
  // Words a second are counted from here.
  std::uint64_t words_at_start_ = 0;
  std::chrono::steady_clock::time_point rate_start_;
};

// Takes a progress line off the terminal, if one is there. Safe from any thread.
void clear_progress_line();

// "learning: 12 states, 340 words, 2100 symbols, 30 of 120"; counters that are zero are left out.
std::string to_string(const Progress& progress);

// ---- The terminal ----

// Columns of the terminal behind the descriptor; nothing if it is none or does not say.
std::optional<std::size_t> terminal_width(int descriptor);

// Whether the environment asks for UTF-8: the first of LC_ALL, LC_CTYPE and LANG that is set.
bool is_utf8_locale();

}  // namespace maide
