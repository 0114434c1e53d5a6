// spdlog does the writing and the locking; this file decides the form of a line.
#include "maide/base/log.hpp"

#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cctype>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>

#include "maide/base/text.hpp"

namespace maide {
namespace {

std::shared_ptr<spdlog::logger> make_logger(const std::string& program, LogLevel level) {
  auto logger =
      std::make_shared<spdlog::logger>(program, std::make_shared<spdlog::sinks::stderr_sink_mt>());
  logger->set_pattern("%n: %v");
  logger->set_level(level == LogLevel::quiet    ? spdlog::level::warn
                    : level == LogLevel::normal ? spdlog::level::info
                                                : spdlog::level::debug);
  return logger;
}

std::mutex logger_mutex;

// The logger in use; replaced by set_up_log.
std::shared_ptr<spdlog::logger>& logger_slot() {
  static auto logger = make_logger("maide", LogLevel::normal);
  return logger;
}

void log(spdlog::level::level_enum level, std::string_view prefix, std::string_view message) {
  std::shared_ptr<spdlog::logger> logger;
  {
    const std::lock_guard lock(logger_mutex);
    logger = logger_slot();
  }
  if (!logger->should_log(level)) return;
  clear_progress_line();
  logger->log(level, "{}{}", prefix, one_line(message));
  logger->flush();
}

}  // namespace

void set_up_log(const std::string& program, LogLevel level) {
  const std::lock_guard lock(logger_mutex);
  logger_slot() = make_logger(program, level);
}

void log_warning(std::string_view message) { log(spdlog::level::warn, "warning: ", message); }
void log_note(std::string_view message) { log(spdlog::level::info, "", message); }
void log_detail(std::string_view message) { log(spdlog::level::debug, "", message); }

// One lock guards what is on the terminal; the line is cut at the terminal's width, because a line
// that wraps cannot be rewritten in place.

namespace {

std::mutex terminal_mutex;   // guards what follows, and the members of ProgressLine
bool line_is_shown = false;  // a progress line stands on the terminal

bool stderr_is_terminal() {
  const char* terminal = std::getenv("TERM");
  return ::isatty(STDERR_FILENO) == 1 &&
         (terminal == nullptr || std::string_view(terminal) != "dumb");
}

// "1200 words/s", "0.4 words/s".
std::string describe_rate(double words_per_second) {
  if (words_per_second >= 10) {
    return std::to_string(static_cast<std::uint64_t>(words_per_second)) + " words/s";
  }
  const auto tenths = static_cast<std::uint64_t>(words_per_second * 10);
  return std::to_string(tenths / 10) + "." + std::to_string(tenths % 10) + " words/s";
}

}  // namespace

ProgressLine::ProgressLine(bool enabled)
    : enabled_(enabled && stderr_is_terminal()), rate_start_(std::chrono::steady_clock::now()) {}

ProgressLine::~ProgressLine() { clear_progress_line(); }

void ProgressLine::on_progress(const Progress& progress) {
  if (!enabled_) return;
  const std::lock_guard lock(terminal_mutex);
  const auto now = std::chrono::steady_clock::now();
  if (now - last_drawn_ < std::chrono::milliseconds(100)) return;
  last_drawn_ = now;
  std::string text = to_string(progress);
  if (progress.words < words_at_start_ || progress.words == 0) {
    words_at_start_ = progress.words;
    rate_start_ = now;
  }
  const double seconds = std::chrono::duration<double>(now - rate_start_).count();
  if (seconds > 1 && progress.words > words_at_start_) {
    text += ", " + describe_rate(static_cast<double>(progress.words - words_at_start_) / seconds);
  }
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
    text += separator + counted(count, what);
    separator = ", ";
  };
  add(progress.states, "state");
  add(progress.words, "word");
  add(progress.symbols, "symbol");
  if (progress.total > 0) {
    text += separator + std::to_string(progress.done) + " of " + std::to_string(progress.total);
    if (progress.done < progress.total) {
      text += ", " + std::to_string(progress.total - progress.done) + " left";
    }
  } else if (progress.done > 0) {
    text += separator + std::to_string(progress.done) + " done";
  }
  return text;
}

std::optional<std::size_t> terminal_width(int descriptor) {
  constexpr std::size_t narrowest = 20;  // less is no answer
  winsize size{};
  if (::ioctl(descriptor, TIOCGWINSZ, &size) != 0 || size.ws_col < narrowest) return std::nullopt;
  return size.ws_col;
}

bool is_utf8_locale() {
  for (const char* name : {"LC_ALL", "LC_CTYPE", "LANG"}) {
    const char* value = std::getenv(name);
    if (value == nullptr || *value == '\0') continue;
    std::string locale;
    for (const char* c = value; *c != '\0'; ++c) {
      if (*c != '-') locale += static_cast<char>(std::tolower(static_cast<unsigned char>(*c)));
    }
    return locale.find("utf8") != std::string::npos;
  }
  return false;
}

}  // namespace maide
