// The programs that run the callbacks of nodes, and the models of their threads. The callbacks of a
// single-threaded executor are one program; so are those of an exclusive group on several threads;
// each run of a reentrant one is a program of its own.
#include <algorithm>
#include <cstdint>
#include <map>
#include <memory>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "maide/check/build/declarations.hpp"
#include "maide/check/build/deliveries.hpp"

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

// A model that no text names.
std::uint32_t add_model(Declarations& file, const std::string& name, InterfaceAutomaton automaton,
                        const TreeNode& entry) {
  if (file.models.size() == max_components) file.tree().fail_at_name("too many models", entry);
  ModelInstance model;
  model.position = file.tree().at_name(entry);
  file.take_name(name, model.position);
  model.name = name;
  model.automaton = std::move(automaton);
  model.source = ModelInstance::Source::executor;
  file.models.push_back(std::move(model));
  file.origins.emplace_back();
  return static_cast<std::uint32_t>(file.models.size() - 1);
}

void add_thread(Declarations& file, const std::string& name, const ExecutorDeclaration& executor,
                std::vector<Callback> callbacks, const std::vector<std::uint32_t>& nodes) {
  if (file.programs.size() == max_components) {
    file.tree().fail_at_name("too many programs", *executor.entry);
  }
  for (const ProgramDeclaration& other : file.programs) {
    if (other.name != name) continue;
    file.tree().fail_at_name(
        "the program '" + name + "' has the name of what runs a node's callbacks here",
        *executor.entry);
  }
  std::stable_sort(callbacks.begin(), callbacks.end(),
                   [](const Callback& a, const Callback& b) { return a.kind < b.kind; });
  ProgramDeclaration program;
  program.name = name;
  program.process = process_of(*executor.entry, "executor " + executor.name);
  program.position = file.tree().at_name(*executor.entry);
  program.execution = executor.threads > 1 ? "on " + std::to_string(executor.threads) + " threads"
                                           : std::string("on one thread, ") +
                                                 (executor.goes_by_rounds
                                                      ? "by rounds, in the order of rclcpp Humble"
                                                      : "in any order");
  program.thread = std::make_shared<program_syntax::Thread>();
  program.thread->callbacks = std::move(callbacks);
  program.thread->goes_by_rounds = executor.goes_by_rounds;
  for (const std::uint32_t node : nodes) {
    program.nodes.push_back(file.nodes[node].name);
    file.nodes[node].programs.push_back(static_cast<std::uint32_t>(file.programs.size()));
  }
  file.programs.push_back(std::move(program));
}

// Of a node on several threads: a program for each exclusive group and for each run of a reentrant
// callback. A start takes one of the threads.
void add_groups(Declarations& file, const ExecutorDeclaration& executor, std::uint32_t number,
                std::uint32_t threads) {
  using Kind = ModelUse::Kind;
  const NodeDeclaration node = file.nodes[number];
  std::map<std::string, std::vector<Callback>> exclusive;
  std::vector<std::string> order;
  for (std::size_t i = 0; i < node.callbacks.size(); ++i) {
    Callback callback = node.callbacks[i];
    callback.start.push_back({Kind::give, threads, 0});
    callback.end.push_back({Kind::give, threads, 1});
    const std::uint32_t runs = runs_of(file, node, i);
    if (runs == 1) {
      const std::string& group = node.callback_groups[i];
      if (!exclusive.contains(group)) order.push_back(group);
      exclusive[group].push_back(std::move(callback));
      continue;
    }
    const std::uint32_t model =
        add_model(file, callback.whole_name() + ".runs", make_runs(runs), *executor.entry);
    for (std::uint32_t run = 0; run < runs; ++run) {
      Callback copy = callback;
      copy.run = run;
      copy.asker += run;
      copy.start.push_back({Kind::give, model, 2 * run});
      copy.end.push_back({Kind::give, model, 2 * run + 1});
      add_thread(file, callback.whole_name() + "[" + std::to_string(run) + "]", executor, {copy},
                 {number});
    }
  }
  for (const std::string& group : order) {
    add_thread(file, node.name + (group.empty() ? "" : "." + group), executor,
               std::move(exclusive[group]), {number});
  }
}

void number_callbacks(Declarations& file) {
  for (NodeDeclaration& node : file.nodes) {
    std::uint32_t asker = 0;
    for (std::size_t i = 0; i < node.callbacks.size(); ++i) {
      Callback& callback = node.callbacks[i];
      const std::string& group = node.callback_groups[i];
      callback.asker = asker;
      asker += runs_of(file, node, i);
      callback.number = static_cast<std::uint32_t>(file.callbacks.size());
      file.callbacks.push_back({callback.kind, node.name, callback.whole_name(), node.executor,
                                group, !group.empty() && node.groups.at(group), callback.model});
    }
  }
}

