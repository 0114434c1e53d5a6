// spdlog does the writing and the locking; this file decides the form of a line.
#include "maide/base/log.hpp"

#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

#include <memory>
#include <mutex>

#include "maide/base/printable.hpp"
#include "maide/base/progress_line.hpp"

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

}  // namespace maide
