#include "maide/ros2/replayed_nodes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>

#include "maide/base/error.hpp"
#include "maide/base/json.hpp"
#include "maide/base/text.hpp"
#include "maide/check/rules/model_ends.hpp"
#include "maide/check/rules/service_model.hpp"
#include "maide/check/system/components.hpp"

namespace maide {
namespace {

using UseKind = ModelUse::Kind;

bool contains(const std::vector<std::string>& names, const std::string& name) {
  return std::ranges::find(names, name) != names.end();
}

// "camera" of "camera[i]".

// The writer is one of those that the topic names.
bool is_writer(const TopicInstance& topic, const std::string& name) {
  return std::ranges::any_of(topic.writer_names, [&](const std::string& writer) {
    return array_of(writer) == array_of(name);
  });
}

std::string name_of(const System& system, const ModelUse& use) {
  const InterfaceAutomaton& automaton = system.models[use.model].automaton;
  return (use.kind == UseKind::give ? automaton.inputs() : automaton.outputs()).name(use.index);
}

// The options of a topic's system that are of its ends.
Json options_of_ends(const SystemSpec& spec, const std::string& where) {
  Json options = Json::object();
  for (const auto& [key, value] : spec.options) {
    const bool is_of_end = key.starts_with("pub-") || key.starts_with("sub-");
    if (is_of_end || contains({"depth", "history", "reliability", "durability", "payload"}, key)) {
      options[key] = value;
    }
    const bool is_played =
        (key != "kind" || value == "topic") && (key != "intraprocess" || value == "off") &&
        (key != "contexts" || value == "1") && (key != "payload" || !value.starts_with("values"));
    if (is_played) continue;
    throw UsageError(fmt::format("nodes are not replayed with {}={} ({})", key, value, where));
  }
  return options;
}

}  // namespace

// ---- the system ---------------------------------------------------------------------------------

bool ReplayedNodes::has_node(const System& system, const TopicInstance& topic) {
  return std::ranges::any_of(topic.readers,
                             [](const auto& reader) { return reader.callback.has_value(); }) ||
         std::ranges::any_of(topic.writers, [&](std::uint32_t program) {
           return !system.programs[program].nodes.empty();
         });
}

std::vector<std::uint32_t> ReplayedNodes::find_models(const System& system) {
  std::set<std::uint32_t> models;
  for (const TopicInstance& topic : system.topics) {
    if (!has_node(system, topic)) continue;
    for (const TopicInstance::Reader& reader : topic.readers) models.insert(reader.model);
  }
  const auto is_node = [&](const std::string& name) {
    return std::ranges::any_of(
        system.callbacks, [&](const CallbackInstance& callback) { return callback.node == name; });
  };
  for (const ServiceInstance& service : system.services) {
    if (is_node(service.server) || std::ranges::any_of(service.clients, is_node)) {
      models.insert(service.model);
    }
  }
  return {models.begin(), models.end()};
}

bool ReplayedNodes::contains(std::uint32_t model) const {
  return std::ranges::binary_search(models_, model);
}

// Makes the text by which the wrapper is told of the nodes.
class ReplayedNodes::Describer {
 public:
  Describer(ReplayedNodes& nodes, const std::vector<SystemSpec>& topics)
      : nodes_(nodes), system_(nodes.system_), topics_(topics) {}

  std::string describe() {
    for (const char* list : {"nodes", "executors", "groups", "topics", "services", "callbacks"}) {
      graph_[list] = Json::array();
    }
    for (const CallbackInstance& callback : system_.callbacks) node_named(callback.node);
    refuse_offers();
    add_executors();
    for (std::size_t topic = 0; topic < system_.topics.size(); ++topic) {
      if (has_node(system_, system_.topics[topic]))
        add_topic(system_.topics[topic], topics_[topic]);
    }
    for (const ServiceInstance& service : system_.services) {
      if (nodes_.contains(service.model)) add_service(service);
    }
    for (std::uint32_t number = 0; number < system_.callbacks.size(); ++number) {
      add_callback(number);
    }
    return to_json_line(graph_);
  }

