#include "pair_store.hpp"

#include <fmt/format.h>

#include <future>
#include <utility>

namespace maide::yarp_ports {
namespace {

constexpr std::size_t at_a_time = 4;

}  // namespace

std::unique_ptr<PortPair> PairStore::take() {
  if (fresh_.empty()) refill();
  auto pair = std::move(fresh_.back());
  fresh_.pop_back();
  return pair;
}

void PairStore::refill() {
  std::vector<std::future<void>> closed;
  std::vector<std::future<std::unique_ptr<PortPair>>> opened;
  for (auto& pair : used_) {
    closed.push_back(std::async(std::launch::async, [&pair] { pair.reset(); }));
  }
  for (std::size_t i = 0; i < at_a_time; ++i) {
    opened.push_back(
        std::async(std::launch::async, [this, name = fmt::format("{}/{}", prefix_, ++made_)] {
          return std::make_unique<PortPair>(kind_, name, carrier_, ports_);
        }));
  }
  for (std::future<void>& done : closed) done.get();
  used_.clear();
  for (auto& pair : opened) fresh_.push_back(pair.get());
}

}  // namespace maide::yarp_ports
