#include "maide/join/system_variant.hpp"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>
#include <string_view>
#include <system_error>
#include <utility>
#include <variant>

#include "maide/base/error.hpp"
#include "maide/base/invariant.hpp"
#include "maide/base/numbers.hpp"
#include "maide/base/text.hpp"
#include "maide/check/text/yaml_reader.hpp"
#include "maide/formats/model_file.hpp"

namespace maide {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t most_files = 50;
constexpr std::string_view blanks = " \t\r\n";

// The offset of a place in the text; its size if there is none.
std::size_t offset_of(std::string_view text, int line, int column) {
  std::size_t at = 0;
  for (int skipped = 1; skipped < line; ++skipped) {
    const std::size_t end = text.find('\n', at);
    if (end == std::string_view::npos) return text.size();
    at = end + 1;
  }
  return std::min(text.size(), at + static_cast<std::size_t>(column - 1));
}

// Writes the number in the place of another; false if there is none.
bool write_number(std::string& text, std::size_t begin, std::int64_t number) {
  const std::size_t digits = begin < text.size() && text[begin] == '-' ? begin + 1 : begin;
  const std::size_t end = std::min(text.find_first_not_of("0123456789", digits), text.size());
  if (end <= digits) return false;
  text.replace(begin, end - begin, std::to_string(number));
  return true;
}

// Writes the count behind the keyword; false if it is not there.
bool write_count(std::string& text, const Repeat& repeat) {
  constexpr std::string_view keyword = "repeat";
  const std::size_t begin = offset_of(text, repeat.line, repeat.column);
  if (text.compare(begin, keyword.size(), keyword) != 0) return false;
  const std::size_t number = text.find_first_not_of(blanks, begin + keyword.size());
  return number != std::string::npos && write_number(text, number, repeat.count);
}

// The model that a request stands for in the system; of an array, any of its members. Null if the
// system was read without that request.
const InterfaceAutomaton* find_model(const System& system, const ModelRequest& request) {
  for (const ModelInstance& candidate : system.models) {
    if (candidate.name == request.instance || candidate.name.starts_with(request.instance + "[")) {
      return &candidate.read_automaton();
    }
  }
  return nullptr;
}

using Options = std::vector<std::pair<std::string, std::string>>;

// With which options each instance is learned, in the text as it was read.
std::map<std::string, Options> options_of_instances(const System& system, const std::string& text) {
  std::map<std::string, Options> result;
  parse_system(text, system.file, [&](const ModelRequest& request) {
    result[request.instance] = request.with;
    const InterfaceAutomaton* const model = find_model(system, request);
    MAIDE_CHECK(model != nullptr);
    return *model;
  });
  return result;
}

}  // namespace

std::vector<NumberConstant> find_constants(const System& system) {
  std::vector<NumberConstant> constants;
  const auto source = system.sources.find(system.file);
  if (source == system.sources.end()) return constants;
  const YamlReader reader(source->second, system.file);
  const YAML::Node section = reader.load()["constants"];
  if (!section) return constants;
  for (const auto& [key, value] : reader.entries(section, "'constants'", {})) {
    const auto number = parse_number<std::int64_t>(value.Scalar());
    if (!number || value.Tag() == "!") continue;  // it is in quotes
    const SourcePosition place = reader.at(value);
    constants.push_back({key.Scalar(), place.line, place.column, *number});
  }
  return constants;
}

std::vector<Repeat> find_repeats(const System& system) {
  std::vector<Repeat> repeats;
  for (const Program& program : system.programs) {
    if (program.position.file != system.file) continue;
    for (const Program::Round& round : program.rounds) {
      if (round.count > 0) repeats.push_back({round.line, round.column, round.count});
    }
  }
  const auto place = [](const Repeat& repeat) { return std::pair(repeat.line, repeat.column); };
  std::sort(repeats.begin(), repeats.end(),
            [&](const Repeat& a, const Repeat& b) { return place(a) < place(b); });
  repeats.erase(std::unique(repeats.begin(), repeats.end(),
                            [&](const Repeat& a, const Repeat& b) { return place(a) == place(b); }),
                repeats.end());
  return repeats;
}

bool has_model(const ModelInstance& instance) {
  using Source = ModelInstance::Source;
  return instance.source == Source::file || instance.source == Source::built_in;
}

std::map<std::string, InterfaceAutomaton> find_models_nearby(const System& system) {
  std::map<std::string, InterfaceAutomaton> models;
  const fs::path home = fs::path(system.file).parent_path();
  std::set<fs::path> folders;
  for (const ModelInstance& model : system.models) {
    if (!has_model(model)) continue;
    models.emplace(model.origin, model.read_automaton());
    if (fs::path(model.origin).has_extension()) {
      folders.insert(fs::path(model.origin).parent_path());
    }
  }
  for (const fs::path& folder : folders) {
    std::set<fs::path> files;
    std::error_code ignored;
    for (const auto& entry : fs::directory_iterator(home / folder, ignored)) {
      if (entry.path().extension() == ".dot") files.insert(entry.path());
    }
    for (const fs::path& file : files) {
      if (models.size() > most_files) break;
      try {
        Model model = read_model(file);
        auto* automaton = std::get_if<InterfaceAutomaton>(&model);
        if (automaton != nullptr) {
          models.emplace((folder / file.filename()).string(), std::move(*automaton));
        }
      } catch (const Error&) {
        continue;  // a picture, or another tool's file
      }
    }
  }
  return models;
}

