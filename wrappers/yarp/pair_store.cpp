#include "pair_store.hpp"

#include <fmt/format.h>

#include <future>

namespace maide::yarp_ports {

std::unique_ptr<PortPair> PairStore::take() {
  const std::future<void> closed =
      std::async(std::launch::async, [used = std::move(used_)]() mutable { used.reset(); });
  auto pair =
      std::make_unique<PortPair>(kind_, fmt::format("{}/{}", prefix_, ++made_), carrier_, ports_);
  closed.wait();
  return pair;
}

}  // namespace maide::yarp_ports
