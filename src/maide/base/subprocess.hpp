// Other programs: spin, cc, dot, wrappers. No shell is involved. A program gets a process group of
// its own, so Ctrl-C reaches Maide alone. Maide then ends the program and everything that it
// started. The program also dies if Maide dies, in whatever way.
#pragma once

#include <sys/types.h>

#include <array>
#include <chrono>
#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "maide/base/run_control.hpp"

namespace maide {

struct ProgramStart {
  const std::vector<std::string>& command;         // see run_program()
  std::array<int, 3> standard;                     // its standard input, output and error
  std::filesystem::path folder;                    // to run in; empty: the current one
  std::map<std::string, std::string> environment;  // set beside this process's variables
};

// Starts the program and returns its number, which is that of its group. Throws std::system_error
// if it cannot be started; then nothing is left of it.
pid_t start_program(const ProgramStart& start);

struct SubprocessOptions {
  std::filesystem::path folder;                         // to run in; empty: the current one
  std::string input;                                    // for its standard input
  std::optional<std::chrono::milliseconds> time_limit;  // none: as long as it takes
  std::size_t output_limit = std::size_t{1} << 28;  // bytes of out and err; what is more is lost
};

struct SubprocessResult {
  int exit_status = 0;     // 128 + n if signal n ended it, as in a shell
  bool timed_out = false;  // it reached its time limit and was killed
  std::string out, err;    // standard output and standard error
  bool succeeded() const { return exit_status == 0 && !timed_out; }
};

// Runs it to its end and keeps what it prints.
// `command` is the program (found on PATH unless it has a '/') and its arguments. Throws UsageError
// if it cannot be started, Interrupted if `control` says stop; the program is dead then.
SubprocessResult run_program(const std::vector<std::string>& command,
                             const SubprocessOptions& options = {}, const RunControl& control = {});

}  // namespace maide
