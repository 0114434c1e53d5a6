// Ctrl-C and `kill` as a stop token. The first SIGINT or SIGTERM asks for a clean stop; another one
// ends the process at once (exit status 3), unless it comes within a quarter of a second:
// timeout(1) signals the process and then its group, which is one request and not two.
#pragma once

#include <memory>
#include <stop_token>

namespace maide {

class Interrupt {
 public:
  // Installs the signal handlers. At most one in a process at a time (std::logic_error).
  Interrupt();
  // Puts the earlier handlers back.
  ~Interrupt();
  Interrupt(const Interrupt&) = delete;
  Interrupt& operator=(const Interrupt&) = delete;

  // Stops when the signal comes.
  std::stop_token token() const;

 private:
  class State;
  std::unique_ptr<State> state_;
};

}  // namespace maide
