// One lock guards what is on the terminal; the line is cut at the terminal's width, because a line
// that wraps cannot be rewritten in place.
#include "maide/base/progress_line.hpp"

#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <mutex>
#include <string_view>

#include "maide/base/terminal.hpp"

namespace maide {

namespace {

std::mutex terminal_mutex;   // guards what follows
bool line_is_shown = false;  // a progress line stands on the terminal

bool stderr_is_terminal() {
  const char* terminal = std::getenv("TERM");
  return ::isatty(STDERR_FILENO) == 1 &&
         (terminal == nullptr || std::string_view(terminal) != "dumb");
}

}  // namespace

ProgressLine::ProgressLine(bool enabled) : enabled_(enabled && stderr_is_terminal()) {}

ProgressLine::~ProgressLine() { clear_progress_line(); }

void ProgressLine::on_progress(const Progress& progress) {
  if (!enabled_) return;
  const std::lock_guard lock(terminal_mutex);
  const auto now = std::chrono::steady_clock::now();
  if (now - last_drawn_ < std::chrono::milliseconds(100)) return;
  last_drawn_ = now;
  std::string text = to_string(progress);
  const std::size_t width = terminal_width(STDERR_FILENO).value_or(80);
  if (text.size() >= width) text.resize(width - 1);
  std::fprintf(stderr, "\r%s\033[K", text.c_str());
  std::fflush(stderr);
  line_is_shown = true;
}

void clear_progress_line() {
  const std::lock_guard lock(terminal_mutex);
  if (!line_is_shown) return;
  std::fputs("\r\033[K", stderr);
  std::fflush(stderr);
  line_is_shown = false;
}

std::string to_string(const Progress& progress) {
  std::string text(progress.phase);
  const char* separator = ": ";
  const auto add = [&](std::uint64_t count, std::string_view what) {
    if (count == 0) return;
    text += separator + std::to_string(count) + std::string(what);
    separator = ", ";
  };
  add(progress.states, progress.states == 1 ? " state" : " states");
  add(progress.words, progress.words == 1 ? " word" : " words");
  add(progress.symbols, progress.symbols == 1 ? " symbol" : " symbols");
  if (progress.total > 0) {
    text += separator + std::to_string(progress.done) + " of " + std::to_string(progress.total);
  } else {
    add(progress.done, " done");
  }
  return text;
}

}  // namespace maide