 private:
  std::size_t node_named(const std::string& name) {
    const auto [place, is_new] = nodes_.nodes_.try_emplace(name, nodes_.nodes_.size());
    if (is_new) {
      graph_["nodes"].push_back(name);
      nodes_.meanings_[fmt::format("n{}", place->second)] = name;
    }
    return place->second;
  }

  void add_executors() {
    for (const ExecutorInstance& executor : system_.executors) {
      nodes_.meanings_[fmt::format("e{}", graph_["executors"].size())] = executor.name;
      graph_["executors"].push_back({{"name", executor.name},
                                     {"threads", executor.threads},
                                     {"rounds", executor.goes_by_rounds}});
    }
    for (const auto& group : nodes_.rules_.groups()) {
      const CallbackInstance& first = system_.callbacks[group.front()];
      for (const std::uint32_t callback : group) {
        group_of_[callback] = graph_["groups"].size();
      }
      graph_["groups"].push_back({{"node", node_named(first.node)},
                                  {"executor", first.executor},
                                  {"reentrant", first.is_reentrant}});
    }
  }

  void add_topic(const TopicInstance& topic, const SystemSpec& spec) {
    const std::size_t number = graph_["topics"].size();
    const std::string end = fmt::format("t{}", number);
    nodes_.meanings_[end] = topic.name;
    const ModelInstance& model = system_.models[topic.readers.front().model];
    Json json{{"options", options_of_ends(spec, to_string(model.position))},
              {"writers", Json::array()},
              {"readers", Json::array()}};
    if (topic.delivers_one) {
      throw UsageError(
          fmt::format("a topic of ROS 2 delivers to all ({})", to_string(model.position)));
    }
    std::set<std::size_t> writers;
    for (const std::uint32_t writer : topic.writers) {
      const Program& program = system_.programs[writer];
      if (program.nodes.empty()) writers.insert(node_named(program.name));
      for (const std::string& node : program.nodes) {
        if (is_writer(topic, node)) writers.insert(node_named(node));
      }
    }
    json["writers"] = writers;
    for (const TopicInstance::Reader& reader : topic.readers) add_reader(reader, end, json);
    graph_["topics"].push_back(std::move(json));
  }

  void add_reader(const TopicInstance::Reader& reader, const std::string& end, Json& topic) {
    nodes_.ends_[reader.model] = end;
    const ModelInstance& model = system_.models[reader.model];
    const Alphabet& outputs = model.automaton.outputs();
    for (const std::string& output : outputs.names()) {
      if (!is_of_writer(model.automaton, output)) continue;
      throw UsageError(fmt::format("nodes are not replayed on a model with {} ({})", output,
                                   to_string(model.position)));
    }
    if (reader.callback) {
      subscribed_[*reader.callback] = graph_["topics"].size();
      return;
    }
    const std::size_t node = node_named(system_.programs[reader.program].name);
    topic["readers"].push_back(node);
    for (const std::string& output : outputs.names()) {
      nodes_.outputs_[fmt::format("n{}.{}.{}", node, end, output)] = {reader.model, 0, output};
    }
  }

  void add_service(const ServiceInstance& service) {
    const std::string end = fmt::format("s{}", graph_["services"].size());
    const ModelInstance& model = system_.models[service.model];
    nodes_.meanings_[end] = service.name;
    nodes_.ends_[service.model] = end;
    services_[service.model] = graph_["services"].size();
    const std::string& depth = model.automaton.origin.at("depth");
    if (depth == unknown_depth) {
      throw UsageError(
          fmt::format("service {}: its depth is unknown, so it is not known what to run ({})",
                      service.name, to_string(model.position)));
    }
    Json json{{"depth", std::stoul(depth)},
              {"server", node_named(service.server)},
              {"clients", Json::array()}};
    nodes_.outputs_[fmt::format("n{}.{}.request", node_named(service.server), end)] = {
        service.model, 0, "request"};
    for (std::uint32_t client = 0; client < service.clients.size(); ++client) {
      const std::size_t node = node_named(service.clients[client]);
      json["clients"].push_back(node);
      nodes_.outputs_[fmt::format("n{}.{}.answer", node, end)] = {service.model, client + 1,
                                                                  name_at_client("answer", client)};
    }
    graph_["services"].push_back(std::move(json));
  }

