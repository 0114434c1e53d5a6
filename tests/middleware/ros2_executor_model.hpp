// What an executor of rclcpp should do, by one rule: a thread that has nothing to do runs the first
// of what was ready at the last look and whose group is free; only when nothing of that is left
// does it look again, at the callbacks whose groups are free. A client is ready when any answer is
// in its queue; one that comes to answers to others takes all that are older than its first own
// one, or one over Fast DDS, and may have nothing to run.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "maide/automata/mealy.hpp"

namespace maide::test {

struct Ros2Executor {
  std::size_t subscriptions = 2, timers = 0, services = 0;
  std::size_t depth = 1, threads = 1;
  std::string spin = "once", groups = "one";  // as the wrapper's options say
  bool intraprocess = false;                  // subscriptions come after services
  std::size_t clients = 0;                    // of one service, which answers at once
  bool takes_one_by_one = false;              // what a client takes: Fast DDS
};

// The minimal machine over all of its inputs, in the wrapper's order.
Mealy make_ros2_executor(const Ros2Executor& executor);

struct Ros2Nested {
  std::size_t threads = 1, callers = 1;
  // "reentrant", or an exclusive group's name; of the server also "elsewhere".
  std::string caller_group = "a", client_group = "a", server_group = "elsewhere";
  bool spins = false;
};

// The same of kind=nested. Inputs that mean nothing are `unexplored`.
Mealy make_ros2_nested(const Ros2Nested& nested);

}  // namespace maide::test
