#include "held_graph.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

#include "maide/base/error.hpp"
#include "maide/base/json.hpp"
#include "qos.hpp"

namespace maide::ros2 {
namespace {

using Kind = HeldGraph::Callback::Kind;

// A number in a list of that size.
std::size_t place(const Json& json, const char* key, std::size_t size) {
  const auto number = json.at(key).get<std::size_t>();
  if (number >= size) throw UsageError(fmt::format("option graph: there is no {} {}", key, number));
  return number;
}

std::vector<std::size_t> places(const Json& json, const char* key, std::size_t size) {
  std::vector<std::size_t> numbers = json.at(key).get<std::vector<std::size_t>>();
  if (std::any_of(numbers.begin(), numbers.end(), [&](auto number) { return number >= size; })) {
    throw UsageError(fmt::format("option graph: {} name a node that is not there", key));
  }
  return numbers;
}

HeldGraph::Topic topic_from(const Json& json, std::size_t nodes) {
  std::vector<OptionSpec> table = qos_options();
  table.push_back(common_options::payload());
  const OptionValues options(table, json.at("options").get<std::map<std::string, std::string>>());
  return {qos_from(options, "pub-"), qos_from(options, "sub-"), options.is("payload", "gap"),
          places(json, "writers", nodes), places(json, "readers", nodes)};
}

HeldGraph::Callback callback_from(const Json& json, const HeldGraph& graph) {
  HeldGraph::Callback callback;
  callback.name = json.at("name").get<std::string>();
  callback.group = place(json, "group", graph.groups.size());
  if (json.contains("subscription")) {
    callback.kind = Kind::subscription;
    callback.end = place(json, "subscription", graph.topics.size());
  } else if (!json.contains("timer")) {
    const bool serves = json.contains("service");
    callback.kind = serves ? Kind::service : Kind::client;
    callback.end = place(json, serves ? "service" : "client", graph.services.size());
  }
  return callback;
}

HeldGraph graph_from(const Json& json) {
  HeldGraph graph;
  graph.nodes = json.at("nodes").get<std::vector<std::string>>();
  for (const Json& executor : json.at("executors")) {
    graph.executors.push_back({executor.at("name").get<std::string>(),
                               std::max<std::size_t>(executor.at("threads").get<std::size_t>(), 1),
                               executor.value("rounds", false)});
  }
  for (const Json& group : json.at("groups")) {
    graph.groups.push_back({place(group, "node", graph.nodes.size()),
                            place(group, "executor", graph.executors.size()),
                            group.at("reentrant").get<bool>()});
  }
  for (const Json& topic : json.at("topics")) {
    graph.topics.push_back(topic_from(topic, graph.nodes.size()));
  }
  for (const Json& service : json.at("services")) {
    graph.services.push_back({service.at("depth").get<std::size_t>(),
                              place(service, "server", graph.nodes.size()),
                              places(service, "clients", graph.nodes.size())});
  }
  for (const Json& callback : json.at("callbacks")) {
    graph.callbacks.push_back(callback_from(callback, graph));
  }
  return graph;
}

std::vector<std::string> message_events(const HeldGraph::Topic& topic, const std::string& prefix) {
  std::vector<std::string> events;
  for (const char* event : {"next", "gap", "old"}) {
    if (topic.tells_gaps) events.push_back(prefix + event);
  }
  if (!topic.tells_gaps) events.push_back(prefix + "message");
  return events;
}

class SetupMaker {
 public:
  explicit SetupMaker(const HeldGraph& graph) : graph_(graph) {}

  SystemSetup make() {
    setup_.actors = {"executors"};
    add_input("free");
    for (std::size_t executor = 0; executor < graph_.executors.size(); ++executor) {
      add_input(fmt::format("e{}.pick", executor));
      add_event(fmt::format("e{}.nothing", executor));
    }
    for (std::size_t callback = 0; callback < graph_.callbacks.size(); ++callback) {
      add_callback(callback);
    }
    for (std::size_t node = 0; node < graph_.nodes.size(); ++node) {
      if (graph_.is_program(node)) add_program(node);
    }
    for (const auto& input : setup_.inputs) setup_.usual_inputs.push_back(input.name);
    for (const auto& event : setup_.events) setup_.usual_events.push_back(event.name);
    return std::move(setup_);
  }

