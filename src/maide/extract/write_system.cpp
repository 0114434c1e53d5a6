#include "maide/extract/write_system.hpp"

#include <algorithm>
#include <cctype>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "maide/check/text/yaml_node.hpp"
#include "maide/check/tree/print.hpp"

namespace maide::extract {
namespace {

YamlNode quoted(std::string text) {
  return YamlNode(std::move(text), YamlNode::Style::double_quoted);
}

std::string text_of(const Hole& hole) {
  std::string text = hole.text + " (" + to_string(hole.place) + ")";
  std::ranges::replace(text, '"', '\'');
  std::ranges::replace(text, '\\', '/');
  return text;
}

class SystemWriter {
 public:
  SystemWriter(const Model& model, const ExtractOptions& options, std::vector<Hole>& holes)
      : model_(model), options_(options), holes_(holes) {}

  std::string write() {
    name_nodes();
    collect();
    YamlDocument document;
    document.file = "what was extracted";
    document.root = YamlNode::make_map();
    YamlNode body = YamlNode::make_map();
    add_executors(body);
    add_topics(body);
    add_services(body);
    add_locks(body);
    add_nodes(body);
    add_holes(document.root);  // some were found on the way
    for (const char* section :
         {"constants", "models", "topics", "services", "executors", "nodes"}) {
      if (YamlNode* found = body.find(section)) document.root.set(section, std::move(*found));
    }
    if (model_.nodes.empty()) {
      document.root.at("programs", YamlNode::Style::block).set("nothing", quoted("skip;"));
    }
    return print_system(document);
  }

  std::set<std::string> constants;  // numbers of threads that nothing tells
  bool has_servers_outside = false;

 private:
  struct End {
    int entity = none;
    std::string node, callback;
  };
  struct Connection {
    std::string label;
    std::vector<End> in, out;  // of a topic: writers and readers; of a service: clients, servers
  };

  const Entity& entity(int index) const { return model_.entities[static_cast<std::size_t>(index)]; }
  void hole(std::string text, const Place& place) {
    holes_.push_back({std::move(text), place, false});
  }

  void name_nodes() {
    std::set<std::string> taken;
    for (const Entity& entity : model_.entities) taken.insert(entity.label);
    for (const Node& node : model_.nodes) {
      std::string label;
      for (const char c : node.name) {
        label += std::isalnum(static_cast<unsigned char>(c)) != 0 ? c : '_';
      }
      if (label.empty() || std::isdigit(static_cast<unsigned char>(label[0])) != 0 ||
          label == "anybody") {
        label = "n" + label;
      }
      while (!taken.insert(label).second) label += "_node";
      labels_.push_back(label);
    }
  }

  // Ends of one name are ends of one connection, whatever node made them.
  void collect() {
    for (std::size_t i = 0; i < model_.entities.size(); ++i) {
      const Entity& entity = model_.entities[i];
      if (entity.node == none || !entity.name.starts_with('/')) continue;
      const bool is_topic =
          entity.kind == Entity::Kind::publisher || entity.kind == Entity::Kind::subscription;
      Connection& connection = (is_topic ? topics_ : services_)[entity.name];
      connection.label = entity.label;
      const bool is_in =
          entity.kind == Entity::Kind::publisher || entity.kind == Entity::Kind::client;
      const int index = static_cast<int>(i);
      (is_in ? connection.in : connection.out)
          .push_back({index, labels_[static_cast<std::size_t>(entity.node)], callback_name(index)});
    }
  }

  std::string callback_name(int index) const {
    const Entity& of = entity(index);
    std::string name = "on_" + of.label;
    int same = 0;
    for (int i = 0; i < index; ++i) {
      const Entity& other = entity(i);
      const bool is_same =
          other.label == of.label && other.node == of.node && other.kind == of.kind;
      same += is_same ? 1 : 0;
    }
    if (of.kind == Entity::Kind::service) name = "serve_" + of.label;
    if (of.kind == Entity::Kind::timer) name = of.label + "_due";
    return same == 0 ? name : name + "_" + std::to_string(same + 1);
  }

