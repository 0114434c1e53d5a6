// What became of requests and answers along a run: whose pushed out whose, and at which step. A
// service keeps the last few in each direction, so one that comes pushes out the oldest.
//
// It is read off what the service holds before and after each step (ServiceContents).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "maide/check/system/system.hpp"
#include "maide/check/system/trace.hpp"

namespace maide {

struct ServiceLoss {
  std::size_t step = 0;      // index into the trace
  bool is_answer = false;    // an answer; else a request
  std::uint32_t client = 0;  // whose it was, by its number at the service
  // The client whose request, or the answer to whom, pushed it out; none: an answer to some other
  // client, which came after a while.
  std::optional<std::uint32_t> by;
  std::size_t count = 1;
};

// The losses in one service, in the order of the run. `states` are replay()'s. None where it is not
// known what the service holds. O(steps).
std::vector<ServiceLoss> find_service_losses(const System& system, const Trace& trace,
                                             const std::vector<GlobalState>& states,
                                             std::uint32_t model);

// The service whose model that is; null: it is none.
const ServiceInstance* find_service(const System& system, std::uint32_t model);
// The number of its client of that name, a program or a node.
std::optional<std::uint32_t> client_named(const ServiceInstance& service, const std::string& name);

}  // namespace maide
