#include "maide/join/system_variant.hpp"

#include <fmt/format.h>

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
#include "maide/check/build/declarations.hpp"
#include "maide/check/tree/edit.hpp"
#include "maide/check/tree/print.hpp"
#include "maide/check/tree/system_tree.hpp"
#include "maide/formats/model_file.hpp"

namespace maide {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t most_files = 50;

std::pair<int, int> in_order(TextPlace place) { return {place.line, place.column}; }

// Where the counts stand behind their keywords; fewer than repeats if some have no place of their
// own: they are worked out.
std::vector<std::pair<TextPlace, std::uint32_t>> places_of_counts(
    const SystemTree& tree, const std::vector<Repeat>& repeats) {
  std::vector<std::pair<TextPlace, std::uint32_t>> places;
  for_each_code(tree.root, [&](const syntax::Code& code) {
    syntax::for_each_statement(code.block, [&](const syntax::Statement& statement) {
      if (statement.kind != syntax::Statement::Kind::repeat) return;
      const syntax::Term& count = *statement.expression;
      if (count.kind != syntax::Term::Kind::number) return;
      for (const Repeat& repeat : repeats) {
        if (in_order({repeat.line, repeat.column}) == in_order(statement.place)) {
          places.emplace_back(count.place, repeat.count);
        }
      }
    });
  });
  return places;
}

// With the counts and constants of the variant; nothing if one of them is not where it should be.
std::optional<std::string> changed_text(const std::string& before, const std::string& file,
                                        const SystemVariant& variant) {
  MAIDE_CHECK(variant.repeats.empty() || variant.constants.empty());
  std::string text = variant.text.empty() ? before : variant.text;
  if (variant.repeats.empty() && variant.constants.empty()) return text;
  const SystemTree tree = read_tree(text, file);
  auto places = places_of_counts(tree, variant.repeats);
  if (places.size() != variant.repeats.size()) return std::nullopt;
  // From the end, so that places before stay right.
  std::ranges::sort(
      places, [](const auto& a, const auto& b) { return in_order(a.first) > in_order(b.first); });
  for (const auto& [place, count] : places) text = with_word(text, place, std::to_string(count));
  for (const NumberConstant& constant : variant.constants) {
    const YamlDocument now = read_yaml(text, file, "a system file");
    const YamlNode* const section = now.root.find("constants");
    const YamlNode* const value = section == nullptr ? nullptr : section->find(constant.name);
    if (value == nullptr) return std::nullopt;
    text = with_value(now, *value, std::to_string(constant.value));
  }
  return text;
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

const std::string& text_of(const System& system) {
  static const std::string none;
  const auto source = system.sources.find(system.file);
  return source == system.sources.end() ? none : source->second;
}

std::vector<NumberConstant> find_constants(const System& system) {
  std::vector<NumberConstant> constants;
  if (text_of(system).empty()) return constants;
  const YamlDocument document = read_yaml(text_of(system), system.file, "a system file");
  const YamlNode* const section = document.root.find("constants");
  if (section == nullptr) return constants;
  for (const YamlEntry& entry : section->entries) {
    const auto number = parse_number<std::int64_t>(entry.value.value);
    if (!number || entry.value.is_quoted()) continue;
    const TextPlace place = entry.value.place;
    constants.push_back({entry.key.value, place.line, place.column, *number});
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
  std::ranges::sort(repeats, [&](const Repeat& a, const Repeat& b) { return place(a) < place(b); });
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
  if (text_of(system).empty()) return std::nullopt;
  try {
    const std::optional<std::string> text = changed_text(text_of(system), system.file, variant);
    if (!text) return std::nullopt;
    std::map<std::string, Options> options;
    if (!variant.constants.empty()) options = options_of_instances(system, text_of(system));
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
    return parse_system(*text, system.file, asked, control, {}, variant.deliveries);
  } catch (const Error&) {
    return std::nullopt;
  }
}

namespace {

constexpr std::uint32_t most_threads = 4;

// Whether the field, a name or a list of names, names the node.
bool names(const YamlNode* field, const std::string& node) {
  if (field == nullptr) return false;
  if (field->is_scalar()) return array_of(field->value) == node;
  return std::ranges::any_of(field->entries, [&](const YamlEntry& entry) {
    return entry.value.is_scalar() && array_of(entry.value.value) == node;
  });
}

// Changes of one node, each made on a copy of the file.
class NodeChanger {
 public:
  NodeChanger(const System& system, const YamlDocument& document, std::string key)
      : system_(system), document_(document), key_(std::move(key)), name_(array_of(key_)) {}

  void list(std::vector<NodeChange>& changes) const {
    const std::vector<std::string> clients = clients_of(), callbacks = callbacks_of();
    const std::uint32_t now = threads();
    for (std::uint32_t threads = std::max(now, 2U); threads <= std::max(now, most_threads);
         ++threads) {
      for (const std::string& client : clients) {
        add(changes, threads, now,
            fmt::format("the client of {} in a callback group of its own", client),
            [&](YamlNode& node) {
              node.at("groups").set("own_" + client, YamlNode("exclusive"));
              set_client_group(node, client, "own_" + client);
            });
      }
      for (const std::string& callback : callbacks) {
        add(changes, threads, now,
            fmt::format("the callback {} in a callback group of its own", callback),
            [&](YamlNode& node) {
              node.at("groups").set("own_" + callback, YamlNode("exclusive"));
              node.at("callbacks").at(callback).set("group", YamlNode("own_" + callback));
            });
      }
      for (const auto& [group, members] : reentrant_groups()) {
        add(changes, threads, now,
            fmt::format("{} of the reentrant group {} in an exclusive one",
                        members.size() == 1 ? "the callback " + members.front()
                                            : "the callbacks " + join(members),
                        group),
            [&, &group = group, &members = members](YamlNode& node) {
              node.at("groups").set("not_" + group, YamlNode("exclusive"));
              for (const std::string& callback : members) {
                node.at("callbacks").at(callback).set("group", YamlNode("not_" + group));
              }
            });
      }
      if (threads > now) add(changes, threads, now, "", [](const YamlNode&) {});
    }
  }

 private:
  const YamlNode& node() const { return *document_.root.find("nodes")->find(key_); }

  std::vector<std::string> clients_of() const {
    std::vector<std::string> clients;
    const YamlNode* const services = document_.root.find("services");
    if (services == nullptr) return clients;
    for (const YamlEntry& service : services->entries) {
      if (names(service.value.find("clients"), name_)) {
        clients.push_back(array_of(service.key.value));
      }
    }
    return clients;
  }

  std::vector<std::string> callbacks_of() const {
    std::vector<std::string> callbacks;
    const YamlNode* const section = node().find("callbacks");
    if (section == nullptr || section->entries.size() < 2) return callbacks;
    for (const YamlEntry& callback : section->entries) callbacks.push_back(callback.key.value);
    return callbacks;
  }

  // Their callbacks, without groups that have none.
  std::map<std::string, std::vector<std::string>> reentrant_groups() const {
    std::map<std::string, std::vector<std::string>> members;
    const YamlNode* const groups = node().find("groups");
    const YamlNode* const callbacks = node().find("callbacks");
    if (groups == nullptr || callbacks == nullptr) return members;
    for (const YamlEntry& callback : callbacks->entries) {
      const YamlNode* const group = callback.value.find("group");
      const YamlNode* const kind = group == nullptr ? nullptr : groups->find(group->value);
      if (kind == nullptr || kind->value != "reentrant") continue;
      members[group->value].push_back(callback.key.value);
    }
    return members;
  }

  std::uint32_t threads() const {
    const YamlNode* const executor = node().find("executor");
    if (executor == nullptr) return 1;
    for (const ExecutorInstance& known : system_.executors) {
      if (known.name == executor->value) return known.threads;
    }
    return 1;
  }

  static void set_client_group(YamlNode& node, const std::string& client,
                               const std::string& group) {
    YamlNode& settings = node.at("clients").at(client);
    if (settings.is_map()) {
      settings.set("group", YamlNode(group));
    } else {
      settings = YamlNode(group);
    }
  }

  template <typename Change>
  void add(std::vector<NodeChange>& changes, std::uint32_t threads, std::uint32_t now,
           const std::string& what, const Change& change) const {
    YamlDocument changed = document_;
    YamlNode& node = *changed.root.find("nodes")->find(key_);
    change(node);
    std::string description = name_ + ":" + (what.empty() ? "" : " " + what);
    if (threads != now) {
      if (node.find("executor") == nullptr) node.set("executor", YamlNode("executor_of_" + name_));
      const std::string executor = node.find("executor")->value;
      YamlNode kind = YamlNode::make_map(YamlNode::Style::flow);
      kind.set("kind", YamlNode("multi"));
      kind.set("threads", YamlNode(std::to_string(threads)));
      changed.root.at("executors", YamlNode::Style::block).set(executor, std::move(kind));
      description += fmt::format("{} a MultiThreadedExecutor with {} threads",
                                 what.empty() ? "" : ", and", threads);
    }
    std::vector<std::string> lines;
    for (const YamlEntry& section : difference(changed.root, document_.root).entries) {
      lines.push_back(section.key.value + ": " + print_inline(changed, section.value));
    }
    changes.push_back({name_, print_system(changed), std::move(description), join(lines, ", ")});
  }

  const System& system_;
  const YamlDocument& document_;
  std::string key_, name_;
};

}  // namespace

std::vector<NodeChange> list_node_changes(const System& system) {
  std::vector<NodeChange> changes;
  if (text_of(system).empty()) return changes;
  const YamlDocument document = read_yaml(text_of(system), system.file, "a system file");
  const YamlNode* const nodes = document.root.find("nodes");
  if (nodes == nullptr) return changes;
  for (const YamlEntry& node : nodes->entries) {
    NodeChanger(system, document, node.key.value).list(changes);
  }
  return changes;
}

std::vector<DepthPlace> find_depths(const System& system) {
  std::vector<DepthPlace> places;
  if (text_of(system).empty()) return places;
  Declarations file = declare(read_tree(text_of(system), system.file));
  for (const std::string section : {"services", "topics", "models"}) {
    for (const TreeNode& entry : file.tree().entries(section)) {
      const TreeNode* const use = entry.find("use");
      const bool is_ours = section == "services" || (use != nullptr && use->is("queue"));
      const TreeNode* const with = entry.find("with");
      if (!is_ours || with == nullptr) continue;
      for (const std::string option : {"depth", "size"}) {
        const TreeNode* const depth = with->find(option);
        // A constant is changed itself (find_constants()).
        if (depth == nullptr || !depth->number || depth->number->is_name()) continue;
        try {
          const Expression value = constant_of(file, *depth->number);
          places.push_back({section, entry.name_text(), option, value.value});
        } catch (const ParseError&) {
          continue;  // it differs between the members of an array
        }
      }
    }
  }
  return places;
}

std::string with_depth(const std::string& text, const DepthPlace& place, std::int64_t value) {
  const YamlDocument document = read_yaml(text, "", "a system file");
  const YamlNode& entry = *document.root.find(place.section)->find(place.name);
  return with_value(document, *entry.find("with")->find(place.option), std::to_string(value));
}

}  // namespace maide
