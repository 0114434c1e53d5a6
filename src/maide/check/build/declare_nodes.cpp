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

// The code of `do: unknown`: it asks a model that knows nothing.
std::shared_ptr<const syntax::Code> make_unknown(Declarations& file, const Callback& callback,
                                                 const TreeNode& field) {
  ModelInstance model;
  model.name = "_unknown_" + std::to_string(file.models.size());
  model.position = file.tree().at_name(field);
  file.take_name(model.name, model.position);
  model.automaton = make_unknown_code(callback.whole_name());
  model.source = ModelInstance::Source::executor;
  const auto number = static_cast<std::uint32_t>(file.models.size());
  file.names.models.emplace(model.name, ModelName{number, {}, false, {}});
  const TextPlace place{model.position.line, model.position.column};
  syntax::Code code;
  code.file = file.tree().file();
  code.begin = code.end = code.last = place;
  syntax::Statement& begin = code.block.statements.emplace_back();
  begin.kind = syntax::Statement::Kind::give;
  begin.place = place;
  begin.model.kind = syntax::Term::Kind::name;
  begin.model.name = {model.name, false, place};
  begin.model.place = begin.model.begin = place;
  begin.event.name = {"begin", false, place};
  file.models.push_back(std::move(model));
  file.origins.emplace_back();
  return std::make_shared<const syntax::Code>(std::move(code));
}

void read_do(Declarations& file, Callback& callback, const TreeNode& field) {
  if (field.code) {
    callback.code = field.code;
  } else if (field.yaml->is_scalar()) {
    callback.code = make_unknown(file, callback, field);
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

void read_callback(Declarations& file, NodeDeclaration& node, const TreeNode& entry) {
  Callback callback;
  callback.node = node.name;
  callback.name = entry.name_text();
  check_plain_name(file, entry, "a callback");
  callback.indices = node.indices;
  callback.position = file.tree().at_name(entry);
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
    } else {
      if (by != nullptr) {
        file.tree().fail_at_name("a callback has one of 'takes', 'timer' and 'serves'", field);
      }
      by = &field;
      if (what == "takes") {
        callback.kind = Callback::Kind::subscription;
        callback.takes = field.taken;
      } else if (what == "timer") {
        const Expression period = constant_of(file, *field.number, node.indices);
        if (period.kind != ValueKind::integer || period.value < 0) {
          file.tree().fail("'timer' is some milliseconds", field);
        }
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
    if (callback.code) service.own_code.insert(node.name);
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
    if (node.callbacks.empty()) {
      file.tree().fail_at_name("node '" + node.entry->declared->name.text + "' has no callback",
                               *node.entry);
    }
  }
}

}  // namespace maide