  void refuse_offers() const {
    for (const ServiceInstance& service : system_.services) {
      const auto is_presence = [&](const ModelInstance& model) {
        return model.source == ModelInstance::Source::variable &&
               model.name == presence_of(service.name);
      };
      if (std::ranges::none_of(system_.models, is_presence)) continue;
      throw UsageError(fmt::format("{}: a service that is offered later is not replayed yet ({})",
                                   service.name, system_.file));
    }
  }

  void add_callback(std::uint32_t number) {
    const CallbackInstance& callback = system_.callbacks[number];
    nodes_.meanings_[fmt::format("c{}", number)] = callback.name;
    Json json{{"name", callback.name}, {"group", group_of_.at(number)}};
    switch (callback.kind) {
      case CallbackInstance::Kind::timer: json["timer"] = true; break;
      case CallbackInstance::Kind::subscription:
        if (!subscribed_.contains(number)) {
          throw UsageError(fmt::format(
              "callback {} takes from no topic, so there is no subscription to run ({})",
              callback.name, system_.file));
        }
        json["subscription"] = subscribed_.at(number);
        break;
      case CallbackInstance::Kind::service: json["service"] = services_.at(callback.model); break;
      case CallbackInstance::Kind::client: json["client"] = services_.at(callback.model); break;
      case CallbackInstance::Kind::start:
      case CallbackInstance::Kind::main:
      case CallbackInstance::Kind::thread:
        throw UsageError(
            fmt::format("{}: nodes with a start or threads of their own are not replayed yet ({})",
                        callback.name, system_.file));
    }
    graph_["callbacks"].push_back(std::move(json));
  }

