// Configurations of ROS 2's executors and of synchronous calls in callbacks, with the model that
// each must have.
#pragma once

#include <cstddef>
#include <ostream>
#include <string>
#include <vector>

#include "ros2_executor_model.hpp"
#include "wrapper_checks.hpp"

namespace maide::test {

struct Ros2ExecutorCase {
  std::string name;
  Ros2Executor executor;
  std::size_t states;  // of the minimal machine
  SystemOptions more;  // options that do not change the model

  SystemOptions options() const {
    SystemOptions all = more;
    all["kind"] = "executor";
    all["depth"] = std::to_string(executor.depth);
    all["subscriptions"] = std::to_string(executor.subscriptions);
    all["timers"] = std::to_string(executor.timers);
    all["services"] = std::to_string(executor.services);
    all["spin"] = executor.spin;
    all["groups"] = executor.groups;
    all["intraprocess"] = executor.intraprocess ? "on" : "off";
    all["executor_clients"] = std::to_string(executor.clients);
    if (executor.takes_one_by_one) all["rmw"] = "fastrtps";
    if (executor.threads > 1) {
      all["executor"] = "multi";
      all["threads"] = std::to_string(executor.threads);
    }
    return all;
  }
};

inline void PrintTo(const Ros2ExecutorCase& tested, std::ostream* out) { *out << tested.name; }

inline std::vector<Ros2ExecutorCase> ros2_executor_cases() {
  return {
      {"once", {2, 0, 0}, 6, {}},
      {"some", {2, 0, 0, 1, 1, "some"}, 4, {}},
      {"all", {2, 0, 0, 1, 1, "all"}, 4, {}},
      {"once_by_multi", {2, 0, 0}, 6, {{"executor", "multi"}}},
      {"once_own_groups", {2, 0, 0, 1, 1, "once", "own"}, 6, {}},
      {"once_two_contexts", {2, 0, 0}, 6, {{"contexts", "2"}}},
      {"depth_2", {2, 0, 0, 2}, 15, {}},
      {"three_subscriptions", {3, 0, 0}, 18, {}},
      {"four_subscriptions", {4, 0, 0}, 54, {}},
      {"timer_once", {2, 1, 0}, 18, {}},
      {"timer_and_three_subscriptions", {3, 1, 0}, 54, {}},
      {"two_timers", {2, 2, 0}, 54, {}},
      {"two_services", {2, 0, 2}, 54, {}},
      {"timer_some", {2, 1, 0, 1, 1, "some"}, 8, {}},
      {"service_once", {1, 0, 1}, 6, {}},
      {"one_of_each_some", {1, 1, 1, 1, 1, "some"}, 8, {}},
      {"intraprocess_some", {2, 1, 1, 1, 1, "some", "one", true}, 16, {}},
      {"client_once", {1, 0, 0, 1, 1, "once", "one", false, 1}, 6, {}},
      {"clients_once", {1, 0, 0, 1, 1, "once", "one", false, 2}, 34, {}},
      {"clients_own_groups", {1, 0, 0, 1, 1, "once", "own", false, 2}, 34, {}},
      {"clients_depth_2", {1, 0, 0, 2, 1, "once", "one", false, 2}, 123, {}},
      {"clients_some", {1, 0, 0, 2, 1, "some", "one", false, 2}, 21, {}},
      {"three_clients", {1, 0, 0, 1, 1, "once", "one", false, 3}, 128, {}},
      {"forever", {2, 0, 0, 1, 1, "forever"}, 11, {}},
      {"forever_one_group", {2, 0, 0, 1, 2, "forever", "one"}, 9, {}},
      {"forever_own_groups", {2, 0, 0, 1, 2, "forever", "own"}, 9, {}},
      {"forever_reentrant", {2, 0, 0, 1, 2, "forever", "reentrant"}, 19, {}},
      {"forever_timer", {1, 1, 0, 1, 1, "forever"}, 11, {}},
  };
}

// The middleware of a process is chosen once, so these have wrappers of their own.
inline std::vector<Ros2ExecutorCase> ros2_executor_cases_over_fastrtps() {
  return {
      {"clients_once", {1, 0, 0, 1, 1, "once", "one", false, 2, true}, 34, {}},
      {"clients_depth_2", {1, 0, 0, 2, 1, "once", "one", false, 2, true}, 177, {}},
      {"clients_some", {1, 0, 0, 2, 1, "some", "one", false, 2, true}, 21, {}},
  };
}

struct Ros2NestedCase {
  std::string name;
  Ros2Nested nested;
  bool hangs;  // one call of one callback
  std::size_t states;

  SystemOptions options() const {
    SystemOptions all{{"kind", "nested"},
                      {"callers", std::to_string(nested.callers)},
                      {"caller_group", nested.caller_group},
                      {"client_group", nested.client_group},
                      {"server_group", nested.server_group},
                      {"call", nested.spins ? "spin" : "wait"}};
    if (nested.threads > 1) {
      all["executor"] = "multi";
      all["threads"] = std::to_string(nested.threads);
    }
    return all;
  }
};

inline void PrintTo(const Ros2NestedCase& tested, std::ostream* out) { *out << tested.name; }

inline std::vector<Ros2NestedCase> ros2_nested_cases() {
  const std::string any = "reentrant", out = "elsewhere";
  return {
      {"single", {1, 1, "a", "a", out}, true, 3},
      {"single_apart", {1, 1, "a", "b", "c"}, true, 3},
      {"single_reentrant", {1, 1, any, any, any}, true, 3},
      {"multi_one_group", {4, 1, "a", "a", out}, true, 3},
      {"multi_client_apart", {4, 1, "a", "b", out}, false, 2},
      {"multi_reentrant", {4, 1, any, any, any}, false, 2},
      {"multi_server_in_callers_group", {4, 1, "a", "b", "a"}, true, 3},
      {"multi_server_in_a_third", {4, 1, "a", "b", "c"}, false, 2},
      {"spins", {1, 1, "a", "a", out, true}, false, 2},
      {"two_single", {1, 2, "a", "a", "a"}, true, 9},
      {"two_of_two_threads", {2, 2, any, any, any}, false, 7},
      {"two_of_four_threads", {4, 2, any, any, any}, false, 4},
      {"two_client_apart", {4, 2, "a", "b", "c"}, false, 5},
  };
}

}  // namespace maide::test
