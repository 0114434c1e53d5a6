// TCP ports for YARP's ports. Left to itself YARP takes 10002 and up in every process, so that
// wrappers side by side collide; here the kernel names a free one, and a process uses it again
// once the pair that had it is closed: a long run needs few.
#pragma once

#include <cstdint>
#include <mutex>
#include <vector>

namespace maide::yarp_ports {

class LoopbackPorts {
 public:
  // A port that no socket on this machine listens on. Another process may take it first: opening it
  // can fail, and is tried again with the next. Throws std::runtime_error if there is none.
  std::uint16_t take();
  void give_back(std::uint16_t port);

 private:
  std::mutex mutex_;
  std::vector<std::uint16_t> free_;
};

}  // namespace maide::yarp_ports
