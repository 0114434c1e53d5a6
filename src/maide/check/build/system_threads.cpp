// The programs that run the callbacks of a system file's nodes, the models of their threads, and
// those of the services.
#include <algorithm>
#include <cstdint>
#include <map>
#include <memory>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "maide/check/build/system_reader.hpp"
#include "maide/check/rules/service_model.hpp"

namespace maide {
namespace {

using program_syntax::Callback;

// Which runs of a callback there are, as a set. The first that is free starts.
InterfaceAutomaton make_runs(std::uint32_t count) {
  std::vector<std::string> inputs;
  for (std::uint32_t run = 0; run < count; ++run) {
    inputs.push_back("start" + std::to_string(run + 1));
    inputs.push_back("end" + std::to_string(run + 1));
  }
  InterfaceAutomaton runs(Alphabet(std::span<const std::string>(inputs)), {},
                          std::size_t{1} << count);
  for (StateId set = 0; set < runs.size(); ++set) {
    std::uint32_t first = 0;
    while ((set >> first & 1) != 0) ++first;
    if (first < count) {
      runs.add_transition(set, {Action::Kind::input, 2 * first}, set | StateId{1} << first);
    }
    for (std::uint32_t run = 0; run < count; ++run) {
      if ((set >> run & 1) == 0) continue;
      runs.add_transition(set, {Action::Kind::input, 2 * run + 1}, set & ~(StateId{1} << run));
    }
  }
  return runs;
}

}  // namespace

std::uint32_t SystemReader::add_hidden_model(const std::string& name, InterfaceAutomaton automaton,
                                             const YAML::Node& key) {
  if (system_.models.size() == max_components) fail("too many models", key);
  take_name(name, key);
  ModelInstance model;
  model.name = name;
  model.automaton = std::move(automaton);
  model.source = ModelInstance::Source::executor;
  model.position = at(key);
  system_.models.push_back(std::move(model));
  return static_cast<std::uint32_t>(system_.models.size() - 1);
}

std::uint32_t SystemReader::runs_of(const NodeOf& node, std::size_t callback) const {
  const std::string& group = node.callback_groups[callback];
  const bool is_reentrant = !group.empty() && node.groups.at(group);
  return is_reentrant ? executors_[node.executor].threads : 1;
}

void SystemReader::make_threads() {
  for (NodeOf& node : nodes_) read_callbacks(node);
  for (const Executor& executor : executors_) {
    system_.executors.push_back({executor.name, executor.threads, executor.goes_by_rounds});
  }
  for (NodeOf& node : nodes_) {
    std::uint32_t asker = 0;
    for (std::size_t i = 0; i < node.callbacks.size(); ++i) {
      Callback& callback = node.callbacks[i];
      const std::string& group = node.callback_groups[i];
      callback.asker = asker;
      asker += runs_of(node, i);
      callback.number = static_cast<std::uint32_t>(system_.callbacks.size());
      system_.callbacks.push_back({callback.kind, node.name, callback.whole_name(), node.executor,
                                   group, !group.empty() && node.groups.at(group), callback.model});
    }
  }
  std::set<std::uint32_t> made;
  for (const NodeOf& first : nodes_) {
    const Executor& executor = executors_[first.executor];
    if (!made.insert(first.executor).second) continue;
    if (executor.threads == 1) {
      std::vector<Callback> all;
      for (const std::uint32_t node : executor.nodes) {
        all.insert(all.end(), nodes_[node].callbacks.begin(), nodes_[node].callbacks.end());
      }
      make_thread(executor.nodes.size() == 1 ? first.name : executor.name, executor, std::move(all),
                  executor.nodes);
      continue;
    }
    const std::uint32_t threads = add_hidden_model(executor.name + ".threads",
                                                   make_semaphore(executor.threads), executor.key);
    for (const std::uint32_t node : executor.nodes) make_groups(executor, nodes_[node], threads);
  }
  make_services();
}

void SystemReader::make_groups(const Executor& executor, NodeOf& node, std::uint32_t threads) {
  using Kind = ModelUse::Kind;
  const auto number = static_cast<std::uint32_t>(&node - nodes_.data());
  std::map<std::string, std::vector<Callback>> exclusive;
  std::vector<std::string> order;
  for (std::size_t i = 0; i < node.callbacks.size(); ++i) {
    Callback callback = node.callbacks[i];
    callback.start.push_back({Kind::give, threads, 0});
    callback.end.push_back({Kind::give, threads, 1});
    const std::uint32_t runs = runs_of(node, i);
    if (runs == 1) {
      const std::string& group = node.callback_groups[i];
      if (!exclusive.contains(group)) order.push_back(group);
      exclusive[group].push_back(std::move(callback));
      continue;
    }
    const std::uint32_t model =
        add_hidden_model(callback.whole_name() + ".runs", make_runs(runs), executor.key);
    for (std::uint32_t run = 0; run < runs; ++run) {
      Callback copy = callback;
      copy.run = run;
      copy.asker += run;
      copy.start.push_back({Kind::give, model, 2 * run});
      copy.end.push_back({Kind::give, model, 2 * run + 1});
      make_thread(callback.whole_name() + "[" + std::to_string(run) + "]", executor, {copy},
                  {number});
    }
  }
  for (const std::string& group : order) {
    make_thread(node.name + (group.empty() ? "" : "." + group), executor,
                std::move(exclusive[group]), {number});
  }
}

void SystemReader::make_thread(const std::string& name, const Executor& executor,
                               std::vector<Callback> callbacks,
                               const std::vector<std::uint32_t>& nodes) {
  if (texts_.size() == max_components) fail("too many programs", executor.key);
  for (const ProgramText& other : texts_) {
    if (other.name != name) continue;
    fail("the program '" + name + "' has the name of what runs a node's callbacks here",
         executor.key);
  }
  std::stable_sort(callbacks.begin(), callbacks.end(),
                   [](const Callback& a, const Callback& b) { return a.kind < b.kind; });
  ProgramText text;
  text.name = name;
  text.text = text_of(executor.key);
  text.execution = executor.threads > 1
                       ? "on " + std::to_string(executor.threads) + " threads"
                       : std::string("on one thread, ") +
                             (executor.goes_by_rounds ? "by rounds, in the order of rclcpp Humble"
                                                      : "in any order");
  text.thread = std::make_shared<program_syntax::Thread>();
  text.thread->callbacks = std::move(callbacks);
  text.thread->goes_by_rounds = executor.goes_by_rounds;
  for (const std::uint32_t node : nodes) {
    text.nodes.push_back(nodes_[node].name);
    nodes_[node].programs.push_back(static_cast<std::uint32_t>(texts_.size()));
  }
  texts_.push_back(std::move(text));
}

void SystemReader::make_services() {
  for (auto& [model, service] : names_.services) {
    ServiceShape shape;
    shape.is_depth_unknown = service.is_depth_unknown;
    shape.depth = service.depth;
    for (const End& client : service.clients) {
      shape.names.push_back(client.node.empty() ? texts_[client.program].name : client.node);
      std::uint32_t askers = 0;
      bool is_looked_at = false;
      for (const NodeOf& node : nodes_) {
        if (node.name != client.node) continue;
        is_looked_at = executors_[node.executor].goes_by_rounds;
        for (std::size_t i = 0; i < node.callbacks.size(); ++i) askers += runs_of(node, i);
      }
      shape.askers.push_back(askers);
      shape.is_looked_at.push_back(is_looked_at);
    }
    shape.takes_one_by_one = service.takes_one_by_one;
    for (const NodeOf& node : nodes_) {
      for (std::size_t i = 0; i < node.callbacks.size(); ++i) {
        const Callback& callback = node.callbacks[i];
        if (callback.kind != Callback::Kind::service || callback.model != model) continue;
        shape.servers = runs_of(node, i);
      }
    }
    const End& server = service.server;
    system_.services.push_back({service.name,
                                server.node.empty() ? texts_[server.program].name : server.node,
                                shape.names, model});
    service.server_runs = shape.servers;
    shape.is_served_by_node = !service.server.node.empty();
    const bool has_node =
        shape.is_served_by_node ||
        std::any_of(shape.askers.begin(), shape.askers.end(), [](auto count) { return count > 0; });
    if (!system_.models[model].origin.empty() && !has_node) {
      shape.sul = system_.models[model].origin +
                  " kind=service depth=" + std::to_string(shape.depth) +
                  " clients=" + std::to_string(shape.askers.size());
      if (!service.rmw.empty()) shape.sul += " rmw=" + service.rmw;
    }
    // What looks find depends on it, whether the file says it or not.
    const bool finds_others =
        shape.askers.size() > 1 && std::find(shape.is_looked_at.begin(), shape.is_looked_at.end(),
                                             true) != shape.is_looked_at.end();
    shape.rmw = service.rmw.empty() && finds_others ? "cyclonedds" : service.rmw;
    auto rules = std::make_unique<ServiceModel>(std::move(shape));
    service.rules = rules.get();
    system_.models[model].automaton = rules->start();
    system_.models[model].is_grown = true;
    growing_.emplace(model, std::move(rules));
  }
}

void SystemReader::read_node_variables(const NodeOf& node) {
  const YAML::Node section = node.value["variables"];
  if (!section) return;
  scalar(section, "'variables'");
  const ScalarText text = text_of(section);
  for (VariableName& variable : program_syntax::parse_variables(text, context(node.indices))) {
    variable.leaf.op = Expression::Operator::shared;
    variable.leaf.name = node.name + "." + variable.leaf.name;
    const std::string name = variable.leaf.name;
    const SourcePosition place = variable.position;
    if (!names_.variables.emplace(name, std::move(variable)).second) {
      throw ParseError("the variable '" + name + "' is there twice", place);
    }
  }
}

program_syntax::Tree SystemReader::parse(std::uint32_t program,
                                         const program_syntax::Context& known) const {
  const ProgramText& text = texts_[program];
  if (text.thread) return program_syntax::parse_thread(*text.thread, text.text, known);
  return program_syntax::parse(text.text, known);
}

}  // namespace maide