  void add_holes(YamlNode& root) {
    YamlNode list;
    list.kind = YamlNode::Kind::list;
    list.style = YamlNode::Style::flow;
    std::map<std::string, std::vector<const Hole*>> kinds;
    for (const Hole& hole : holes_) {
      if (!hole.is_placed) kinds[hole.text].push_back(&hole);
    }
    std::size_t left = 0;
    for (const auto& [text, holes] : kinds) {
      if (options_.most_holes > 0 && list.entries.size() == options_.most_holes) {
        ++left;
        continue;
      }
      const std::string more =
          holes.size() == 1 ? "" : ", and " + std::to_string(holes.size() - 1) + " more";
      list.entries.emplace_back().value = quoted(text_of(*holes.front()) + more);
    }
    if (left > 0) {
      list.entries.emplace_back().value = quoted(std::to_string(left) + " other kinds of holes");
    }
    if (!list.entries.empty()) root.set("holes", std::move(list));
  }

  // ---- Topics ----

  // A node with several subscriptions to one topic has a queue for each of them.
  std::vector<std::string> readers_of(const Connection& topic) const {
    std::vector<std::string> readers;
    for (const End& end : topic.out) {
      const auto same = std::ranges::count_if(
          topic.out, [&](const End& other) { return other.node == end.node; });
      readers.push_back(same > 1 ? end.node + "." + end.callback : end.node);
    }
    return readers;
  }

  static std::vector<std::string> nodes_of(const std::vector<End>& ends) {
    std::vector<std::string> nodes;
    for (const End& end : ends) {
      if (std::ranges::find(nodes, end.node) == nodes.end()) nodes.push_back(end.node);
    }
    return nodes;
  }

  void add_topics(YamlNode& root) {
    for (const auto& [name, topic] : topics_) {
      YamlNode& entry = root.at("topics", YamlNode::Style::block).at(topic.label);
      std::vector<std::string> writers = nodes_of(topic.in), readers = readers_of(topic);
      const bool is_open = writers.empty() || readers.empty();
      if (!options_.is_closed || writers.empty()) writers.emplace_back("anybody");
      if (readers.empty()) readers.emplace_back("anybody");
      entry.set("writers", YamlNode::make_names(writers));
      entry.set("readers", YamlNode::make_names(readers));
      if (is_open) continue;  // no state is kept
      entry.set("use", YamlNode("queue"));
      set_quality(entry, name, topic);
    }
  }

  void set_quality(YamlNode& entry, const std::string& name, const Connection& topic) {
    const auto depth_of = [&](const End& end) {
      const std::string& depth = entity(end.entity).depth;
      return depth.empty() ? std::string("unknown") : depth;
    };
    const auto is_lossy = [&](const End& end) { return entity(end.entity).is_best_effort; };
    const Place& place = entity(topic.out[0].entity).place;
    const std::string depth = depth_of(topic.out[0]), kept = depth_of(topic.in[0]);
    const bool is_same =
        std::ranges::all_of(topic.in, [&](const End& end) { return depth_of(end) == kept; });
    if (!is_same || kept == "unknown") {
      hole("how many messages the writers of " + name + " keep", place);
    }
    if (std::ranges::any_of(topic.out, [&](const End& end) { return depth_of(end) != depth; })) {
      hole("readers of " + name + " that keep other numbers of messages", place);
    }
    const bool some_lose = std::ranges::any_of(topic.in, is_lossy);
    if (some_lose && !std::ranges::all_of(topic.out, is_lossy)) {
      hole("a reader of " + name + " that asks for more than a writer offers", place);
    }
    YamlNode& with = entry.at("with");
    with.set("depth", YamlNode(depth));
    if (is_same && kept != "unknown" && kept != depth) with.set("pub-depth", YamlNode(kept));
    if (some_lose || std::ranges::any_of(topic.out, is_lossy)) {
      entry.set("loses", YamlNode("true"));
    }
  }

  // ---- Services, locks, executors ----

  void add_services(YamlNode& root) {
    for (const auto& [name, service] : services_) {
      YamlNode& entry = root.at("services", YamlNode::Style::block).at(service.label);
      const bool has_server = !service.out.empty();
      if (service.out.size() > 1) {
        hole("two servers of " + name, entity(service.out[1].entity).place);
      }
      std::vector<std::string> clients = nodes_of(service.in);
      for (const End& end : service.in) {
        const auto same = std::ranges::count_if(
            service.in, [&](const End& other) { return other.node == end.node; });
        if (same > 1) hole("two clients of " + name + " in a node", entity(end.entity).place);
      }
      // With a server outside, requests of others are his own affair.
      if (has_server && (!options_.is_closed || clients.empty())) clients.emplace_back("anybody");
      entry.set("server", YamlNode(has_server ? service.out[0].node : "anybody"));
      entry.set("clients", YamlNode::make_names(clients));
    }
  }

