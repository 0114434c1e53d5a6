// Fresh pairs of ports, one for each word. Opening, connecting and closing is mostly waiting for
// YARP's own threads and connections, so the pair that was used is closed while the next is opened.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <utility>

#include "loopback_ports.hpp"
#include "port_pair.hpp"

namespace maide::yarp_ports {

class PairStore {
 public:
  // `prefix`: of the ports' names; no other process of the same name server has it.
  PairStore(Kind kind, std::string prefix, std::string carrier)
      : kind_(kind), prefix_(std::move(prefix)), carrier_(std::move(carrier)) {}

  // A pair that was never used. Throws std::runtime_error. Blocks for ever if closing the used one
  // does.
  std::unique_ptr<PortPair> take();
  // A pair that was used, and whose calls have all returned.
  void give_back(std::unique_ptr<PortPair> used) { used_ = std::move(used); }

 private:
  const Kind kind_;
  const std::string prefix_, carrier_;
  std::uint64_t made_ = 0;
  LoopbackPorts ports_;
  std::unique_ptr<PortPair> used_;
};

}  // namespace maide::yarp_ports
