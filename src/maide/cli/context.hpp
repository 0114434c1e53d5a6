// What a command works with: the options that every command has, the stop token and progress line
// for long work, and the two ways to give a result - text for people, or one JSON object.
#pragma once

#include <optional>
#include <stop_token>
#include <string>
#include <string_view>

#include "maide/base/json.hpp"
#include "maide/base/progress_line.hpp"
#include "maide/base/run_control.hpp"

namespace maide::cli {

// Options of every command.
struct CommonOptions {
  bool json = false;     // --json
  bool quiet = false;    // -q
  bool verbose = false;  // -v
};

class Context {
 public:
  Context(const CommonOptions& options, std::stop_token stop);

  bool json() const noexcept { return options_.json; }
  bool quiet() const noexcept { return options_.quiet; }
  bool verbose() const noexcept { return options_.verbose; }

  // For long calls: Ctrl-C, the progress line, no deadline. Valid as long as the context is.
  RunControl control();

  // Result text for people, on standard output at once; nothing under --json. Throws UsageError if
  // standard output cannot be written to, Error (inconclusive) if the disk is full.
  void print(std::string_view text);
  // The same for a text that programs read (a model): as it is, but on a terminal.
  void print_data(std::string_view text);

  // The result for programs, printed when the command ends, and only under --json. Once a command.
  void set_result(const Json& object);

  // An error or a remark that ends nothing by itself: one line "maide: message" on standard error.
  void complain(std::string_view message);

  // Prints what set_result left and makes sure that all output has arrived.
  void finish();

 private:
  CommonOptions options_;
  std::stop_token stop_;
  ProgressLine progress_;
  std::optional<std::string> result_;  // the JSON line
};

// Writes to standard output and flushes it. Throws as Context::print.
void write_to_stdout(std::string_view text);

// The same; control characters of the text do not reach a terminal.
void write_data(std::string_view text);

// One error line "maide: message" on standard error; a progress line gives way to it and line
// breaks in the message become spaces.
void write_error_line(std::string_view message);

}  // namespace maide::cli