  ReplayedNodes& nodes_;
  const System& system_;
  const std::vector<SystemSpec>& topics_;
  Json graph_ = Json::object();
  std::map<std::uint32_t, std::size_t> group_of_, subscribed_;  // by callback: groups, topics
  std::map<std::uint32_t, std::size_t> services_;               // by model
};

ReplayedNodes::ReplayedNodes(const System& system, const std::vector<SystemSpec>& topics)
    : system_(system), rules_(system), models_(find_models(system)) {
  spec_.kind = SystemSpec::Kind::wrapper;
  spec_.text = spec_.target = "ros2";
  spec_.options["kind"] = "nodes";
  for (std::size_t topic = 0; topic < topics.size(); ++topic) {
    if (!has_node(system, system.topics[topic])) continue;
    const ModelInstance& model = system.models[system.topics[topic].readers.front().model];
    if (topics[topic].kind != SystemSpec::Kind::wrapper || topics[topic].target != "ros2") {
      throw UsageError(fmt::format("topic {} was learned from {}, and nodes run on ros2 ({})",
                                   system.topics[topic].name, topics[topic].text,
                                   to_string(model.position)));
    }
    const auto rmw = topics[topic].options.find("rmw");
    if (rmw != topics[topic].options.end()) run_over(rmw->second, model);
  }
  for (const ServiceInstance& service : system.services) {
    if (!contains(service.model)) continue;
    const ModelInstance& model = system.models[service.model];
    const auto rmw = model.automaton.origin.find("rmw");
    if (rmw != model.automaton.origin.end()) run_over(rmw->second, model);
  }
  spec_.options["graph"] = Describer(*this, topics).describe();
}

void ReplayedNodes::run_over(const std::string& rmw, const ModelInstance& model) {
  const auto [place, is_new] = spec_.options.try_emplace("rmw", rmw);
  if (!is_new && place->second != rmw) {
    throw UsageError(
        fmt::format("what is over {} and what is over {} have no nodes in common: `rmw` of topics "
                    "and services says it ({})",
                    place->second, rmw, to_string(model.position)));
  }
}

// ---- names --------------------------------------------------------------------------------------

std::optional<ReplayedNodes::Output> ReplayedNodes::output_of(const std::string& event) const {
  const auto place = outputs_.find(event);
  return place == outputs_.end() ? std::nullopt : std::optional(place->second);
}

std::string ReplayedNodes::describe(const std::string& name) const {
  const std::size_t dot = name.find('.');
  const auto what = meanings_.find(name.substr(0, dot));
  if (dot == std::string::npos || what == meanings_.end()) return name;
  const std::string rest = name.substr(dot + 1);
  if (name.front() == 'e') {
    if (rest == "nothing") return what->second + " finds nothing";
    const auto callback = meanings_.find(rest);
    return what->second + " picks " + (callback == meanings_.end() ? rest : callback->second);
  }
  std::string last = name.substr(name.rfind('.') + 1);
  if (name.front() == 'n') return last;
  if (last == "began") return what->second + " starts";
  if (last == "discard") return what->second + " throws away answers to others";
  if (last == "answered") return what->second + " has its answer";
  return what->second + " starts: " + last;
}

std::string ReplayedNodes::call_of(std::uint32_t program, const std::string& run,
                                   const ModelUse& use) const {
  const std::string name = name_of(system_, use);
  const std::string& end = ends_.at(use.model);
  if (end.front() == 's') {
    for (const char* call : {"send", "receive", "serve"}) {
      if (name.starts_with(call)) return fmt::format("{}{}.{}", run, end, call);
    }
    return fmt::format("{}{}.{}", run, end, use.kind == UseKind::give ? "answer" : "wait");
  }
  const bool is_played = name == "write" || (name == "read" && run.front() == 'n');
  if (is_played) return fmt::format("{}{}.{}", run, end, name);
  throw UsageError(fmt::format("{}: {} of {} is not replayed beside nodes",
                               system_.programs[program].name, name,
                               system_.models[use.model].name));
}

// ---- calls --------------------------------------------------------------------------------------

// What is asked in each step of a schedule.
class ReplayedNodes::Caller {
 public:
  Caller(const ReplayedNodes& nodes, const Trace& trace)
      : nodes_(nodes),
        system_(nodes.system_),
        trace_(trace),
        state_(nodes.rules_.initial()),
        runs_(system_.programs.size()) {}

  std::vector<Call> calls_of(const ScheduledStep& scheduled) {
    const Step& step = trace_.steps[scheduled.step];
    std::vector<Call> calls = picks_before(scheduled);
    if (const auto started = started_by(system_, step)) {
      runs_[step.actor] = {*started, nodes_.rules_.start(state_, *started)};
      const std::string prefix = prefix_of(step.actor);
      calls.push_back({prefix + "start", {prefix + label_of(step, *started)}});
    } else if (const auto discarding = discarded_by(system_, step)) {
      nodes_.rules_.discard(state_, *discarding);
      calls.push_back({fmt::format("c{}.discard", *discarding), {}});
    } else if (is_end_of_callback(system_, step)) {
      nodes_.rules_.end(state_, runs_[step.actor].first, runs_[step.actor].second);
      calls.push_back({prefix_of(step.actor) + "end", {}});
    } else if (!step.is_beyond) {
      add_calls(step, calls);
    }
    return calls;
  }

  // Where nothing can happen any more: what programs wait for, and then all executors go on by
  // themselves.
  std::vector<Call> calls_at_end(const GlobalState& last) const {
    std::vector<Call> calls;
    for (const std::uint32_t program : deadlocked_programs(system_, last)) {
      if (const auto call = waiting_call(program, last)) calls.push_back({*call, {}});
    }
    if (is_over(system_, last)) calls.push_back({"free", {}});
    return calls;
  }

