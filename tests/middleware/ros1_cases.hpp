// Configurations of ROS 1, and the model that each must have.
#pragma once

#include <ostream>
#include <string>
#include <vector>

#include "ros1_model.hpp"
#include "wrapper_checks.hpp"

namespace maide::test {

struct Ros1Case {
  std::string name;
  Ros1Model model;
  std::vector<std::string> inputs;
  std::size_t states;  // of the minimal machine
  SystemOptions more;  // options that do not change the model

  SystemOptions options() const {
    SystemOptions all = more;
    all["queue_size"] = std::to_string(model.queue_size);
    all["latch"] = model.latch ? "true" : "false";
    all["payload"] = model.payload_gap ? "gap" : "none";
    all["burst"] = std::to_string(model.burst);
    all["observe"] = "message,null,failed";
    for (const std::string& input : inputs) {
      all["inputs"] += (all["inputs"].empty() ? "" : ",") + input;
    }
    return all;
  }
};

inline void PrintTo(const Ros1Case& tested, std::ostream* out) { *out << tested.name; }

inline std::vector<Ros1Case> ros1_cases() {
  const std::vector<std::string> plain{"write", "tryread"};
  const std::vector<std::string> reconnect{"write", "tryread", "disconnect", "connect"};
  const std::vector<std::string> interrupt{"write", "tryread", "interrupt", "resume"};
  const SystemOptions shortcut{{"transport", "intraprocess"}};
  std::vector<Ros1Case> all;
  for (std::size_t n = 1; n <= 3; ++n) {
    const std::string size = std::to_string(n);
    all.push_back({"queue_" + size, {n, false, false}, plain, n + 1, {}});
    all.push_back({"queue_gap_" + size, {n, false, true}, plain, n + 2, {}});
  }
  all.push_back({"intraprocess", {2, false, true}, plain, 4, shortcut});
  // Steps far apart: only the subscriber's queue is ever full.
  all.push_back({"short_publisher_queue", {3, false, true}, plain, 5, {{"pub_queue_size", "1"}}});
  all.push_back({"burst", {3, false, true, 5}, {"write", "burst", "tryread"}, 5, {}});
  all.push_back({"reconnect", {2, false, true}, reconnect, 8, {}});
  all.push_back({"reconnect_intraprocess", {2, false, true}, reconnect, 8, shortcut});
  all.push_back({"latch", {2, true, false}, reconnect, 6, {}});
  all.push_back({"latch_gap", {2, true, true}, reconnect, 12, {}});
  all.push_back({"latch_intraprocess", {2, true, true}, reconnect, 12, shortcut});
  all.push_back({"interrupt_1", {1, false, false}, interrupt, 6, {}});
  all.push_back({"interrupt_2", {2, false, false}, interrupt, 12, {}});
  all.push_back({"clear_2", {2, false, false}, {"write", "tryread", "clear"}, 6, {}});
  return all;
}

}  // namespace maide::test
