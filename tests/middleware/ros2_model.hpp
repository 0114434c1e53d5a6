// What a service of ROS 2 should do, by one rule: a service is two topics, one for the requests and
// one for the answers. All clients get all answers; each throws away, when it receives, those that
// answer none of its own requests. Both topics keep the newest `depth`.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "maide/automata/mealy.hpp"

namespace maide::test {

struct Ros2Service {
  std::size_t depth = 1, clients = 1;
  bool tells_gaps = false;  // an answer, or a request, says whether one before it was lost
};

// The minimal machine over any of send, tryserve, handle, tryreceive, stop, start, ask, wait and
// call, which are the wrapper's inputs.
Mealy make_ros2_service(const Ros2Service& service, const std::vector<std::string>& inputs);

}  // namespace maide::test
