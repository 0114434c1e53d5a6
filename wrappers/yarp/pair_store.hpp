// Fresh pairs of ports, made and closed a few at a time. Opening, connecting and closing is mostly
// waiting for YARP's own threads and connections; pairs do it side by side, while the system is not
// watched. Each pair that waits to be used costs a little at each look at the process's threads, so
// they are few.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "loopback_ports.hpp"
#include "port_pair.hpp"

namespace maide::yarp_ports {

class PairStore {
 public:
  // `prefix`: of the ports' names; no other process of the same name server has it.
  PairStore(Kind kind, std::string prefix, std::string carrier)
      : kind_(kind), prefix_(std::move(prefix)), carrier_(std::move(carrier)) {}

  // A pair that was never used. Throws std::runtime_error. Blocks for ever if closing a used one
  // does.
  std::unique_ptr<PortPair> take();
  // A pair that was used, and whose calls have all returned.
  void give_back(std::unique_ptr<PortPair> used) { used_.push_back(std::move(used)); }

 private:
  void refill();

  const Kind kind_;
  const std::string prefix_, carrier_;
  std::uint64_t made_ = 0;
  LoopbackPorts ports_;
  std::vector<std::unique_ptr<PortPair>> fresh_, used_;
};

}  // namespace maide::yarp_ports
