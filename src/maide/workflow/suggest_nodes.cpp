#include "maide/workflow/suggest_nodes.hpp"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <utility>

#include "maide/base/numbers.hpp"

namespace maide {
namespace {

constexpr std::uint32_t most_threads = 4;

YAML::Node parsed(const std::string& text) {
  try {
    return YAML::Load(text);
  } catch (const YAML::Exception&) {
    return {};
  }
}

std::string written(const YAML::Node& root) {
  YAML::Emitter emitter;
  emitter << root;
  return emitter.c_str();
}

std::string base_of(const std::string& name) { return name.substr(0, name.find('[')); }

bool names(const YAML::Node& list, const std::string& node) {
  if (!list) return false;
  if (list.IsScalar()) return base_of(list.Scalar()) == node;
  for (const YAML::Node& one : list) {
    if (one.IsScalar() && base_of(one.Scalar()) == node) return true;
  }
  return false;
}

// Changes of one node, made on a copy of the file.
class NodeChanger {
 public:
  NodeChanger(const std::string& text, std::string key)
      : text_(text), key_(std::move(key)), name_(base_of(key_)) {}

  void list(std::vector<NodeChange>& changes) const {
    const YAML::Node root = parsed(text_);
    const std::vector<std::string> clients = clients_of(root), callbacks = callbacks_of(root);
    const std::uint32_t now = threads(root);
    for (std::uint32_t threads = std::max(now, 2U); threads <= most_threads; ++threads) {
      for (const std::string& client : clients) {
        add(changes, threads, now,
            fmt::format("the client of {} in a callback group of its own", client),
            [&](YAML::Node node) {
              node["groups"]["own_" + client] = "exclusive";
              set_client_group(node, client, "own_" + client);
            });
      }
      for (const std::string& callback : callbacks) {
        add(changes, threads, now,
            fmt::format("the callback {} in a callback group of its own", callback),
            [&](YAML::Node node) {
              node["groups"]["own_" + callback] = "exclusive";
              node["callbacks"][callback]["group"] = "own_" + callback;
            });
      }
      if (threads > now) add(changes, threads, now, "", [](const YAML::Node&) {});
    }
  }

 private:
  YAML::Node node_in(const YAML::Node& root) const { return root["nodes"][key_]; }

  std::vector<std::string> clients_of(const YAML::Node& root) const {
    std::vector<std::string> clients;
    for (const auto& service : root["services"]) {
      if (service.second.IsMap() && names(service.second["clients"], name_)) {
        clients.push_back(base_of(service.first.Scalar()));
      }
    }
    return clients;
  }

  std::vector<std::string> callbacks_of(const YAML::Node& root) const {
    std::vector<std::string> callbacks;
    const YAML::Node section = node_in(root)["callbacks"];
    if (!section || !section.IsMap() || section.size() < 2) return callbacks;
    for (const auto& callback : section) callbacks.push_back(callback.first.Scalar());
    return callbacks;
  }

  std::uint32_t threads(const YAML::Node& root) const {
    const YAML::Node executor = node_in(root)["executor"];
    if (!executor || !root["executors"]) return 1;
    const YAML::Node kind = root["executors"][executor.Scalar()];
    if (!kind || !kind["threads"]) return 1;
    return parse_number<std::uint32_t>(kind["threads"].Scalar()).value_or(1);
  }

  static void set_client_group(YAML::Node node, const std::string& client,
                               const std::string& group) {
    YAML::Node settings = node["clients"][client];
    if (settings.IsMap()) {
      settings["group"] = group;
    } else {
      node["clients"][client] = group;
    }
  }

  template <typename Change>
  void add(std::vector<NodeChange>& changes, std::uint32_t threads, std::uint32_t now,
           const std::string& what, const Change& change) const {
    YAML::Node root = parsed(text_);
    YAML::Node node = node_in(root);
    change(node);
    std::string description = name_ + ":" + (what.empty() ? "" : " " + what);
    if (threads != now) {
      if (!node["executor"]) node["executor"] = "executor_of_" + name_;
      const std::string executor = node["executor"].Scalar();
      YAML::Node kind;
      kind["kind"] = "multi";
      kind["threads"] = threads;
      root["executors"][executor] = kind;
      description += fmt::format("{} a MultiThreadedExecutor with {} threads",
                                 what.empty() ? "" : ", and", threads);
    }
    changes.push_back({name_, written(root), std::move(description)});
  }

  const std::string& text_;
  std::string key_, name_;
};

}  // namespace

std::vector<NodeChange> list_node_changes(const std::string& text) {
  std::vector<NodeChange> changes;
  const YAML::Node root = parsed(text);
  if (!root.IsMap() || !root["nodes"] || !root["nodes"].IsMap()) return changes;
  for (const auto& node : root["nodes"]) NodeChanger(text, node.first.Scalar()).list(changes);
  return changes;
}

std::vector<DepthPlace> find_depths(const std::string& text) {
  std::vector<DepthPlace> places;
  const YAML::Node root = parsed(text);
  if (!root.IsMap()) return places;
  for (const std::string section : {"services", "topics", "models"}) {
    if (!root[section] || !root[section].IsMap()) continue;
    for (const auto& entry : root[section]) {
      if (!entry.second.IsMap()) continue;
      const bool is_ours =
          section == "services" || (entry.second["use"] && entry.second["use"].Scalar() == "queue");
      const YAML::Node with = entry.second["with"];
      if (!is_ours || !with || !with.IsMap()) continue;
      for (const std::string option : {"depth", "size"}) {
        if (!with[option] || !with[option].IsScalar()) continue;
        const auto value = parse_number<std::int64_t>(with[option].Scalar());
        if (value) places.push_back({section, entry.first.Scalar(), option, *value});
      }
    }
  }
  return places;
}

std::string with_depth(const std::string& text, const DepthPlace& place, std::int64_t value) {
  YAML::Node root = parsed(text);
  root[place.section][place.name]["with"][place.option] = value;
  return written(root);
}

}  // namespace maide
