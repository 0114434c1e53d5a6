#include "graph.hpp"

#include <fmt/format.h>
#include <rcutils/logging.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <map>
#include <nlohmann/json.hpp>
#include <rclcpp/rclcpp.hpp>
#include <string>
#include <thread>
#include <vector>

#include "maide/base/error.hpp"
#include "maide/base/json.hpp"
#include "maide/base/numbers.hpp"

namespace maide::ros2 {
namespace {

using Clock = std::chrono::steady_clock;
using Seconds = std::chrono::duration<double>;

constexpr Seconds piece{0.1};                 // between looks
constexpr Seconds most{30};                   // of waiting for a graph that does not change
constexpr Seconds least_if_empty{10};         // of waiting for nodes
constexpr std::size_t bytes_of_process = 12;  // of an end's number: those of its participant

// Nodes of the graph whose participant has not told their names yet.
constexpr const char* nameless = "_NODE_NAME_UNKNOWN_";

// Who was there before tells of itself again after this time, if the first time was lost. Fast DDS
// does so every three seconds (its default). Cyclone DDS answers whoever comes.
Seconds least_wait() {
  const std::string rmw = rmw_get_implementation_identifier();
  return Seconds(rmw.starts_with("rmw_fastrtps") ? 4 : 0);
}

std::string full_name(const std::string& name, const std::string& name_space) {
  return (name_space.empty() || name_space == "/" ? "" : name_space) + "/" + name;
}

template <typename Policy>
std::string text_of(Policy policy, const std::map<Policy, std::string>& names) {
  const auto name = names.find(policy);
  return name == names.end() ? "unknown" : name->second;
}

void add_time(Json& json, const std::string& key, const rmw_time_t& time) {
  if (rmw_time_equal(time, RMW_DURATION_INFINITE) || rmw_time_equal(time, RMW_DURATION_UNSPECIFIED))
    return;
  json[key] = static_cast<double>(time.sec) + static_cast<double>(time.nsec) * 1e-9;
}

// History and depth are no part of what DDS tells of an end. Cyclone DDS tells them all the same,
// and takes the standard's default, one message, for what other vendors' ends do not tell. The
// vendor stands in the first two bytes of an end's number.
bool tells_history(const rclcpp::TopicEndpointInfo& info) {
  return info.endpoint_gid()[0] == 0x01 && info.endpoint_gid()[1] == 0x10;
}

Json end_of(const rclcpp::TopicEndpointInfo& info) {
  const rmw_qos_profile_t& qos = info.qos_profile().get_rmw_qos_profile();
  Json json{
      {"node", full_name(info.node_name(), info.node_namespace())},
      {"type", info.topic_type()},
      {"reliability",
       text_of(qos.reliability, {{RMW_QOS_POLICY_RELIABILITY_RELIABLE, "reliable"},
                                 {RMW_QOS_POLICY_RELIABILITY_BEST_EFFORT, "best_effort"}})},
      {"durability",
       text_of(qos.durability, {{RMW_QOS_POLICY_DURABILITY_VOLATILE, "volatile"},
                                {RMW_QOS_POLICY_DURABILITY_TRANSIENT_LOCAL, "transient_local"}})}};
  std::string history = "unknown";
  if (tells_history(info)) {
    history = text_of(qos.history, {{RMW_QOS_POLICY_HISTORY_KEEP_LAST, "keep_last"},
                                    {RMW_QOS_POLICY_HISTORY_KEEP_ALL, "keep_all"}});
  }
  json["history"] = history;
  if (history == "keep_last" && qos.depth > 0) json["depth"] = qos.depth;
  add_time(json, "deadline", qos.deadline);
  add_time(json, "lifespan", qos.lifespan);
  json["liveliness"] =
      text_of(qos.liveliness, {{RMW_QOS_POLICY_LIVELINESS_AUTOMATIC, "automatic"},
                               {RMW_QOS_POLICY_LIVELINESS_MANUAL_BY_TOPIC, "manual_by_topic"}});
  add_time(json, "lease", qos.liveliness_lease_duration);
  return json;
}

// Looks at the graph through a node of its own, which is not in what it returns.
class GraphReader {
 public:
  GraphReader() {
    if (rcutils_logging_initialize() == RCUTILS_RET_OK) {
      rcutils_logging_set_default_logger_level(RCUTILS_LOG_SEVERITY_FATAL);
    }
    rclcpp::InitOptions init;
    init.auto_initialize_logging(false);
    context_->init(0, nullptr, init);
    rclcpp::NodeOptions options;
    options.context(context_)
        .use_global_arguments(false)
        .enable_rosout(false)
        .start_parameter_services(false)
        .start_parameter_event_publisher(false)
        .use_clock_thread(false);
    node_ = std::make_shared<rclcpp::Node>(fmt::format("_maide_graph_{}", ::getpid()), options);
  }

  std::size_t domain() const { return context_->get_domain_id(); }

  Json read() {
    processes_.clear();
    Json topics = read_topics();
    Json services = read_services();
    Json nodes = Json::array();
    for (const std::string& name : names_) {
      nodes.push_back({{"name", name}, {"process", processes_[name]}});
    }
    return {{"nodes", nodes}, {"topics", topics}, {"services", services}};
  }

