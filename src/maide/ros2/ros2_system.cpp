// A graph of ROS 2 as a system file, and what the file's topics stand for while nobody has said how
// much they keep.
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "maide/base/error.hpp"
#include "maide/base/text.hpp"
#include "maide/check/rules/built_in_models.hpp"
#include "maide/check/text/yaml_node.hpp"
#include "maide/check/tree/print.hpp"
#include "maide/ros2/ros2_graph.hpp"

namespace maide {
namespace {

// A topic as the system file has it: writers whose messages reach the same readers.
struct Connection {
  std::string name, comment;
  std::vector<std::string> writers;
  struct Reader {
    std::string node, callback;
    YamlNode options;  // {depth: unknown}
  };
  std::vector<Reader> readers;
};

struct NodeEntry {
  std::string name, process;
  YamlNode callbacks = YamlNode::make_map();
  std::vector<std::string> says{};  // statements for its programs
};

// "{depth: 3}"
YamlNode braces(const std::vector<std::pair<std::string, std::string>>& fields) {
  YamlNode map = YamlNode::make_map(YamlNode::Style::flow);
  for (const auto& [key, value] : fields) map.set(key, YamlNode(value));
  return map;
}

// Adds an entry to the map, with a comment on a line of its own before it, unless that is empty.
void add_entry(YamlNode& map, const std::string& key, YamlNode value, const std::string& comment) {
  map.set(key, std::move(value));
  if (!comment.empty()) map.entries.back().before.push_back("# " + comment);
}

std::string describe(const Ros2End& end) {
  std::string text = end.node + ": " + end.qos.reliability + ", " + end.qos.durability;
  if (end.qos.history == "keep_all") text += ", keep_all";
  if (end.qos.depth) text += fmt::format(", depth {}", *end.qos.depth);
  if (end.qos.deadline) text += fmt::format(", deadline {} s", *end.qos.deadline);
  if (end.qos.lifespan) text += fmt::format(", lifespan {} s", *end.qos.lifespan);
  if (end.qos.lease) text += fmt::format(", {}, lease {} s", end.qos.liveliness, *end.qos.lease);
  return text;
}

// The middleware below, where it is not the one that is learned by default.
void add_rmw(const Ros2Graph& graph, YamlNode& options) {
  if (graph.rmw.starts_with("rmw_fastrtps")) options.set("rmw", YamlNode("fastrtps"));
}

// The options of `learn ros2` for a pair of ends, without those that have their defaults.
YamlNode options_of(const Ros2Qos& publisher, const Ros2Qos& subscription) {
  YamlNode options = YamlNode::make_map(YamlNode::Style::flow);
  const auto depth_of = [](const Ros2Qos& end) {
    return end.depth ? std::to_string(*end.depth) : std::string(unknown_depth);
  };
  // The publisher's depth counts for who comes late alone.
  const bool has_late = hears_history(publisher, subscription) && publisher.history != "keep_all";
  if (subscription.history == "keep_all") {
    options = braces({{"history", "keep_all"}, {"size", "20"}});
  } else if (has_late && depth_of(publisher) != depth_of(subscription)) {
    options = braces({{"pub-depth", depth_of(publisher)}, {"sub-depth", depth_of(subscription)}});
  } else {
    options = braces({{"depth", depth_of(subscription)}});
  }
  const auto add = [&](const std::string& key, const std::string& pub, const std::string& sub,
                       const std::string& otherwise) {
    const auto one = [&](const std::string& name, const std::string& value) {
      if (value != otherwise && value != "unknown") options.set(name, YamlNode(value));
    };
    if (pub == sub) {
      one(key, pub);
    } else {
      one("pub-" + key, pub);
      one("sub-" + key, sub);
    }
  };
  add("reliability", publisher.reliability, subscription.reliability, "reliable");
  add("durability", publisher.durability, subscription.durability, "volatile");
  return options;
}

class SystemWriter {
 public:
  explicit SystemWriter(const Ros2Graph& graph) : graph_(graph) {}

  std::string write() {
    name_nodes();
    for (const Ros2Service& service : graph_.services) {
      for (const char* suffix : {"", service_suffix}) {
        names_of_services_.insert(plain(service.name) + suffix);
      }
    }
    for (const Ros2Topic& topic : graph_.topics) add(topic);
    for (const Ros2Service& service : graph_.services) add(service);
    YamlDocument document;
    document.file = "the graph";
    document.root = YamlNode::make_map();
    const auto add_section = [&](const std::string& name, YamlNode entries) {
      if (!entries.entries.empty()) document.root.set(name, std::move(entries));
    };
    add_section("topics", topics());
    add_section("services", std::move(services_));
    add_section("executors", executors());  // they get their names here
    add_section("nodes", nodes(document.root.tail));
    if (document.root.entries.empty()) document.root.set("nodes", YamlNode::make_map());
    document.root.entries.front().before = head();
    return print_system(document);
  }