std::optional<System> make_variant(const System& system, const SystemVariant& variant,
                                   const ModelSource& learn, const RunControl& control) {
  const auto source = system.sources.find(system.file);
  if (source == system.sources.end()) return std::nullopt;
  std::string text = variant.text.empty() ? source->second : variant.text;
  // From the end, so that places before stay right.
  const auto from_the_end = [](auto changes) {
    std::sort(changes.begin(), changes.end(), [](const auto& a, const auto& b) {
      return std::pair(a.line, a.column) > std::pair(b.line, b.column);
    });
    return changes;
  };
  MAIDE_CHECK(variant.repeats.empty() || variant.constants.empty());
  for (const Repeat& repeat : from_the_end(variant.repeats)) {
    if (!write_count(text, repeat)) return std::nullopt;
  }
  for (const NumberConstant& constant : from_the_end(variant.constants)) {
    const std::size_t begin = offset_of(text, constant.line, constant.column);
    if (!write_number(text, begin, constant.value)) return std::nullopt;
  }
  try {
    std::map<std::string, Options> options;
    if (!variant.constants.empty()) options = options_of_instances(system, source->second);
    const ModelSource asked = [&](const ModelRequest& request) {
      const auto changed = variant.models.find(request.instance);
      if (changed != variant.models.end()) return changed->second;
      const auto known = options.find(request.instance);
      const bool is_same =
          known == options.end() || known->second == request.with || request.learn.empty();
      const InterfaceAutomaton* const model = is_same ? find_model(system, request) : nullptr;
      if (model != nullptr) return *model;
      if (!learn) throw UsageError("there is no model for " + request.instance);
      return learn(request);
    };
    return parse_system(text, system.file, asked, control);
  } catch (const Error&) {
    return std::nullopt;
  }
}

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
    for (std::uint32_t threads = std::max(now, 2U); threads <= std::max(now, most_threads);
         ++threads) {
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
      for (const auto& [group, members] : reentrant_groups(root)) {
        add(changes, threads, now,
            fmt::format("{} of the reentrant group {} in an exclusive one",
                        members.size() == 1 ? "the callback " + members.front()
                                            : "the callbacks " + join(members),
                        group),
            [&, &group = group, &members = members](YAML::Node node) {
              node["groups"]["not_" + group] = "exclusive";
              for (const std::string& callback : members) {
                node["callbacks"][callback]["group"] = "not_" + group;
              }
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

  // Their callbacks, without groups that have none.
  std::map<std::string, std::vector<std::string>> reentrant_groups(const YAML::Node& root) const {
    std::map<std::string, std::vector<std::string>> members;
    const YAML::Node node = node_in(root);
    if (!node["groups"] || !node["callbacks"]) return members;
    for (const auto& callback : node["callbacks"]) {
      const YAML::Node group = callback.second["group"];
      if (!group || !node["groups"][group.Scalar()]) continue;
      if (node["groups"][group.Scalar()].Scalar() != "reentrant") continue;
      members[group.Scalar()].push_back(callback.first.Scalar());
    }
    return members;
  }

  std::uint32_t threads(const YAML::Node& root) const {
    const YAML::Node executor = node_in(root)["executor"];
    if (!executor || !root["executors"]) return 1;
    const YAML::Node kind = root["executors"][executor.Scalar()];
    if (!kind || !kind["threads"]) return 1;
    const std::string said = kind["threads"].Scalar();
    const YAML::Node constant = root["constants"] ? root["constants"][said] : YAML::Node();
    const std::string number = constant && constant.IsScalar() ? constant.Scalar() : said;
    return parse_number<std::uint32_t>(number).value_or(1);
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

  // On one line.
  static std::string flow(const YAML::Node& node) {
    YAML::Emitter emitter;
    emitter.SetMapFormat(YAML::Flow);
    emitter.SetSeqFormat(YAML::Flow);
    emitter << node;
    std::string text = emitter.c_str();
    std::replace(text.begin(), text.end(), '\n', ' ');
    return text;
  }

  // Those entries of the new map, and of maps in it, that the old one has not.
  static YAML::Node new_in(const YAML::Node& after, const YAML::Node& before) {
    YAML::Node result;
    for (const auto& entry : after) {
      const YAML::Node old = before && before.IsMap() ? before[entry.first.Scalar()]
                                                      : YAML::Node(YAML::NodeType::Undefined);
      if (!old || !old.IsDefined()) {
        result[entry.first.Scalar()] = entry.second;
      } else if (flow(old) != flow(entry.second)) {
        result[entry.first.Scalar()] =
            entry.second.IsMap() && old.IsMap() ? new_in(entry.second, old) : entry.second;
      }
    }
    return result;
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
    std::vector<std::string> lines;
    for (const auto& section : new_in(root, parsed(text_))) {
      lines.push_back(section.first.Scalar() + ": " + flow(section.second));
    }
    changes.push_back({name_, written(root), std::move(description), join(lines, ", ")});
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