 private:
  Json read_topics() {
    Json topics = Json::array();
    for (const auto& [name, types] : node_->get_topic_names_and_types()) {
      Json topic{{"name", name}};
      topic["publishers"] = ends(node_->get_publishers_info_by_topic(name));
      topic["subscriptions"] = ends(node_->get_subscriptions_info_by_topic(name));
      topics.push_back(topic);
    }
    return topics;
  }

  // In an order that does not depend on who was met first.
  Json ends(const std::vector<rclcpp::TopicEndpointInfo>& infos) {
    std::vector<Json> all;
    for (const rclcpp::TopicEndpointInfo& info : infos) {
      const auto& number = info.endpoint_gid();
      std::string process;
      for (std::size_t i = 0; i < bytes_of_process; ++i)
        process += fmt::format("{:02x}", number[i]);
      processes_[full_name(info.node_name(), info.node_namespace())] = process;
      all.push_back(end_of(info));
    }
    std::sort(all.begin(), all.end(),
              [](const Json& a, const Json& b) { return a.dump() < b.dump(); });
    return Json(all);
  }

  Json read_services() {
    struct Ends {
      std::string type;
      std::vector<std::string> servers, clients;
    };
    std::map<std::string, Ends> services;
    names_.clear();
    const auto graph = node_->get_node_graph_interface();
    for (const auto& [name, name_space] : graph->get_node_names_and_namespaces()) {
      if (name == node_->get_name()) continue;
      names_.push_back(full_name(name, name_space));
      // A node that has gone in between is no error.
      try {
        for (const auto& [service, types] :
             graph->get_service_names_and_types_by_node(name, name_space)) {
          services[service].servers.push_back(names_.back());
          services[service].type = types.empty() ? "" : types.front();
        }
        for (const auto& [service, types] :
             graph->get_client_names_and_types_by_node(name, name_space)) {
          services[service].clients.push_back(names_.back());
          services[service].type = types.empty() ? "" : types.front();
        }
      } catch (const std::runtime_error&) {
      }
    }
    std::sort(names_.begin(), names_.end());
    Json list = Json::array();
    for (auto& [name, ends] : services) {
      std::sort(ends.servers.begin(), ends.servers.end());
      std::sort(ends.clients.begin(), ends.clients.end());
      list.push_back({{"name", name},
                      {"type", ends.type},
                      {"servers", ends.servers},
                      {"clients", ends.clients}});
    }
    return list;
  }

  std::shared_ptr<rclcpp::Context> context_ = std::make_shared<rclcpp::Context>();
  std::shared_ptr<rclcpp::Node> node_;
  std::vector<std::string> names_;                // of nodes, in order
  std::map<std::string, std::string> processes_;  // by node
};

bool has_nodes(const Json& graph) {
  return std::any_of(graph["nodes"].begin(), graph["nodes"].end(), [](const Json& node) {
    const auto name = node["name"].get<std::string>();
    return name[name.rfind('/') + 1] != '_';
  });
}

// Looks until nothing changed for `quiet`, every node has a name, and whoever is there had the time
// to tell.
Json wait_for_graph(GraphReader& reader, Seconds quiet) {
  const Clock::time_point begin = Clock::now();
  const Seconds least = least_wait();
  Clock::time_point changed = begin;
  Json graph = reader.read();
  std::string text = graph.dump();
  for (;;) {
    std::this_thread::sleep_for(piece);
    Json next = reader.read();
    std::string next_text = next.dump();
    const Clock::time_point now = Clock::now();
    if (next_text != text) changed = now;
    graph = std::move(next);
    text = std::move(next_text);
    const bool is_named = text.find(nameless) == std::string::npos;
    const bool is_settled = now - changed >= quiet && is_named &&
                            now - begin >= (has_nodes(graph) ? least : least_if_empty);
    if (!is_settled && now - begin < most + quiet) continue;
    graph["settled"] = is_settled;
    return graph;
  }
}

}  // namespace

int print_graph(int argc, char** argv) {
  try {
    Seconds quiet{2};
    for (int i = 1; i < argc; ++i) {
      const std::string word = argv[i], key = "--quiet=";
      if (word == "--graph") continue;
      const auto number = word.starts_with(key) ? parse_number<double>(word.substr(key.size()))
                                                : std::optional<double>();
      if (!number || !std::isfinite(*number) || *number < 0 || *number > 3600) {
        throw UsageError("usage: maide-wrap-ros2 --graph [--quiet=SECONDS]");
      }
      quiet = Seconds(*number);
    }
    GraphReader reader;
    Json graph{{"rmw", rmw_get_implementation_identifier()}, {"domain", reader.domain()}};
    graph.update(wait_for_graph(reader, quiet));
    fmt::print("{}\n", to_json_line(graph));
    return static_cast<int>(ExitStatus::ok);
  } catch (const Error& error) {
    fmt::print(stderr, "maide-wrap-ros2: {}\n", error.what());
    return static_cast<int>(error.status());
  } catch (const std::exception& error) {
    fmt::print(stderr, "maide-wrap-ros2: {}\n", error.what());
    return static_cast<int>(ExitStatus::system_failed);
  }
}

}  // namespace maide::ros2