 private:
  void add_input(const std::string& name, const std::string& actor = "executors",
                 const std::vector<std::string>& returns = {}) {
    setup_.inputs.push_back({name, actor, returns});
    for (const std::string& event : returns) add_event(event, actor);
  }
  void add_event(const std::string& name, const std::string& actor = "executors") {
    setup_.events.push_back({name, actor});
  }

  void add_callback(std::size_t number) {
    const HeldGraph::Callback& callback = graph_.callbacks[number];
    const std::size_t node = graph_.node_of(callback);
    add_event(fmt::format("e{}.c{}", graph_.groups[callback.group].executor, number));
    if (callback.kind == Kind::timer) add_input(fmt::format("c{}.due", number));
    if (graph_.discards(callback)) add_input(fmt::format("c{}.discard", number));
    for (std::size_t run = 0; run < graph_.runs_of(callback); ++run) {
      const std::string prefix = fmt::format("c{}.{}.", number, run);
      add_input(prefix + "start");
      add_input(prefix + "end");
      if (callback.kind == Kind::subscription) {
        for (const std::string& event : message_events(graph_.topics[callback.end], prefix)) {
          add_event(event);
        }
      } else {
        add_event(prefix + "began");
      }
      add_event(prefix + "answered");
      add_calls(node, prefix);
    }
  }

  void add_calls(std::size_t node, const std::string& prefix) {
    const auto contains = [&](const std::vector<std::size_t>& nodes) {
      return std::find(nodes.begin(), nodes.end(), node) != nodes.end();
    };
    for (std::size_t topic = 0; topic < graph_.topics.size(); ++topic) {
      if (contains(graph_.topics[topic].writers))
        add_input(fmt::format("{}t{}.write", prefix, topic));
    }
    for (std::size_t service = 0; service < graph_.services.size(); ++service) {
      const std::string of = fmt::format("{}s{}.", prefix, service);
      if (graph_.services[service].server == node) add_input(of + "answer");
      if (!contains(graph_.services[service].clients)) continue;
      add_input(of + "send");
      add_input(of + "wait");
    }
  }

  void add_program(std::size_t node) {
    const std::string actor = fmt::format("n{}", node), prefix = actor + ".";
    setup_.actors.push_back(actor);
    for (std::size_t number = 0; number < graph_.topics.size(); ++number) {
      const HeldGraph::Topic& topic = graph_.topics[number];
      const std::string of = fmt::format("{}t{}.", prefix, number);
      if (std::count(topic.writers.begin(), topic.writers.end(), node) > 0) {
        add_input(of + "write", actor);
      }
      if (std::count(topic.readers.begin(), topic.readers.end(), node) > 0) {
        add_input(of + "read", actor, message_events(topic, of));
      }
    }
    for (std::size_t number = 0; number < graph_.services.size(); ++number) {
      const HeldGraph::Service& service = graph_.services[number];
      const std::string of = fmt::format("{}s{}.", prefix, number);
      if (std::count(service.clients.begin(), service.clients.end(), node) > 0) {
        add_input(of + "send", actor);
        add_input(of + "receive", actor, {of + "answer"});
      }
      if (service.server == node) {
        add_input(of + "serve", actor, {of + "request"});
        add_input(of + "answer", actor);
      }
    }
  }

  const HeldGraph& graph_;
  SystemSetup setup_;
};

}  // namespace

HeldGraph HeldGraph::from(const std::string& text) {
  if (text.empty()) throw UsageError("option graph: kind=nodes needs it; maide replay writes it");
  try {
    return graph_from(parse_json(text, "option graph"));
  } catch (const nlohmann::json::exception& error) {
    throw UsageError(fmt::format("option graph: {}", error.what()));
  }
}

std::vector<OptionSpec> HeldGraph::options() {
  return {OptionSpec::text("graph", "",
                           "kind=nodes: the nodes, as a JSON object; maide replay writes it")};
}

bool HeldGraph::is_program(std::size_t node) const {
  return std::none_of(groups.begin(), groups.end(),
                      [&](const Group& group) { return group.node == node; });
}

std::size_t HeldGraph::runs_of(const Callback& callback) const {
  const Group& group = groups[callback.group];
  return group.is_reentrant ? executors[group.executor].threads : 1;
}

bool HeldGraph::discards(const Callback& callback) const {
  return callback.kind == Callback::Kind::client &&
         executors[groups[callback.group].executor].goes_by_rounds;
}

SystemSetup held_setup(const HeldGraph& graph) { return SetupMaker(graph).make(); }

}  // namespace maide::ros2
