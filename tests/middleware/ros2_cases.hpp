// Configurations of ROS 2's topics and services, and the model that each must have.
#pragma once

#include <cstddef>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "connection_models.hpp"
#include "ros2_model.hpp"
#include "wrapper_checks.hpp"

namespace maide::test {

struct Ros2TopicCase {
  std::string name;
  SystemOptions options;
  ConnectionModel model;
  std::size_t states;  // of the minimal machine
};

inline void PrintTo(const Ros2TopicCase& tested, std::ostream* out) { *out << tested.name; }

inline SystemOptions ros2_reading(SystemOptions options) {
  options["inputs"] = "write,tryread";
  options["payload"] = "gap";
  options["observe"] = "message,null";
  return options;
}

// The depths of publisher and subscription.
struct Ros2Depths {
  std::size_t pub = 2, sub = 2;
};

// A subscription that is dropped and made anew, with what the publisher keeps for it: the newest of
// its own depth, and of these the subscription takes the newest of its depth.
inline Ros2TopicCase ros2_late_joiner(const std::string& name, const std::string& durability,
                                      std::size_t states, Ros2Depths depths = {}) {
  Ros2TopicCase made{name,
                     {{"pub_depth", std::to_string(depths.pub)},
                      {"sub_depth", std::to_string(depths.sub)},
                      {"durability", durability},
                      {"inputs", "write,tryread,unsubscribe,subscribe"},
                      {"payload", "gap"},
                      {"observe", "message,null,unsubscribed"}},
                     {depths.sub, WhenFull::drop_oldest, true, true},
                     states};
  if (durability == "transient_local") made.model.replayed = depths.pub;
  made.model.read_alone = "unsubscribed";
  return made;
}

inline std::vector<Ros2TopicCase> ros2_kept_for_late_joiners() {
  return {ros2_late_joiner("transient_local", "transient_local", 18),
          ros2_late_joiner("short_history", "transient_local", 15, {1, 3}),
          ros2_late_joiner("long_history", "transient_local", 9, {3, 1})};
}

// The subscription's depth alone decides what is kept, whatever else is set.
inline std::vector<Ros2TopicCase> ros2_topic_cases() {
  std::vector<Ros2TopicCase> all;
  for (std::size_t n = 1; n <= 4; ++n) {
    const std::string depth = std::to_string(n);
    all.push_back({"keep_last_" + depth,
                   ros2_reading({{"depth", depth}}),
                   {n, WhenFull::drop_oldest, true},
                   n + 2});
  }
  const std::vector<std::pair<std::string, SystemOptions>> of_two = {
      {"of_two_contexts", {{"contexts", "2"}}},
      {"intraprocess", {{"intraprocess", "on"}}},
      {"spin_some", {{"take", "some"}}},
      {"taken_directly", {{"take", "direct"}}},
      {"best_effort", {{"reliability", "best_effort"}}},
      {"kept_for_nobody", {{"durability", "transient_local"}}},
      {"short_publisher", {{"pub_depth", "1"}}},
      {"long_publisher", {{"pub_depth", "9"}}},
  };
  for (const auto& [name, more] : of_two) {
    SystemOptions options = more;
    options["depth"] = "2";
    all.push_back({name, ros2_reading(options), {2, WhenFull::drop_oldest, true}, 4});
  }
  all.push_back(
      {"depth_0_is_1", ros2_reading({{"depth", "0"}}), {1, WhenFull::drop_oldest, true}, 3});
  all.push_back({"system_default_of_cyclone_is_1",
                 ros2_reading({{"history", "system_default"}}),
                 {1, WhenFull::drop_oldest, true},
                 3});
  for (const std::size_t n : {2, 3}) {
    Ros2TopicCase taken{"take_all_" + std::to_string(n),
                        ros2_reading({{"depth", std::to_string(n)}, {"take", "all"}}),
                        {n, WhenFull::drop_oldest, true},
                        n + 2};
    taken.model.reads_all = true;
    all.push_back(std::move(taken));
  }
  all.push_back(ros2_late_joiner("volatile", "volatile", 8));
  for (const Ros2TopicCase& late : ros2_kept_for_late_joiners()) all.push_back(late);
  return all;
}

// The middleware of a process is chosen once, so these have wrappers of their own.
inline std::vector<Ros2TopicCase> ros2_topic_cases_over_fastrtps() {
  std::vector<Ros2TopicCase> all = ros2_kept_for_late_joiners();
  all.push_back(
      {"keep_last_2", ros2_reading({{"depth", "2"}}), {2, WhenFull::drop_oldest, true}, 4});
  return all;
}

struct Ros2ServiceCase {
  std::string name;
  Ros2Service service;
  std::vector<std::string> inputs;
  std::size_t states;  // of the minimal machine

  SystemOptions options() const {
    SystemOptions all{{"kind", "service"},
                      {"depth", std::to_string(service.depth)},
                      {"clients", std::to_string(service.clients)},
                      {"payload", service.tells_gaps ? "gap" : "none"}};
    for (const std::string& input : inputs) {
      all["inputs"] += (all["inputs"].empty() ? "" : ",") + input;
    }
    return all;
  }
};

inline void PrintTo(const Ros2ServiceCase& tested, std::ostream* out) { *out << tested.name; }

inline Ros2ServiceCase ros2_strangers(std::size_t depth) {
  return {
      "strangers_" + std::to_string(depth), {depth, 2, false}, {"ask", "wait", "call"}, depth + 2};
}

inline std::vector<Ros2ServiceCase> ros2_service_cases() {
  const std::vector<std::string> usual{"send", "serve", "answer", "receive"};
  const std::vector<std::string> one{"send", "handle", "tryreceive"};
  const std::vector<std::string> served{"send", "tryserve", "handle", "tryreceive"};
  const std::vector<std::string> restarted{"send", "handle", "tryreceive", "stop", "start"};
  const std::vector<std::string> two{"send", "handle", "tryreceive", "send2", "tryreceive2"};
  return {
      {"depth_1", {1, 1, true}, one, 9},
      {"depth_2", {2, 1, true}, one, 25},
      {"served_and_not_answered", {1, 1, true}, served, 15},
      {"restarted", {1, 1, true}, restarted, 18},
      {"two_clients", {1, 2, false}, two, 9},
      {"two_clients_gap", {1, 2, true}, two, 81},
      {"two_clients_gap_depth_2", {2, 2, true}, two, 679},
      {"usual_depth_1", {1, 1, false}, usual, 15},
      {"usual_depth_2", {2, 1, false}, usual, 28},
      {"waiting_for_a_callback", {1, 1, true}, {"send", "handle", "receive"}, 12},
      ros2_strangers(1),
      ros2_strangers(10),
      {"strangers_restarted", {2, 2, false}, {"ask", "wait", "call", "stop", "start"}, 8},
  };
}

}  // namespace maide::test
