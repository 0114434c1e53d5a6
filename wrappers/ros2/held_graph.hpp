// The nodes of a system file as kind=nodes is told of them: a JSON object on one line.
//
//   {"nodes": ["camera", "detector"],
//    "executors": [{"name": "main", "threads": 2, "rounds": false}],
//    "groups": [{"node": 1, "executor": 0, "reentrant": true}],
//    "topics": [{"options": {"depth": "10"}, "writers": [0], "readers": []}],
//    "services": [{"depth": 10, "server": 1, "clients": [1]}],
//    "callbacks": [{"name": "detector.on_image", "group": 0, "subscription": 0}]}
//
// Numbers are places in these lists. A node without a group is a program: it makes its calls from a
// thread of its own, and receives by spinning. `readers` are programs; callbacks that subscribe are
// readers, too. A callback says one of `timer`, `subscription` (a topic), `service`, `client`.
// Executors look through groups, and in a group through callbacks of a kind, in the order of these
// lists.
#pragma once

#include <cstddef>
#include <cstdint>
#include <rclcpp/qos.hpp>
#include <string>
#include <vector>

#include "maide/wire/wrapper/system_wrapper.hpp"

namespace maide::ros2 {

struct HeldGraph {
  struct Executor {
    std::string name;
    std::size_t threads = 1;
    bool goes_by_rounds = false;  // what its clients discard is a step
  };
  struct Group {
    std::size_t node = 0, executor = 0;
    bool is_reentrant = false;
  };
  struct Topic {
    rclcpp::QoS publisher{1}, subscription{1};
    bool tells_gaps = false;
    std::vector<std::size_t> writers, readers;
  };
  struct Service {
    std::size_t depth = 10, server = 0;
    std::vector<std::size_t> clients;
  };
  struct Callback {
    enum class Kind : std::uint8_t { timer, subscription, service, client };
    Kind kind = Kind::timer;
    std::string name;
    std::size_t group = 0, end = 0;  // `end`: the topic or service
  };
  std::vector<std::string> nodes;
  std::vector<Executor> executors;
  std::vector<Group> groups;
  std::vector<Topic> topics;
  std::vector<Service> services;
  std::vector<Callback> callbacks;

  // Throws UsageError, one line, for what is no such text.
  static HeldGraph from(const std::string& text);
  static std::vector<OptionSpec> options();

  bool is_program(std::size_t node) const;
  // How often the callback may run at once.
  std::size_t runs_of(const Callback& callback) const;
  // Whether it is a step when its client takes answers to others.
  bool discards(const Callback& callback) const;
  std::size_t node_of(const Callback& callback) const { return groups[callback.group].node; }
};

// Actors are `executors`, which makes and reports all that callbacks do, and each program. With
// E, C, R, N, T, S the places of an executor, a callback, a run of it, a node, a topic, a service:
//
//   eE.pick       a thread of the executor looks: `eE.cC` was picked, or `eE.nothing`
//   cC.due        the timer becomes due
//   cC.R.start    the thread that picked the callback runs it, as its run R: `cC.R.began`, or of a
//                 subscription `cC.R.message`, `.next`, `.gap`, `.old`. It is held there, and
//                 behind each of the following
//   cC.R.tT.write, cC.R.sS.send, cC.R.sS.answer
//   cC.R.sS.wait  for the answer to its last request: `cC.R.answered`
//   cC.R.end
//   cC.discard    the thread that picked the client lets it take answers to others, and runs
//   nothing.
//                 Only where the executor goes by rounds; of other executors it is no step
//   nN.tT.write, nN.tT.read, nN.sS.send, nN.sS.receive, nN.sS.serve, nN.sS.answer
//                 of programs: `nN.tT.message` (or as above), `nN.sS.answer`, `nN.sS.request`
//   free          no thread of an executor is held any more
SystemSetup held_setup(const HeldGraph& graph);

}  // namespace maide::ros2