  std::string executor_label(std::size_t node) const {
    const int executor = model_.nodes[node].executor;
    return executor == none ? "outside_" + labels_[node]
                            : model_.executors[static_cast<std::size_t>(executor)].label;
  }

  void set_threads(YamlNode& root, YamlNode& entry, const std::string& constant,
                   const std::string& usual) {
    entry.set("kind", YamlNode("multi"));
    entry.set("threads", quoted(constant));
    root.at("constants").set(constant, YamlNode(usual));
    constants.insert(constant);
  }

  void add_executors(YamlNode& root) {
    for (std::size_t i = 0; i < model_.nodes.size(); ++i) {
      YamlNode& entry = root.at("executors", YamlNode::Style::block).at(executor_label(i));
      if (!entry.entries.empty()) continue;
      if (model_.nodes[i].executor != none) {
        const Executor& executor =
            model_.executors[static_cast<std::size_t>(model_.nodes[i].executor)];
        if (!executor.is_multi) {
          entry.set("kind", YamlNode("single"));
        } else if (executor.threads.empty()) {  // as many as the machine has
          set_threads(root, entry, "cores", "2");
        } else {
          entry.set("kind", YamlNode("multi"));
          entry.set("threads", YamlNode(executor.threads));
        }
        if (executor.has_main && !executor.is_multi) entry.set("main", print(executor.main));
      } else if (options_.executor == "single") {
        entry.set("kind", YamlNode("single"));
      } else if (options_.executor.starts_with("multi:")) {
        entry.set("kind", YamlNode("multi"));
        entry.set("threads", YamlNode(options_.executor.substr(6)));
      } else {
        set_threads(root, entry, "threads", "1");
      }
    }
  }

  // What is in code that nobody reaches is left out, so locks are looked for in the text.
  void add_locks(YamlNode& root) {
    std::string all;
    for (const auto& [index, program] : model_.programs) all += print_code(program.code, {});
    for (const Node& node : model_.nodes) all += print_code(node.start.code, {});
    for (const Thread& thread : model_.threads) all += print_code(thread.program.code, {});
    for (const Executor& executor : model_.executors) all += print_code(executor.main.code, {});
    for (const Entity& entity : model_.entities) {
      const bool is_mutex = entity.kind == Entity::Kind::mutex;
      if (!is_mutex && entity.kind != Entity::Kind::condition) continue;
      if (all.find(entity.label + ".") == std::string::npos) continue;
      YamlNode& models = root.at("models", YamlNode::Style::block);
      YamlNode& entry = models.at(entity.label);
      entry.set("use", YamlNode(is_mutex ? "mutex" : "condition"));
      if (is_mutex && entity.is_reentrant) entry.at("with").set("recursive", YamlNode("true"));
      if (is_mutex) continue;
      std::string mutex = entity.label + "_mutex";
      if (entity.group_entity == none) {  // nobody waits
        models.at(mutex).set("use", YamlNode("mutex"));
      } else {
        mutex = this->entity(entity.group_entity).label;
      }
      models.at(entity.label).at("with").set("mutex", YamlNode(mutex));
    }
  }

  // ---- Nodes ----

  // That a service begins to be there is a step where somebody looks for it.
  YamlNode print(Program program, const std::string& behind = {}) const {
    for (const auto& named : services_) {
      const Connection& service = named.second;
      const bool is_looked_for = std::ranges::any_of(
          service.in, [&](const End& end) { return entity(end.entity).is_looked_for; });
      if (!is_looked_for) drop_step(program.code, "offer " + service.label + ";");
    }
    simplify(program.code);
    std::string text = print_code(program.code, program.variables);
    if (!behind.empty() && text == "skip;\n") text.clear();
    return YamlNode(text + behind, YamlNode::Style::literal);
  }

  // Servers outside are taken to be there when nodes begin, unless some code looks whether they
  // are.
  Program with_servers(const Node& node) {
    Program start = node.start;
    for (const auto& named : services_) {
      const Connection& service = named.second;
      const bool is_mine = std::ranges::any_of(
          service.in, [&](const End& end) { return entity(end.entity).node == node_index(node); });
      const bool is_looked_for = std::ranges::any_of(
          service.in, [&](const End& end) { return entity(end.entity).is_looked_for; });
      if (!service.out.empty() || !is_mine || is_looked_for) continue;
      has_servers_outside = true;
      Code wait;
      wait.text = "wait " + service.label + " -> there;";
      start.code.insert(start.code.begin(), std::move(wait));
    }
    return start;
  }

  int node_index(const Node& node) const { return static_cast<int>(&node - model_.nodes.data()); }

