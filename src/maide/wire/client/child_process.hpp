// Child processes that live beside this one: a wrapper (`ChildProcess`), and a broker or name
// server that a wrapper needs (`ServiceProcess`). A child is in a process group of its own, so that
// Ctrl-C reaches Maide alone. It dies with Maide, however Maide ends, and what it started itself
// dies with it.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "maide/base/file.hpp"

namespace maide {

// A program whose standard input and output are pipes to this one; its standard error is kept.
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

// A process that a wrapper's system needs beside the wrapper's own: a broker, a name server. It is
// started by SystemWrapper::configure() and named in SystemSetup::processes; it dies with the
// wrapper, however that ends, kill -9 included.
class ServiceProcess {
 public:
  // `argv[0]` is found on PATH unless it has a '/'; `environment` is set for it beside what this
  // process has. What it prints is read and forgotten, but for the last lines. Throws
  // std::runtime_error, in a few words, if it cannot be started.
  explicit ServiceProcess(const std::vector<std::string>& argv,
                          const std::map<std::string, std::string>& environment = {});
  ~ServiceProcess();
  ServiceProcess(const ServiceProcess&) = delete;
  ServiceProcess& operator=(const ServiceProcess&) = delete;

  pid_t id() const;
  bool has_ended();
  // The last line that it printed on its standard error and that is not blank, or "".
  std::string last_error_line() const;

  // Returns once something takes connections at that port of the loopback. Throws
  // std::runtime_error, with the last line that it printed, if it ends before or does not within
  // the limit.
  void wait_for_tcp(std::uint16_t port, std::chrono::milliseconds limit);

 private:
  class Output;
  std::string name_;
  std::unique_ptr<Output> output_;
};

// A TCP port of 127.0.0.1 that was free a moment ago. Nobody can reserve one for another process:
// whoever loses the race for it asks for another. Throws std::system_error.
std::uint16_t free_loopback_port();

}  // namespace maide