// ---- Services, by who stands at their ends ------------------------------------------------------

ServiceShape shape_of(const Declarations& file, std::uint32_t model, const Service& service) {
  ServiceShape shape;
  shape.is_depth_unknown = service.is_depth_unknown;
  shape.depth = service.depth;
  for (const End& client : service.clients) {
    shape.names.push_back(client.node.empty() ? file.programs[client.program].name : client.node);
    std::uint32_t askers = 0;
    bool is_looked_at = false;
    for (const NodeDeclaration& node : file.nodes) {
      if (node.name != client.node) continue;
      is_looked_at = file.executors[node.executor].goes_by_rounds;
      for (std::size_t i = 0; i < node.callbacks.size(); ++i) askers += runs_of(file, node, i);
    }
    shape.askers.push_back(askers);
    shape.is_looked_at.push_back(is_looked_at);
  }
  shape.takes_one_by_one = service.takes_one_by_one;
  for (const NodeDeclaration& node : file.nodes) {
    for (std::size_t i = 0; i < node.callbacks.size(); ++i) {
      const Callback& callback = node.callbacks[i];
      if (callback.kind != Callback::Kind::service || callback.model != model) continue;
      shape.servers = runs_of(file, node, i);
    }
  }
  shape.is_served_by_node = !service.server.node.empty();
  const DeliveryWish& wish = file.deliveries.at(model);
  for (const End& client : service.clients) {
    DeliveryPlace place;
    place.is_in_one_process = process_of_end(file, client) == process_of_end(file, service.server);
    place.is_of_ros2 =
        !file.models[model].origin.empty() || !service.server.node.empty() || !client.node.empty();
    const DeliveryRule rule = delivery_of(service, wish, place);
    shape.is_late.push_back(rule.delivery == Delivery::late && !file.is_at_rest);
    shape.loses = rule.wire.loses;
  }
  shape.is_in_stream = !wish.stream.empty();
  shape.callers = static_cast<std::uint32_t>(service.callers.size());
  return shape;
}

// The programs whose answers return when all clients have them; none: they return at once.
std::vector<std::uint32_t> callers_of(const Declarations& file, std::uint32_t model,
                                      const Service& service) {
  const bool is_acknowledged = file.deliveries.at(model).delivery == Delivery::acknowledged;
  if (!is_acknowledged || service.clients.size() == 1 || file.is_at_rest) return {};
  return programs_at(file, service.server);
}

void shape_services(Declarations& file) {
  for (auto& [model, service] : file.names.services) {
    service.callers = callers_of(file, model, service);
    ServiceShape shape = shape_of(file, model, service);
    const End& server = service.server;
    file.services.push_back({service.name,
                             server.node.empty() ? file.programs[server.program].name : server.node,
                             shape.names, model});
    service.server_runs = shape.servers;
    const bool has_node =
        shape.is_served_by_node ||
        std::any_of(shape.askers.begin(), shape.askers.end(), [](auto count) { return count > 0; });
    const std::string& origin = file.models[model].origin;
    if (!origin.empty() && !has_node) {
      shape.sul = origin + " kind=service depth=" + std::to_string(shape.depth) +
                  " clients=" + std::to_string(shape.askers.size());
      if (!service.rmw.empty()) shape.sul += " rmw=" + service.rmw;
    }
    // What looks find depends on it, whether the file says it or not.
    const bool finds_others =
        shape.askers.size() > 1 && std::find(shape.is_looked_at.begin(), shape.is_looked_at.end(),
                                             true) != shape.is_looked_at.end();
    shape.rmw = service.rmw.empty() && finds_others ? "cyclonedds" : service.rmw;
    file.models[model].is_grown = true;
    file.shapes.emplace(model, std::move(shape));
  }
}

}  // namespace

void declare_threads(Declarations& file) {
  number_callbacks(file);
  std::set<std::uint32_t> made;
  for (std::size_t first = 0; first < file.nodes.size(); ++first) {
    const std::uint32_t number = file.nodes[first].executor;
    const ExecutorDeclaration executor = file.executors[number];
    if (!made.insert(number).second) continue;
    if (executor.threads == 1) {
      std::vector<Callback> all;
      for (const std::uint32_t node : executor.nodes) {
        const auto& callbacks = file.nodes[node].callbacks;
        all.insert(all.end(), callbacks.begin(), callbacks.end());
      }
      add_thread(file, executor.nodes.size() == 1 ? file.nodes[first].name : executor.name,
                 executor, std::move(all), executor.nodes);
      continue;
    }
    const std::uint32_t threads = add_model(file, executor.name + ".threads",
                                            make_semaphore(executor.threads), *executor.entry);
    for (const std::uint32_t node : executor.nodes) add_groups(file, executor, node, threads);
  }
  shape_services(file);
}

}  // namespace maide