  void add_nodes(YamlNode& root) {
    for (std::size_t i = 0; i < model_.nodes.size(); ++i) {
      const Node& node = model_.nodes[i];
      YamlNode entry = YamlNode::make_map();
      entry.set("executor", YamlNode(executor_label(i)));
      YamlNode start = print(with_servers(node));
      if (start.value != "skip;\n") entry.set("start", std::move(start));
      std::string variables;
      YamlNode groups = YamlNode::make_map(YamlNode::Style::flow);
      YamlNode clients = YamlNode::make_map();
      YamlNode callbacks = YamlNode::make_map();
      YamlNode threads = YamlNode::make_map();
      for (const int index : node.entities) {
        add_entity(index, variables, groups, clients, callbacks, threads);
      }
      if (!groups.entries.empty()) entry.set("groups", std::move(groups));
      if (!variables.empty()) entry.set("variables", quoted(variables));
      if (!clients.entries.empty()) entry.set("clients", std::move(clients));
      if (!threads.entries.empty()) entry.set("threads", std::move(threads));
      if (callbacks.entries.empty()) {
        // A node that only writes and asks has nothing to run; the language wants one callback.
        YamlNode& idle = callbacks.at("nothing_to_run", YamlNode::Style::block);
        idle.set("timer", YamlNode("1000"));
        idle.set("when", quoted("false"));
        idle.set("do", quoted("skip;"));
      }
      entry.set("callbacks", std::move(callbacks));
      root.at("nodes", YamlNode::Style::block).set(labels_[i], std::move(entry));
    }
  }

  void add_client(int index, const Program& code, const std::string& group, YamlNode& clients) {
    const bool has_code = has_steps(code.code);
    if (!has_code && group.empty()) return;
    YamlNode& client = clients.at(entity(index).label, YamlNode::Style::block);
    if (!group.empty()) client.set("group", YamlNode(group));
    if (has_code) client.set("do", print(code));
  }

  void add_entity(int index, std::string& variables, YamlNode& groups, YamlNode& clients,
                  YamlNode& callbacks, YamlNode& threads) {
    const Entity& of = entity(index);
    const auto program = model_.programs.find(index);
    const Program code = program == model_.programs.end() ? Program{} : program->second;
    const std::string group = of.group_entity == none || of.kind == Entity::Kind::thread
                                  ? ""
                                  : entity(of.group_entity).label;
    switch (of.kind) {
      case Entity::Kind::group:
        groups.set(of.label, YamlNode(of.is_reentrant ? "reentrant" : "exclusive"));
        return;
      case Entity::Kind::client: return add_client(index, code, group, clients);
      case Entity::Kind::thread:
        threads.set(of.label,
                    print(model_.threads[static_cast<std::size_t>(of.group_entity)].program));
        return;
      case Entity::Kind::subscription:
      case Entity::Kind::service:
      case Entity::Kind::timer: break;
      default: return;
    }
    YamlNode& callback = callbacks.at(callback_name(index), YamlNode::Style::block);
    if (of.kind == Entity::Kind::subscription) callback.set("takes", YamlNode(of.label + ".read"));
    if (of.kind == Entity::Kind::service) callback.set("serves", YamlNode(of.label));
    if (of.kind == Entity::Kind::timer) {
      callback.set("timer", YamlNode(of.period.empty() ? "1000" : of.period));
      if (of.is_cancelled) {
        callback.set("when", quoted(of.label + "_on"));
        variables += "var " + of.label + "_on: bool = true; ";
      }
    }
    if (!group.empty()) callback.set("group", YamlNode(group));
    const bool answers = of.kind == Entity::Kind::service;
    callback.set("do", print(code, answers ? of.label + ".answer;\n" : ""));
  }

  const Model& model_;
  const ExtractOptions& options_;
  std::vector<Hole>& holes_;
  std::vector<std::string> labels_;
  std::map<std::string, Connection> topics_, services_;
};

}  // namespace

void write_system(const Model& model, const ExtractOptions& options, Extracted& result) {
  SystemWriter writer(model, options, result.holes);
  result.system = writer.write();
  if (writer.has_servers_outside) {
    result.notes.emplace_back("servers outside are there when nodes begin");
  }
  result.constants.assign(writer.constants.begin(), writer.constants.end());
  std::ranges::sort(result.holes);
  for (const Hole& hole : result.holes) {
    result.holes_file += "- " + std::string(hole.is_placed ? "placed: " : "unplaced: ") + "\"" +
                         text_of(hole) + "\"\n";
  }
}

}  // namespace maide::extract
