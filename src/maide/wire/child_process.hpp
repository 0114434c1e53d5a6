// A program that runs beside this one, for as long as this one wants: its standard input and output
// are pipes, its standard error is kept. It is in a process group of its own, so that Ctrl-C
// reaches Maide alone; it dies with Maide, however Maide ends; and what it started itself dies with
// it.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <map>
#include <string>
#include <vector>

#include "maide/base/descriptor.hpp"

namespace maide {

class ChildProcess {
 public:
  // `argv[0]` is found on PATH unless it has a '/'. Throws std::runtime_error, in a few words, if
  // it cannot be started.
  // `environment`: variables set for it, beside those of this process.
  explicit ChildProcess(const std::vector<std::string>& argv,
                        const std::map<std::string, std::string>& environment = {});
  // Kills what is left of it.
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  // None of them blocks.
  Descriptor input, output, errors;

  // Keeps the end of what is there on its standard error.
  void collect_errors();
  // The last line of its standard error that is not blank, or "".
  std::string last_error_line() const;

  // True once it has ended; waits for that at most so long.
  bool wait(std::chrono::milliseconds limit);
  // "exited with status 3", "was killed by signal 9 (Killed)"; only after it has ended.
  std::string describe_end() const;
  // Ends it, and what it started, at once.
  void kill();

  pid_t id() const { return id_; }

 private:
  pid_t id_ = -1;
  bool ended_ = false;
  int status_ = 0;
  std::string error_text_;
};

}  // namespace maide
