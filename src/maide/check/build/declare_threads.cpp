// The programs that run the callbacks of nodes, and the models of their threads. The callbacks of a
// single-threaded executor are one program; so are those of an exclusive group on several threads;
// each run of a reentrant one is a program of its own, and so is each copy of a node's own thread.
// What nodes do as they start comes first: in the one program, or in one that opens the way for the
// others.
#include <algorithm>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "maide/check/build/clock_code.hpp"
#include "maide/check/build/declarations.hpp"
#include "maide/check/build/deliveries.hpp"
#include "maide/check/rules/thread_models.hpp"

namespace maide {
namespace {

using program_syntax::Callback;

// What runs one after the other: the starts, then callbacks as they can.
struct Line {
  std::vector<Callback> starts, callbacks;
  std::optional<Callback> main{};
};

// "on one thread, in any order".
std::string execution_of(const ExecutorDeclaration& executor) {
  if (executor.threads > 1) return "on " + std::to_string(executor.threads) + " threads";
  return std::string("on one thread, ") +
         (executor.goes_by_rounds ? "by rounds, in the order of rclcpp Humble" : "in any order");
}

void add_thread(Declarations& file, const std::string& name, const ExecutorDeclaration& executor,
                Line line, const std::vector<std::uint32_t>& nodes) {
  if (file.programs.size() == max_components) {
    file.tree().fail_at_name("too many programs", *executor.entry);
  }
  for (const ProgramDeclaration& other : file.programs) {
    if (other.name != name) continue;
    file.tree().fail_at_name(
        "the program '" + name + "' has the name of what runs a node's callbacks here",
        *executor.entry);
  }
  std::ranges::stable_sort(line.callbacks, {}, &Callback::kind);
  ProgramDeclaration program;
  program.name = name;
  program.process = process_of(*executor.entry, "executor " + executor.name);
  program.position = file.tree().at_name(*executor.entry);
  const bool runs_callbacks = std::ranges::any_of(
      line.callbacks, [](const Callback& callback) { return is_of_executor(callback.kind); });
  if (runs_callbacks) program.execution = execution_of(executor);
  program.thread = std::make_shared<program_syntax::Thread>();
  program.thread->starts = std::move(line.starts);
  program.thread->main = std::move(line.main);
  program.thread->executor = executor.name;
  program.thread->may_spin = executor.threads == 1;
  program.thread->callbacks = std::move(line.callbacks);
  program.thread->goes_by_rounds = executor.goes_by_rounds && runs_callbacks;
  for (const std::uint32_t node : nodes) {
    program.nodes.push_back(file.nodes[node].name);
    file.nodes[node].programs.push_back(static_cast<std::uint32_t>(file.programs.size()));
  }
  file.programs.push_back(std::move(program));
}

// Of a node on several threads: a program for each exclusive group and for each run of a reentrant
// callback. A start takes one of the threads, and passes the gate, if there is one.
void add_groups(Declarations& file, const ExecutorDeclaration& executor, std::uint32_t number,
                std::uint32_t threads, std::optional<std::uint32_t> gate) {
  using Kind = ModelUse::Kind;
  const NodeDeclaration node = file.nodes[number];
  std::map<std::string, std::vector<Callback>> exclusive;
  std::vector<std::string> order;
  for (std::size_t i = 0; i < node.callbacks.size(); ++i) {
    if (!is_of_executor(node.callbacks[i].kind)) continue;
    Callback callback = node.callbacks[i];
    callback.start.push_back({Kind::give, threads, 0});
    if (gate) callback.start.push_back({Kind::give, *gate, gate_input_pass});
    callback.end.push_back({Kind::give, threads, 1});
    const std::uint32_t runs = runs_of(file, node, i);
    const std::string& group = node.callback_groups[i];
    if (group.empty() || !node.groups.at(group)) {
      if (!exclusive.contains(group)) order.push_back(group);
      exclusive[group].push_back(std::move(callback));
      continue;
    }
    const std::uint32_t model =
        add_hidden_model(file, callback.whole_name() + ".runs", make_runs(runs),
                         file.tree().at_name(*executor.entry));
    for (std::uint32_t run = 0; run < runs; ++run) {
      Callback copy = callback;
      copy.run = run;
      copy.asker += run;
      copy.start.push_back({Kind::give, model, 2 * run});
      copy.end.push_back({Kind::give, model, 2 * run + 1});
      add_thread(file, callback.whole_name() + "[" + std::to_string(run) + "]", executor,
                 {{}, {copy}, {}}, {number});
    }
  }
  for (const std::string& group : order) {
    add_thread(file, node.name + (group.empty() ? "" : "." + group), executor,
               {{}, std::move(exclusive[group]), {}}, {number});
  }
}

// Some text of the node, or of a procedure, begins the thread.
bool is_run(const Declarations& file, const NodeDeclaration& node, const std::string& thread) {
  bool found = false;
  const auto look = [&](const syntax::Code& code) {
    syntax::for_each_statement(code.block, [&](const syntax::Statement& statement) {
      found = found ||
              (statement.kind == syntax::Statement::Kind::run && statement.name.text == thread);
    });
  };
  for (const Callback& callback : node.callbacks) {
    for (const syntax::Code* const code : codes_of(callback)) look(*code);
  }
  for (const TreeNode& procedure : file.tree().entries("procedures")) look(*procedure.code);
  return found;
}

// A program for each copy of the node's own threads.
void add_own_threads(Declarations& file, std::uint32_t number) {
  using Kind = ModelUse::Kind;
  const NodeDeclaration node = file.nodes[number];
  const ExecutorDeclaration own = file.executors[node.executor];
  for (const Callback& thread : node.callbacks) {
    if (thread.kind != Callback::Kind::thread) continue;
    const std::string name = thread.whole_name();
    const std::uint32_t model = add_hidden_model(
        file, name + ".copies", make_copies(thread.copies, !is_run(file, node, thread.name)),
        file.tree().at_name(*own.entry));
    file.names.threads.emplace(name, model);
    for (std::uint32_t number_of_copy = 0; number_of_copy < thread.copies; ++number_of_copy) {
      Callback copy = thread;
      copy.run = number_of_copy;
      copy.asker += number_of_copy;
      copy.start.push_back({Kind::give, model, input_of_copy(CopyInput::begin, number_of_copy)});
      copy.end.push_back({Kind::give, model, input_of_copy(CopyInput::end, number_of_copy)});
      add_thread(file,
                 thread.copies == 1 ? name : name + "[" + std::to_string(number_of_copy) + "]", own,
                 {{}, {copy}, {}}, {number});
    }
  }
}

// The program that reads the node's clock.
void add_clock(Declarations& file, std::uint32_t number) {
  const NodeDeclaration& node = file.nodes[number];
  const TreeNode* const clock = node.entry->find("clock");
  if (clock == nullptr) return;
  const ExecutorDeclaration& executor = file.executors[node.executor];
  if (executor.goes_by_rounds) {
    file.tree().fail("a clock does not go with 'order: rounds' yet: that is not built", *clock);
  }
  ProgramDeclaration program;
  program.name = node.name + ".clock";
  program.process = process_of(*executor.entry, "executor " + executor.name);
  program.position = file.tree().at(*clock);
  program.code = std::make_shared<const syntax::Code>(
      make_clock_code(clock->reference->name, node.callbacks, program.position));
  file.nodes[number].clock = static_cast<std::uint32_t>(file.programs.size());
  file.programs.push_back(std::move(program));
}

std::vector<Callback> callbacks_of(const Declarations& file, const ExecutorDeclaration& executor,
                                   bool are_starts) {
  std::vector<Callback> all;
  for (const std::uint32_t node : executor.nodes) {
    for (const Callback& callback : file.nodes[node].callbacks) {
      if (are_starts ? callback.kind == Callback::Kind::start : is_of_executor(callback.kind)) {
        all.push_back(callback);
      }
    }
  }
  return all;
}

std::optional<Callback> main_of(const Declarations& file, const ExecutorDeclaration& executor) {
  for (const Callback& callback : file.nodes[executor.nodes.front()].callbacks) {
    if (callback.kind == Callback::Kind::main) return callback;
  }
  return std::nullopt;
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
    // When what he sends and answers arrives makes no difference.
    const bool is_anybodys = service.is_server_anybody || service.anybody == shape.is_late.size();
    shape.is_late.push_back(rule.delivery == Delivery::late && !file.is_at_rest && !is_anybodys);
    shape.loses = rule.wire.loses;
  }
  shape.is_in_stream = !wish.stream.empty();
  shape.anybody = service.anybody;
  shape.is_open = service.is_open;
  shape.is_server_anybody = service.is_server_anybody;
  shape.may_not_answer = service.may_not_answer;
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

// What may be at the ends of a service of which some may die.
void check_mortal(const Declarations& file, std::uint32_t model, const Service& service) {
  std::vector<End> ends = service.clients;
  ends.push_back(service.server);
  if (std::ranges::none_of(ends, [&](const End& end) { return may_die(file, end); })) return;
  constexpr std::size_t most_clients = 16;
  const auto fail = [&](const std::string& what) {
    throw ParseError(
        "an end of service " + service.name + " may die, and " + what + ": that is not built",
        file.models[model].position);
  };
  if (!service.callers.empty()) fail("its answers return when all clients have them");
  if (!file.deliveries.at(model).stream.empty()) fail("it says `stream`");
  if (service.clients.size() > most_clients) {
    fail("it has more than " + std::to_string(most_clients) + " clients");
  }
}

void shape_services(Declarations& file) {
  for (auto& [model, service] : file.names.services) {
    service.callers = callers_of(file, model, service);
    check_mortal(file, model, service);
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
    std::vector<Callback> starts = callbacks_of(file, executor, true);
    std::vector<Callback> callbacks = callbacks_of(file, executor, false);
    std::optional<Callback> main = main_of(file, executor);
    // Its nodes may have threads of their own alone.
    if (callbacks.empty() && starts.empty() && !main) continue;
    if (executor.threads == 1) {
      add_thread(file, executor.nodes.size() == 1 ? file.nodes[first].name : executor.name,
                 executor, {std::move(starts), std::move(callbacks), std::move(main)},
                 executor.nodes);
      continue;
    }
    const std::uint32_t threads =
        add_hidden_model(file, executor.name + ".threads", make_semaphore(executor.threads),
                         file.tree().at_name(*executor.entry));
    std::optional<std::uint32_t> gate;
    if (!starts.empty()) {
      gate = add_hidden_model(file, executor.name + ".started", make_gate(),
                              file.tree().at_name(*executor.entry));
      starts.back().end.push_back({ModelUse::Kind::give, *gate, gate_input_open});
      add_thread(file, executor.name + ".start", executor, {std::move(starts), {}, {}},
                 executor.nodes);
    }
    for (const std::uint32_t node : executor.nodes) {
      add_groups(file, executor, node, threads, gate);
    }
  }
  for (std::uint32_t node = 0; node < file.nodes.size(); ++node) {
    add_own_threads(file, node);
    add_clock(file, node);
  }
  declare_lives(file);
  shape_services(file);
}

}  // namespace maide