 private:
  void note(const std::string& remark) {
    if (std::ranges::find(remarks_, remark) == remarks_.end()) {
      remarks_.push_back(remark);
    }
  }

  std::string take(std::string name, const std::string& suffix) {
    if (taken_.contains(name)) name += suffix;
    const std::string first = name;
    for (int i = 2; !taken_.insert(name).second; ++i) name = first + "_" + std::to_string(i);
    return name;
  }

  static std::string plain(const std::string& name) {
    std::string text = name.substr(name.starts_with('/') ? 1 : 0);
    std::replace(text.begin(), text.end(), '/', '_');
    return text;
  }

  // By its own name, if no other node has it.
  void name_nodes() {
    std::map<std::string, int> own;
    const auto base = [](const std::string& name) { return name.substr(name.rfind('/') + 1); };
    for (const Ros2Node& node : graph_.nodes) ++own[base(node.name)];
    for (const Ros2Node& node : graph_.nodes) {
      if (names_.contains(node.name)) {
        note("two nodes are called " + node.name + ": they are one here");
        continue;
      }
      const bool is_alone = own[base(node.name)] == 1;
      names_[node.name] = nodes_.size();
      nodes_.push_back(
          {take(is_alone ? base(node.name) : plain(node.name), "_node"), node.process});
    }
  }

  // A node that the graph names at an end only.
  NodeEntry& node_of(const std::string& name) {
    const auto [place, is_new] = names_.emplace(name, nodes_.size());
    if (is_new) nodes_.push_back({take(plain(name), "_node"), ""});
    return nodes_[place->second];
  }

  // The callback of a node's client has the name of the service.
  std::string add_callback(NodeEntry& node, const std::string& name, YamlNode callback) const {
    std::string own = name;
    const auto is_taken = [&] {
      return names_of_services_.contains(own) || node.callbacks.find(own) != nullptr;
    };
    for (int i = 2; is_taken(); ++i) own = name + "_" + std::to_string(i);
    node.callbacks.set(own, std::move(callback));
    return own;
  }

  void add(const Ros2Topic& topic) {
    if (topic.subscriptions.empty() || topic.publishers.empty()) {
      note(fmt::format("{} is left out: nobody {} it", topic.name,
                       topic.publishers.empty() ? "publishes" : "subscribes to"));
      return;
    }
    // Publishers by the subscriptions that they reach.
    std::map<std::vector<bool>, std::vector<const Ros2End*>> groups;
    for (const Ros2End& publisher : topic.publishers) {
      std::vector<bool> reached;
      for (const Ros2End& subscription : topic.subscriptions) {
        const std::string mismatch = find_mismatch(publisher, subscription);
        reached.push_back(mismatch.empty());
        if (!mismatch.empty()) note(topic.name + ": " + mismatch + ": they never match");
      }
      groups[reached].push_back(&publisher);
    }
    std::string name = plain(topic.name);
    for (auto group = groups.rbegin(); group != groups.rend(); ++group) {
      std::vector<const Ros2End*> readers;
      for (std::size_t i = 0; i < topic.subscriptions.size(); ++i) {
        if (group->first[i]) readers.push_back(&topic.subscriptions[i]);
      }
      if (readers.empty()) {
        note(topic.name + ": nobody hears " + group->second.front()->node);
        continue;
      }
      name = take(name, group == groups.rbegin() ? "_topic" : "_2");
      add(topic, name, group->second, readers);
    }
    const auto heard = std::ranges::count_if(groups, [](const auto& group) {
      return std::ranges::find(group.first, true) != group.first.end();
    });
    if (heard > 1) {
      note(topic.name +
           " is several topics here, for not all publishers reach the same "
           "subscriptions; one that several reach has a queue for each");
    }
  }