 private:
  std::string prefix_of(std::uint32_t program) const {
    const Program& of = system_.programs[program];
    if (!of.nodes.empty()) {
      return fmt::format("c{}.{}.", runs_[program].first, runs_[program].second);
    }
    const auto node = nodes_.nodes_.find(of.name);
    return node == nodes_.nodes_.end() ? "" : fmt::format("n{}.", node->second);
  }

  // A timer is due when somebody picks it.
  std::vector<Call> picks_before(const ScheduledStep& scheduled) const {
    const Step& step = trace_.steps[scheduled.step];
    std::vector<std::uint32_t> due = found_by(system_, step);
    if (const auto started = started_by(system_, step); started && !scheduled.picks.empty()) {
      due.push_back(*started);
    }
    std::vector<Call> calls;
    for (const std::uint32_t callback : due) {
      if (system_.callbacks[callback].kind != CallbackInstance::Kind::timer) continue;
      calls.push_back({fmt::format("c{}.due", callback), {}});
    }
    for (const std::uint32_t callback : scheduled.picks) {
      const std::uint32_t executor = system_.callbacks[callback].executor;
      calls.push_back(
          {fmt::format("e{}.pick", executor), {fmt::format("e{}.c{}", executor, callback)}});
    }
    return calls;
  }

  std::string label_of(const Step& step, std::uint32_t callback) const {
    if (system_.callbacks[callback].kind != CallbackInstance::Kind::subscription) return "began";
    for (const ModelUse& event : events_of(system_, step)) {
      if (event.kind == UseKind::take) return name_of(system_, event);
    }
    return "message";
  }

  // A write concerns all readers' models, and is one call.
  void add_calls(const Step& step, std::vector<Call>& calls) const {
    const std::string prefix = prefix_of(step.actor);
    const bool is_callback = prefix.starts_with('c');
    std::set<std::string> made;
    for (const ModelUse& event : events_of(system_, step)) {
      if (!nodes_.contains(event.model) || (event.kind != UseKind::give && !is_callback)) continue;
      const std::string call = nodes_.call_of(step.actor, prefix, event);
      if (!made.insert(call).second) continue;
      calls.push_back({call, {}});
      if (event.kind == UseKind::take) calls.back().expected = {prefix + "answered"};
    }
  }

  std::optional<std::string> waiting_call(std::uint32_t number, const GlobalState& last) const {
    const Program& program = system_.programs[number];
    const bool is_thread = !program.nodes.empty();
    if (is_thread && program.may_rest(last.programs[number])) return std::nullopt;
    for (const ProgramEdge& edge : program.edges_of(last.programs[number])) {
      for (const ModelUse& event : program.events_of(edge)) {
        const bool is_call = is_thread == (event.kind != UseKind::give);
        if (!nodes_.contains(event.model) || !is_call) continue;
        const InterfaceAutomaton& automaton = system_.models[event.model].automaton;
        if (!automaton.is_quiescent(last.models[event.model])) continue;
        return nodes_.call_of(number, prefix_of(number), event);
      }
    }
    return std::nullopt;
  }

  const ReplayedNodes& nodes_;
  const System& system_;
  const Trace& trace_;
  ExecutorRules::State state_;
  std::vector<std::pair<std::uint32_t, std::size_t>> runs_;  // by program: callback and run
};

ReplayedNodes::Calls ReplayedNodes::plan(const Trace& trace, const GlobalState& last,
                                         std::span<const std::size_t> moves) const {
  Caller caller(*this, trace);
  Calls calls;
  for (const ScheduledStep& step : schedule(system_, rules_, trace, moves)) {
    calls.moves.push_back(caller.calls_of(step));
  }
  if (!trace.loop_start) calls.end = caller.calls_at_end(last);
  return calls;
}

}  // namespace maide
