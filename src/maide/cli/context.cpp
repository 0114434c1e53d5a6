// Standard output is checked after each piece: a result that did not arrive is no result.
#include "maide/cli/context.hpp"

#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "maide/base/printable.hpp"
#include "maide/base/write_failure.hpp"

namespace maide::cli {

void write_to_stdout(std::string_view text) {
  clear_progress_line();
  errno = 0;
  const bool written = std::fwrite(text.data(), 1, text.size(), stdout) == text.size();
  if (!written || std::fflush(stdout) != 0) {
    const int error = errno != 0 ? errno : EIO;
    throw_write_failure(
        "cannot write the result: " + std::generic_category().message(error) + " (standard output)",
        error);
  }
}

void write_error_line(std::string_view message) {
  clear_progress_line();
  const std::string line = "maide: " + one_line(message) + '\n';
  std::fputs(line.c_str(), stderr);
}

void write_data(std::string_view text) {
  if (::isatty(STDOUT_FILENO) == 1) {
    write_to_stdout(printable(text));
  } else {
    write_to_stdout(text);
  }
}

Context::Context(const CommonOptions& options, std::stop_token stop)
    : options_(options), stop_(std::move(stop)), progress_(!options.quiet && !options.json) {}

RunControl Context::control() {
  RunControl control;
  control.stop = stop_;
  control.progress = &progress_;
  return control;
}

void Context::print(std::string_view text) {
  if (!options_.json) write_to_stdout(printable(text));
}

void Context::print_data(std::string_view text) {
  if (!options_.json) write_data(text);
}

void Context::set_result(const Json& object) {
  if (result_) throw std::logic_error("a command has one result");
  result_ = to_json_line(object);
}

void Context::complain(std::string_view message) { write_error_line(message); }

void Context::finish() {
  if (options_.json) write_data(result_.value_or("{}") + "\n");
}

}  // namespace maide::cli
