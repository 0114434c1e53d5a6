// Executors, nodes, their groups, callbacks and clients.
#include <algorithm>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "maide/base/text.hpp"
#include "maide/check/build/declarations.hpp"
#include "maide/check/build/references.hpp"
#include "maide/check/text/tokens.hpp"

namespace maide {
namespace {

using program_syntax::Callback;

constexpr std::uint32_t max_threads = 8;  // a reentrant callback's runs have 2^threads states

std::vector<std::string> names_in(const std::map<std::string, std::uint32_t>& names) {
  std::vector<std::string> known;
  for (const auto& [name, number] : names) known.push_back(name);
  return known;
}

}  // namespace

void declare_executors(Declarations& file) {
  for (const TreeNode& entry : file.tree().entries("executors")) {
    ExecutorDeclaration executor;
    executor.name = entry.name_text();
    check_plain_name(file, entry, "an executor");
    executor.entry = &entry;
    file.take_name(executor.name, file.tree().at_name(entry));
    const TreeNode* const kind = entry.find("kind");
    const TreeNode* const threads = entry.find("threads");
    const TreeNode* const order = entry.find("order");
    if (threads != nullptr) {
      executor.threads = count_of(constant_of(file, *threads->number), max_threads);
      if (executor.threads == 0) {
        file.tree().fail("'threads' goes from 1 to " + std::to_string(max_threads), *threads);
      }
    }
    executor.goes_by_rounds = order != nullptr && order->is("rounds");
    if (kind == nullptr) {
      file.tree().fail_at_name(
          "executor '" + executor.name + "' needs 'kind: single' or 'kind: multi'", entry);
    }
    const bool is_multi = kind->is("multi");
    if (is_multi && threads == nullptr) {
      file.tree().fail_at_name("executor '" + executor.name + "' needs 'threads:'", entry);
    }
    if (!is_multi && threads != nullptr) {
      file.tree().fail("'threads' goes with 'kind: multi'", *threads);
    }
    if (is_multi && order != nullptr) file.tree().fail("'order' goes with 'kind: single'", *order);
    file.executor_names.emplace(executor.name, static_cast<std::uint32_t>(file.executors.size()));
    file.executors.push_back(std::move(executor));
  }
}

namespace {

// The executor that the node names, or one of its own.
std::uint32_t executor_of(Declarations& file, const TreeNode& entry, const std::string& node) {
  if (const TreeNode* const executor = entry.find("executor")) {
    const std::string& name = executor->text();
    const auto place = file.executor_names.find(name);
    if (place != file.executor_names.end()) return place->second;
    file.tree().fail("unknown executor '" + name +
                         "'; there is: " + known_instead(name, names_in(file.executor_names)),
                     *executor);
  }
  ExecutorDeclaration own;
  own.name = node;
  own.entry = &entry;
  file.executors.push_back(std::move(own));
  return static_cast<std::uint32_t>(file.executors.size() - 1);
}

}  // namespace

void declare_nodes(Declarations& file) {
  const TreeNode* const section = file.tree().root.find("nodes");
  if (section == nullptr) return;
  for (const TreeNode& entry : section->children) {
    const DeclaredArray array = declare_array(file, entry);
    if (array.name.find_first_of(".@:") != std::string::npos) {
      file.tree().fail_at_name("a node's name has no '.', '@' and ':'", entry);
    }
    if (file.nodes.size() + array.count() > max_components) {
      file.tree().fail_at_name("too many nodes", entry);
    }
    file.node_arrays[array.name] = {
        static_cast<std::uint32_t>(file.nodes.size()), array.dimensions, false, {}};
    for (std::uint64_t member = 0; member < array.count(); ++member) {
      NodeDeclaration node;
      node.name = array.member(member);
      node.indices = array.indices_of(member);
      node.entry = &entry;
      node.executor = executor_of(file, entry, node.name);
      file.executors[node.executor].nodes.push_back(static_cast<std::uint32_t>(file.nodes.size()));
      file.names.nodes.insert(node.name);
      file.nodes.push_back(std::move(node));
    }
  }
  if (file.nodes.empty()) file.tree().fail("there is no node", *section);
}

// ---- Callbacks ----------------------------------------------------------------------------------

namespace {

std::string group_named(const Declarations& file, const NodeDeclaration& node,
                        const TreeNode& field) {
  const std::string& group = field.text();
  if (node.groups.contains(group)) return group;
  std::vector<std::string> known;
  for (const auto& [name, reentrant] : node.groups) known.push_back(name);
  file.tree().fail(
      "node " + node.name + " has no group '" + group + "'" +
          (known.empty() ? "; it has no groups" : "; it has: " + known_instead(group, known)),
      field);
}

// The code of `do: unknown`.
std::shared_ptr<const syntax::Code> make_unknown(Declarations& file, const TreeNode& field) {
  const SourcePosition position = file.tree().at_name(field);
  const TextPlace place{position.line, position.column};
  syntax::Code code;
  code.file = file.tree().file();
  code.begin = code.end = code.last = place;
  syntax::Statement& unknown = code.block.statements.emplace_back();
  unknown.kind = syntax::Statement::Kind::unknown;
  unknown.place = place;
  return std::make_shared<const syntax::Code>(std::move(code));
}

void read_do(Declarations& file, Callback& callback, const TreeNode& field) {
  if (field.code) {
    callback.code = field.code;
  } else if (field.yaml->is_scalar()) {
    callback.code = make_unknown(file, field);
  } else {
    for (const TreeNode& outcome : field.children) {
      callback.outcomes.emplace_back(outcome.output, outcome.code);
    }
    if (callback.outcomes.empty()) file.tree().fail("'do' is empty", field);
  }
}

void read_service(Declarations& file, const NodeDeclaration& node, Callback& callback,
                  const TreeNode& field) {
  callback.kind = Callback::Kind::service;
  const auto members = References(file, node.indices).services(field);
  if (members.size() != 1) file.tree().fail("a callback serves one service", field);
  callback.model = members.front();
  if (file.names.services.at(callback.model).is_server(node.name, 0)) return;
  file.tree().fail("node " + node.name + " is not the server of " + field.text(), field);
}

Callback make_callback(const Declarations& file, const NodeDeclaration& node, Callback::Kind kind,
                       const TreeNode& entry) {
  Callback callback;
  callback.kind = kind;
  callback.node = node.name;
  callback.name = entry.name_text();
  callback.indices = node.indices;
  callback.position = file.tree().at_name(entry);
  return callback;
}

void read_timer(Declarations& file, const NodeDeclaration& node, Callback& callback,
                const TreeNode& field) {
  const Expression period = constant_of(file, field.timer->period, node.indices);
  if (period.kind != ValueKind::integer || period.value < 0) {
    file.tree().fail("'timer' is some milliseconds", field);
  }
  callback.comes_once = field.timer->comes_once;
  callback.goes_by_clock = node.entry->find("clock") != nullptr;
}

void read_callback(Declarations& file, NodeDeclaration& node, const TreeNode& entry) {
  Callback callback = make_callback(file, node, Callback::Kind::timer, entry);
  check_plain_name(file, entry, "a callback");
  std::string group;
  const TreeNode* by = nullptr;
  const TreeNode* done = nullptr;
  for (const TreeNode& field : entry.children) {
    const std::string& what = field.name_text();
    if (what == "group") {
      group = group_named(file, node, field);
    } else if (what == "do") {
      done = &field;
      read_do(file, callback, field);
    } else if (what == "when") {
      callback.when = field.number;
    } else {
      if (by != nullptr) {
        file.tree().fail_at_name("a callback has one of 'takes', 'timer' and 'serves'", field);
      }
      by = &field;
      if (what == "takes") {
        callback.kind = Callback::Kind::subscription;
        callback.takes = field.taken;
      } else if (what == "timer") {
        read_timer(file, node, callback, field);
      } else {
        read_service(file, node, callback, field);
      }
    }
  }
  const std::string name = "callback '" + callback.name + "'";
  if (by == nullptr) {
    file.tree().fail_at_name(name + " needs 'takes:', 'timer:' or 'serves:'", entry);
  }
  if (done == nullptr) file.tree().fail_at_name(name + " needs 'do:'", entry);
  if (!callback.outcomes.empty() && callback.kind != Callback::Kind::subscription) {
    file.tree().fail_at_name("a map under 'do' goes with 'takes'", entry);
  }
  node.callbacks.push_back(std::move(callback));
  node.callback_groups.push_back(group);
}

// ---- Start and threads --------------------------------------------------------------------------

constexpr std::uint32_t max_copies = 4;  // of a thread: these have 3^n states

// A callback has no such name.
void check_own_name(const Declarations& file, const NodeDeclaration& node, const TreeNode& entry) {
  for (const Callback& other : node.callbacks) {
    if (other.name != entry.name_text()) continue;
    file.tree().fail_at_name(
        "node " + node.name + " has a callback '" + other.name + "', too: call it otherwise",
        entry);
  }
}

void read_start(Declarations& file, NodeDeclaration& node, const TreeNode& field) {
  check_own_name(file, node, field);
  Callback start = make_callback(file, node, Callback::Kind::start, field);
  start.code = field.code;
  node.callbacks.push_back(std::move(start));
  node.callback_groups.emplace_back();
}

// What spins the executor is code of its first node.
void read_main(Declarations& file, const ExecutorDeclaration& executor) {
  const TreeNode* const main =
      executor.entry->key->path == "executors/*" ? executor.entry->find("main") : nullptr;
  if (main == nullptr) return;
  if (executor.nodes.empty()) file.tree().fail("an executor with 'main' runs a node", *main);
  if (executor.threads > 1) {
    file.tree().fail("'main' goes with one thread yet: for several it is not built", *main);
  }
  NodeDeclaration& node = file.nodes[executor.nodes.front()];
  check_own_name(file, node, *main);
  Callback code = make_callback(file, node, Callback::Kind::main, *main);
  code.code = main->code;
  node.callbacks.push_back(std::move(code));
  node.callback_groups.emplace_back();
}

void read_thread(Declarations& file, NodeDeclaration& node, const TreeNode& entry) {
  Callback thread = make_callback(file, node, Callback::Kind::thread, entry);
  check_plain_name(file, entry, "a thread");
  check_own_name(file, node, entry);
  const TreeNode* const code = entry.is_map() ? entry.find("do") : &entry;
  if (code == nullptr) {
    file.tree().fail_at_name("thread '" + thread.name + "' needs 'do:'", entry);
  }
  thread.code = code->code;
  if (const TreeNode* const count = entry.is_map() ? entry.find("count") : nullptr) {
    thread.copies = count_of(constant_of(file, *count->number, node.indices), max_copies);
    if (thread.copies == 0) {
      file.tree().fail("'count' goes from 1 to " + std::to_string(max_copies), *count);
    }
  }
  node.callbacks.push_back(std::move(thread));
  node.callback_groups.emplace_back();
}

// ---- Clients ------------------------------------------------------------------------------------

struct ClientSettings {
  std::string group;
  std::shared_ptr<const syntax::Code> code;
};

// What the node says of its clients, by service.
std::map<std::uint32_t, ClientSettings> client_settings(Declarations& file,
                                                        const NodeDeclaration& node) {
  std::map<std::uint32_t, ClientSettings> settings;
  const TreeNode* const clients = node.entry->find("clients");
  if (clients == nullptr) return settings;
  for (const TreeNode& entry : clients->children) {
    ClientSettings own;
    if (entry.is_map()) {
      if (const TreeNode* const group = entry.find("group")) {
        own.group = group_named(file, node, *group);
      }
      if (const TreeNode* const code = entry.find("do")) own.code = code->code;
    } else {
      own.group = group_named(file, node, entry);
    }
    bool is_client = false;
    TreeNode named = entry;  // what stands before the colon is meant
    named.reference = nullptr;
    for (const std::uint32_t member : References(file, node.indices).services(named)) {
      if (!file.names.services.at(member).client_of(node.name, 0)) continue;
      is_client = true;
      settings[member] = own;
    }
    if (!is_client) {
      file.tree().fail_at_name("node " + node.name + " is no client of " + entry.name_text(),
                               entry);
    }
  }
  return settings;
}

// Some code of the node, or what spins its executor, waits for an answer of that service.
bool waits_for_answer(const Declarations& file, const NodeDeclaration& node,
                      const std::string& service) {
  const std::string array = array_of(service);
  bool waits = false;
  const auto visit = [&](const syntax::Code& code) {
    syntax::for_each_statement(code.block, [&](const syntax::Statement& statement) {
      const bool awaits = statement.kind == syntax::Statement::Kind::wait ||
                          statement.spin == syntax::Statement::Spin::until;
      waits = waits || (awaits && statement.model.name.text == array &&
                        statement.arms.front().output.name.is("answer"));
      for (const syntax::SelectArm& arm : statement.select_arms) {
        waits = waits || (arm.kind == syntax::SelectArm::Kind::output &&
                          arm.model.name.text == array && arm.event.name.is("answer"));
      }
    });
  };
  for_each_code(*node.entry, visit);
  for_each_code(*file.executors[node.executor].entry, visit);
  for (const TreeNode& procedure : file.tree().entries("procedures")) visit(*procedure.code);
  return waits;
}

// A callback of its own for each service that has the node as a client.
void read_clients(Declarations& file, NodeDeclaration& node) {
  const auto settings = client_settings(file, node);
  for (auto& [model, service] : file.names.services) {
    if (!service.client_of(node.name, 0)) continue;
    for (const Callback& other : node.callbacks) {
      if (other.name != service.name) continue;
      throw ParseError("the callback of the node's client is called '" + service.name + "', too",
                       other.position);
    }
    Callback callback;
    callback.kind = Callback::Kind::client;
    callback.node = node.name;
    callback.name = service.name;
    callback.indices = node.indices;
    callback.model = model;
    callback.position = file.tree().at_name(*node.entry);
    const auto own = settings.find(model);
    if (own != settings.end()) callback.code = own->second.code;
    const bool is_waited_for = waits_for_answer(file, node, service.name);
    if (callback.code && !is_waited_for) service.own_code.insert(node.name);
    node.callbacks.push_back(std::move(callback));
    node.callback_groups.push_back(own == settings.end() ? "" : own->second.group);
  }
}

void check_server(const Declarations& file, const NodeDeclaration& node) {
  for (const auto& [model, service] : file.names.services) {
    if (!service.is_server(node.name, 0)) continue;
    const auto serving = std::count_if(
        node.callbacks.begin(), node.callbacks.end(), [&, of = model](const Callback& callback) {
          return callback.kind == Callback::Kind::service && callback.model == of;
        });
    if (serving == 1) continue;
    file.tree().fail_at_name("one callback of node '" + node.name +
                                 "' says `serves: " + service.name + "`" +
                                 (serving == 0 ? ", and none does" : ", and more do"),
                             *node.entry);
  }
}

}  // namespace

void declare_callbacks(Declarations& file) {
  for (NodeDeclaration& node : file.nodes) {
    if (const TreeNode* const groups = node.entry->find("groups")) {
      for (const TreeNode& group : groups->children) {
        node.groups[group.name_text()] = group.is("reentrant");
      }
    }
    if (const TreeNode* const callbacks = node.entry->find("callbacks")) {
      for (const TreeNode& entry : callbacks->children) read_callback(file, node, entry);
    }
    read_clients(file, node);
    check_server(file, node);
    if (const TreeNode* const start = node.entry->find("start")) read_start(file, node, *start);
    if (const TreeNode* const threads = node.entry->find("threads")) {
      for (const TreeNode& entry : threads->children) read_thread(file, node, entry);
    }
  }
  for (const ExecutorDeclaration& executor : file.executors) read_main(file, executor);
  for (const NodeDeclaration& node : file.nodes) {
    if (!node.callbacks.empty()) continue;
    file.tree().fail_at_name("node '" + node.entry->declared->name.text + "' has no callback",
                             *node.entry);
  }
}

}  // namespace maide
