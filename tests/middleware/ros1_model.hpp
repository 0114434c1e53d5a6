// What one publisher and one subscriber of ROS 1 should do, written by hand from the sources of
// roscpp (its SubscriptionQueue and CallbackQueue): the minimal Mealy machine over any of the
// wrapper's inputs but `read`. Steps are far enough apart that the publisher's queue is never full;
// only a burst fills it, and where that matters there is no finite machine to write down.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "maide/automata/mealy.hpp"

namespace maide::test {

struct Ros1Model {
  std::size_t queue_size = 1;  // of the subscriber, at least 1
  bool latch = false;
  bool payload_gap = false;  // `next`, `gap` and `old` instead of `message`
  std::size_t burst = 10;    // messages of the input burst
};

// Outputs are the reader's: a message, `null`, and `failed` while the callback queue is disabled.
Mealy make_ros1_connection(const Ros1Model& model, const std::vector<std::string>& inputs);

}  // namespace maide::test
