// What a service of ROS 2 should do, by one rule: a service is two topics, one for the requests and
// one for the answers. All clients get all answers; each throws away, when it receives, those that
// answer none of its own requests. Both topics keep the newest `depth`. And what a topic alone does
// whose reads wait.
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

// The minimal machine over any of send, receive, tryreceive, serve, tryserve, answer, handle, stop,
// start, ask, wait and call, which are the wrapper's inputs. A receive or a serve that waits makes
// its client, or the server, refuse all else. `answer` is unexplored unless a request was served
// and neither answered nor forgotten by a stop.
Mealy make_ros2_service(const Ros2Service& service, const std::vector<std::string>& inputs);

// The minimal machine over write and read of a topic that keeps the newest `depth`; a read waits.
Mealy make_ros2_topic(std::size_t depth);

}  // namespace maide::test