  void add(const Ros2Topic& topic, const std::string& name,
           const std::vector<const Ros2End*>& publishers,
           const std::vector<const Ros2End*>& subscriptions) {
    Connection connection;
    connection.name = name;
    connection.comment = topic.publishers.front().type;
    std::vector<std::string> ends;
    for (const Ros2End* publisher : publishers) {
      NodeEntry& node = node_of(publisher->node);
      ends.push_back(describe(*publisher));
      if (std::ranges::find(connection.writers, node.name) != connection.writers.end()) {
        continue;
      }
      connection.writers.push_back(node.name);
      node.says.push_back(connection.name + ".write;");
    }
    for (const Ros2End* subscription : subscriptions) {
      ends.push_back(describe(*subscription));
      const Ros2Qos& first = publishers.front()->qos;
      if (hears_history(first, subscription->qos) &&
          std::ranges::any_of(
              publishers, [&](const Ros2End* other) { return other->qos.depth != first.depth; })) {
        note(
            fmt::format("{}: its publishers keep different numbers of messages for who comes "
                        "late; here all keep what {} does",
                        topic.name, publishers.front()->node));
      }
      NodeEntry& node = node_of(subscription->node);
      const std::string callback =
          add_callback(node, "on_" + connection.name,
                       braces({{"takes", connection.name + ".read"}, {"do", "unknown"}}));
      YamlNode options = options_of(publishers.front()->qos, subscription->qos);
      add_rmw(graph_, options);
      connection.readers.push_back({node.name, callback, std::move(options)});
    }
    connection.comment += ". " + join(ends, "; ");
    connections_.push_back(std::move(connection));
  }

  void add(const Ros2Service& service) {
    if (service.servers.size() != 1 || service.clients.empty()) {
      note(fmt::format("{} is left out: it has {}", service.name,
                       service.servers.empty()       ? "no server"
                       : service.servers.size() == 1 ? "no client"
                                                     : "several servers"));
      return;
    }
    const std::string name = take(plain(service.name), service_suffix);
    NodeEntry& server = node_of(service.servers.front());
    const std::string server_name = server.name;
    add_callback(server, "serve_" + name, braces({{"serves", name}, {"do", name + ".answer;"}}));
    std::vector<std::string> clients;
    for (const std::string& client : service.clients) {
      NodeEntry& node = node_of(client);
      if (std::ranges::find(clients, node.name) != clients.end()) continue;
      clients.push_back(node.name);
      node.says.push_back(fmt::format("{}.send; wait {} -> answer;", name, name));
    }
    YamlNode options = braces(
        {{"depth", service.depth ? std::to_string(*service.depth) : std::string(unknown_depth)}});
    add_rmw(graph_, options);
    YamlNode entry = braces({{"server", server_name}});
    entry.set("clients", YamlNode::make_names(clients));
    entry.set("learn", YamlNode("ros2"));
    entry.set("with", std::move(options));
    add_entry(services_, name, std::move(entry), service.type);
  }

  std::vector<std::string> head() {
    std::vector<std::string> lines{
        "# From a running graph of ROS 2" + (graph_.rmw.empty() ? "" : " (" + graph_.rmw + ")") +
            ". The graph does not tell:",
        "# - what callbacks do: write it in place of each `do: unknown`, and `skip;` for nothing",
        "# - timers: a callback is added as `tick: {timer: 100, do: \"...\"}`",
        "# - depths: write a number in place of each `unknown`",
        "# - executors and callback groups: without `executor`, each node has its own thread"};
    const bool is_built_in = graph_.rmw.empty() || graph_.rmw == "rmw_cyclonedds_cpp";
    if (!is_built_in && !graph_.rmw.starts_with("rmw_fastrtps")) {
      note(fmt::format("the models are those of rmw_cyclonedds_cpp: those of {} may differ",
                       graph_.rmw));
    }
    if (!graph_.is_settled) note("it still changed when it was read");
    for (const std::string& action : graph_.actions) {
      note("action " + action + " is left out: actions are not modelled");
    }
    for (const std::string& remark : remarks_) lines.push_back("# " + remark);
    return lines;
  }

  YamlNode topics() const {
    YamlNode section = YamlNode::make_map();
    for (const Connection& connection : connections_) {
      std::vector<std::string> readers;
      YamlNode own = YamlNode::make_map(YamlNode::Style::flow);
      const YamlNode& common = connection.readers.front().options;
      const bool is_same = std::ranges::all_of(connection.readers, [&](const auto& reader) {
        return is_same_value(reader.options, common);
      });
      for (const Connection::Reader& reader : connection.readers) {
        const auto of_node = std::ranges::count_if(
            connection.readers, [&](const auto& other) { return other.node == reader.node; });
        readers.push_back(of_node == 1 ? reader.node : reader.node + "." + reader.callback);
        own.set(readers.back(), reader.options);
      }
      YamlNode entry = YamlNode::make_map(YamlNode::Style::flow);
      entry.set("writers", YamlNode::make_names(connection.writers));
      entry.set("readers", YamlNode::make_names(readers));
      entry.set("learn", YamlNode("ros2"));
      entry.set(is_same ? "with" : "readers_with", is_same ? common : own);
      add_entry(section, connection.name, std::move(entry), connection.comment);
    }
    return section;
  }

