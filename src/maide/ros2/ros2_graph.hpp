// The graph of ROS 2: nodes, topics with the QoS of each end, services. It is read from a running
// system, by the wrapper for ROS 2, which knows rclcpp; from what `maide ros2 import --json`
// printed; or from a system file. It becomes a system file (ros2_system.cpp), or findings: which
// ends never match, what can be lost, what a late joiner gets.
//
// Ends match as DDS says: what the publisher offers is at least what the subscription asks for
// (OMG, Data Distribution Service 1.4, 2.2.3).
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "maide/automata/interface_automaton.hpp"
#include "maide/base/json.hpp"
#include "maide/base/run_control.hpp"
#include "maide/check/build/system_file.hpp"

namespace maide {

struct Ros2Qos {
  std::string reliability = "reliable", durability = "volatile";  // or "unknown"
  std::string history = "keep_last";                              // or "keep_all", "unknown"
  std::optional<std::uint32_t> depth;                             // none: nobody knows
  std::optional<double> deadline, lifespan;                       // seconds; none: infinite
  std::string liveliness = "automatic";
  std::optional<double> lease;  // seconds; none: infinite
};

struct Ros2End {
  std::string node;  // "/camera", or as a system file names it
  std::string type;  // "" where it is not known
  Ros2Qos qos;
};

struct Ros2Topic {
  std::string name;
  std::vector<Ros2End> publishers, subscriptions;
};

struct Ros2Service {
  std::string name, type;
  std::vector<std::string> servers, clients;
  std::optional<std::uint32_t> depth;  // none: nobody knows
};

struct Ros2Node {
  std::string name;
  std::string process;  // nodes with the same one share a context; "" where it is not known
};

// Without what every node has: parameters, logs, hidden nodes. Topics and services of actions are
// not in it either: `actions` names them.
struct Ros2Graph {
  std::string rmw;  // "rmw_cyclonedds_cpp"; "" of a system file
  std::uint32_t domain = 0;
  bool is_settled = true;  // nothing changed when it was read
  std::vector<Ros2Node> nodes;
  std::vector<Ros2Topic> topics;
  std::vector<Ros2Service> services;
  std::vector<std::string> actions;
};

// ---- Reading ----

// What the wrapper prints (wrappers/ros2/graph.hpp). Throws UsageError for what is none.
Ros2Graph read_ros2_graph(const Json& json, const std::string& file);
Json ros2_graph_to_json(const Ros2Graph& graph);

// The running graph of the environment's domain, once it has not changed for `quiet` seconds.
// Throws UsageError if there is no wrapper for ROS 2, WrapperError if it fails.
Ros2Graph observe_ros2_graph(double quiet, const RunControl& control);

// What options of `kind=topic` say of that end, "pub" or "sub". Keys have '-' for '_'.
using Ros2Options = std::map<std::string, std::string>;
Ros2Qos ros2_qos_of(const Ros2Options& options, const std::string& end);

// Where the model of a request is kept, for a system file of that folder (kept_model_path()).
using KeptModelPath = std::filesystem::path (*)(const std::filesystem::path& folder,
                                                const ModelRequest& request);

// Of a JSON file, or of a system file: its topics that are learned from `ros2`, its services.
// Nothing is learned: a model that is not kept counts as one that takes everything.
Ros2Graph read_ros2_file(const std::filesystem::path& file, KeptModelPath kept_model_path,
                         const RunControl& control);

// ---- System files ----

// A system file with these connections. Programs are for the reader to fill in.
std::string write_ros2_system(const Ros2Graph& graph);

// What `learn: ros2` stands for with `depth: unknown`; nothing if the depth of the subscription is
// known, or it is another system. Throws UsageError for options that it says nothing about.
std::optional<InterfaceAutomaton> ros2_topic_of_unknown_depth(const ModelRequest& request);

// ---- Findings ----

struct Ros2Finding {
  enum class Kind : std::uint8_t { no_match, no_end, loss, late };
  Kind kind = Kind::loss;
  std::string where;  // the topic, or the service
  std::string text;   // one line
};

// Why these two never match; "" if they do, as far as is known.
std::string find_mismatch(const Ros2End& publisher, const Ros2End& subscription);

// A subscription that comes late gets what the publisher keeps.
bool hears_history(const Ros2Qos& publisher, const Ros2Qos& subscription);

// By kind, in the order of the graph.
std::vector<Ros2Finding> examine_ros2_graph(const Ros2Graph& graph);

}  // namespace maide