  static bool is_connected(const NodeEntry& node) {
    return !node.callbacks.entries.empty() || !node.says.empty();
  }

  // Nodes of one process, where there are several.
  std::map<std::string, std::vector<std::string>> processes() const {
    std::map<std::string, std::vector<std::string>> all;
    for (const NodeEntry& node : nodes_) {
      if (!node.process.empty() && is_connected(node)) all[node.process].push_back(node.name);
    }
    std::erase_if(all, [](const auto& entry) { return entry.second.size() < 2; });
    return all;
  }

  YamlNode executors() {
    YamlNode section = YamlNode::make_map();
    for (const auto& [process, names] : processes()) {
      const std::string name = take("executor", "");
      executors_[process] = name;
      add_entry(section, name, braces({{"kind", "single"}}),
                join(names) + " are in one process; that one executor spins them is a guess");
    }
    return section;
  }

  YamlNode nodes(std::vector<std::string>& left_out) {
    YamlNode section = YamlNode::make_map();
    for (NodeEntry& node : nodes_) {
      if (!is_connected(node)) {
        left_out.push_back("# " + node.name + " is left out: it has no connections");
        continue;
      }
      YamlNode entry = YamlNode::make_map();
      const auto executor = executors_.find(node.process);
      if (executor != executors_.end()) entry.set("executor", YamlNode(executor->second));
      if (node.callbacks.entries.empty()) {
        add_callback(node, "tick", braces({{"timer", "100"}, {"do", "unknown"}}));
      }
      entry.set("callbacks", std::move(node.callbacks));
      if (!node.says.empty()) {
        entry.entries.front().before.push_back("# may say: " + join(node.says, " "));
      }
      add_entry(section, node.name, std::move(entry), "");
    }
    return section;
  }

  const Ros2Graph& graph_;
  static constexpr const char* service_suffix = "_service";
  std::set<std::string> taken_{"", "null", "Null", "NULL"};  // to YAML the last three are no words
  std::set<std::string> names_of_services_;
  std::map<std::string, std::size_t> names_;  // of nodes, by their names in the graph
  std::vector<NodeEntry> nodes_;
  std::vector<Connection> connections_;
  YamlNode services_ = YamlNode::make_map();
  std::map<std::string, std::string> executors_;  // by process
  std::vector<std::string> remarks_;
};

}  // namespace

std::string write_ros2_system(const Ros2Graph& graph) { return SystemWriter(graph).write(); }

std::optional<InterfaceAutomaton> ros2_topic_of_unknown_depth(const ModelRequest& request) {
  if (request.learn != "ros2") return std::nullopt;
  Ros2Options options;
  for (auto [key, value] : request.with) {
    std::replace(key.begin(), key.end(), '_', '-');
    options[key] = value;
  }
  const auto is_unknown_of = [&](const std::string& end) {
    const auto own = options.find(end + "-depth"), both = options.find("depth");
    const auto depth = own == options.end() || own->second == "both" ? both : own;
    return depth != options.end() && depth->second == unknown_depth;
  };
  const Ros2End publisher{"the publisher", "", ros2_qos_of(options, "pub")};
  const Ros2End subscription{"the subscription", "", ros2_qos_of(options, "sub")};
  const bool is_unknown = is_unknown_of("sub") ||
                          (hears_history(publisher.qos, subscription.qos) && is_unknown_of("pub"));
  if (!is_unknown) return std::nullopt;
  static const std::set<std::string> known{"depth", "reliability", "durability"};
  for (const auto& [key, value] : options) {
    if ((key == "kind" && value == "topic") || key == "rmw") continue;
    const bool is_of_end = key.starts_with("pub-") || key.starts_with("sub-");
    const std::string of_both = is_of_end ? key.substr(4) : key;
    if (known.contains(of_both) || (of_both == "history" && value == "keep_last")) continue;
    throw UsageError(
        fmt::format("option '{}' does not go with 'depth: unknown'; write the depth", key));
  }
  std::vector<std::string> values;
  for (const std::string& value : request.values) values.push_back("(" + value + ")");
  const std::string mismatch = find_mismatch(publisher, subscription);
  if (!mismatch.empty()) throw UsageError("its ends never match: " + mismatch);
  InterfaceAutomaton queue = make_queue({1, true, values, true});
  if (subscription.qos.reliability == "best_effort") queue.origin["reliability"] = "best_effort";
  return queue;
}

}  // namespace maide
