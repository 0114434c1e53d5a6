// Services, executors and nodes of a system file. The callbacks of a single-threaded executor are
// one program; so are those of an exclusive group on several threads; each run of a reentrant one
// is a program of its own.
#include <algorithm>
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "maide/base/text.hpp"
#include "maide/check/build/system_reader.hpp"
#include "maide/check/language/expression_parser.hpp"
#include "maide/check/rules/service_model.hpp"
#include "maide/check/text/tokens.hpp"

namespace maide {
namespace {

using program_syntax::Callback;

constexpr std::uint32_t max_threads = 8;  // a reentrant callback's runs have 2^threads states
constexpr std::uint32_t max_depth = 1000;

std::uint32_t number_of(const Expression& value, std::uint32_t most) {
  if (value.kind != ValueKind::integer || value.value < 1 || value.value > Value{most}) return 0;
  return static_cast<std::uint32_t>(value.value);
}

}  // namespace

// ---- names --------------------------------------------------------------------------------------

void SystemReader::declare_executors(const YAML::Node& section) {
  for (const auto& [key, value] : entries(section, "'executors'", {})) {
    Executor executor;
    executor.name = key.Scalar();
    check_plain_name(key, "an executor");
    executor.key.reset(key);
    take_name(executor.name, key);
    bool is_multi = false, has_kind = false;
    YAML::Node threads, order;
    for (const auto& [word, node] :
         entries(value, "executor '" + executor.name + "'", {"kind", "threads", "order"})) {
      if (word.Scalar() == "kind") {
        has_kind = true;
        is_multi = one_of<bool>(node, "'kind'", {{"single", false}, {"multi", true}});
      } else if (word.Scalar() == "threads") {
        threads.reset(node);
        scalar(node, "'threads'");
        executor.threads =
            number_of(program_syntax::parse_constant(text_of(node), context()), max_threads);
        if (executor.threads == 0) {
          fail("'threads' goes from 1 to " + std::to_string(max_threads), node);
        }
      } else {
        order.reset(node);
        executor.goes_by_rounds = one_of<bool>(node, "'order'", {{"any", false}, {"rounds", true}});
      }
    }
    if (!has_kind) {
      fail("executor '" + executor.name + "' needs 'kind: single' or 'kind: multi'", key);
    }
    if (is_multi && !threads.IsScalar()) {
      fail("executor '" + executor.name + "' needs 'threads:'", key);
    }
    if (!is_multi && threads.IsScalar()) fail("'threads' goes with 'kind: multi'", threads);
    if (is_multi && order.IsScalar()) fail("'order' goes with 'kind: single'", order);
    executor_names_.emplace(executor.name, static_cast<std::uint32_t>(executors_.size()));
    executors_.push_back(std::move(executor));
  }
}

void SystemReader::declare_nodes(const YAML::Node& section) {
  for (const auto& [key, value] : entries(section, "'nodes'", {})) {
    const program_syntax::Declared array = declared(key);
    if (array.name.find_first_of(".@:") != std::string::npos) {
      fail("a node's name has no '.', '@' and ':'", key);
    }
    entries(value, "node '" + array.name + "'",
            {"executor", "groups", "clients", "variables", "callbacks"});
    const std::uint64_t count = member_count(array.dimensions);
    if (nodes_.size() + count > max_components) fail("too many nodes", key);
    node_arrays_[array.name] = {
        static_cast<std::uint32_t>(nodes_.size()), array.dimensions, false, {}};
    for (std::uint64_t member = 0; member < count; ++member) {
      NodeOf node;
      node.name = array.name + member_suffix(array.dimensions, member);
      node.indices = indices_of(array, member);
      node.key.reset(key);
      node.value.reset(value);
      if (const YAML::Node executor = value["executor"]) {
        const std::string name = scalar(executor, "'executor'");
        const auto place = executor_names_.find(name);
        if (place == executor_names_.end()) {
          std::vector<std::string> known;
          for (const auto& [other, number] : executor_names_) known.push_back(other);
          fail("unknown executor '" + name + "'; there is: " + known_instead(name, known),
               executor);
        }
        node.executor = place->second;
      } else {
        Executor own;
        own.name = node.name;
        own.key.reset(key);
        node.executor = static_cast<std::uint32_t>(executors_.size());
        executors_.push_back(std::move(own));
      }
      executors_[node.executor].nodes.push_back(static_cast<std::uint32_t>(nodes_.size()));
      names_.nodes.insert(node.name);
      nodes_.push_back(std::move(node));
    }
  }
  if (nodes_.empty()) fail("there is no node", section);
}

void SystemReader::check_plain_name(const YAML::Node& key, const std::string& what) const {
  if (key.Scalar().empty() || key.Scalar().find_first_of(".@:[] ") != std::string::npos) {
    fail("the name of " + what + " is a word without '.', '@', ':' and '['", key);
  }
}

// ---- services -----------------------------------------------------------------------------------

void SystemReader::read_services(const YAML::Node& section) {
  for (const auto& [key, value] : entries(section, "'services'", {})) {
    const program_syntax::Declared array = declared(key);
    const std::uint64_t count = member_count(array.dimensions);
    if (system_.models.size() + count > max_components) fail("too many services", key);
    const ModelName name{
        static_cast<std::uint32_t>(system_.models.size()), array.dimensions, false, {}};
    names_.models.emplace(array.name, name);
    service_arrays_.emplace(array.name, name);
    for (std::uint64_t member = 0; member < count; ++member) {
      read_service(array.name + member_suffix(array.dimensions, member), indices_of(array, member),
                   key, value);
    }
  }
}

void SystemReader::read_service(const std::string& name, const Indices& indices,
                                const YAML::Node& key, const YAML::Node& value) {
  Service service;
  service.name = name;
  ModelInstance model;
  model.name = name;
  model.source = ModelInstance::Source::service;
  model.position = at(key);
  bool has_server = false;
  for (const auto& [word, node] :
       entries(value, "service '" + name + "'", {"server", "clients", "learn", "with"})) {
    if (word.Scalar() == "server") {
      const std::vector<End> ends = ends_named(node, indices);
      if (ends.size() != 1) fail("a service has one server", node);
      service.server = ends.front();
      has_server = true;
    } else if (word.Scalar() == "clients") {
      service.clients = ends_named(node, indices);
    } else if (word.Scalar() == "learn") {
      model.origin = one_of<std::string>(node, "'learn' of a service", {{"ros2", "ros2"}});
    } else {
      for (const auto& [option, setting] :
           entries(node, "'with' of a service, which is made by its rules,",
                   {"depth", "kind", "rmw"})) {
        scalar(setting, "'" + option.Scalar() + "'");
        if (option.Scalar() == "kind") {
          one_of<bool>(setting, "'kind'", {{"service", true}});
          continue;
        }
        if (option.Scalar() == "rmw") {
          service.takes_one_by_one =
              one_of<bool>(setting, "'rmw'", {{"cyclonedds", false}, {"fastrtps", true}});
          service.rmw = setting.Scalar();
          continue;
        }
        if (setting.Scalar() == unknown_depth) {
          service.is_depth_unknown = true;
          service.depth = 1;
          continue;
        }
        service.depth = number_of(
            program_syntax::parse_constant(text_of(setting), context(indices)), max_depth);
        if (service.depth == 0)
          fail("'depth' goes from 1 to " + std::to_string(max_depth), setting);
      }
    }
  }
  if (!has_server) fail("service '" + name + "' needs 'server:'", key);
  if (service.clients.empty()) fail("service '" + name + "' needs 'clients:'", key);
  const auto number = static_cast<std::uint32_t>(system_.models.size());
  std::vector<End> ends = service.clients;
  ends.push_back(service.server);
  for (const End& end : ends) {
    if (end.node.empty() && texts_[end.program].may_die) {
      fail("a program that may die is at no end of a service: that is not built", key);
    }
  }
  names_.services.emplace(number, std::move(service));
  system_.models.push_back(std::move(model));
}

std::vector<End> SystemReader::ends_named(const YAML::Node& node, const Indices& indices) {
  std::vector<End> ends;
  if (node.IsSequence()) {
    for (const YAML::Node& one : node) {
      for (End& end : ends_named(one, indices)) {
        for (const End& other : ends) {
          if (!other.is_of(end.node, end.program)) continue;
          fail((end.node.empty() ? texts_[end.program].name : end.node) + " is there twice", one);
        }
        ends.push_back(std::move(end));
      }
    }
    return ends;
  }
  const std::string text = scalar(node, "a program's or node's name");
  const auto array = node_arrays_.find(text.substr(0, text.find('[')));
  if (array == node_arrays_.end()) {
    for (const std::uint32_t program : programs_named(node, indices)) ends.push_back({program, ""});
    return ends;
  }
  for (const std::uint32_t member : members_named(node, array->second, indices)) {
    ends.push_back({0, nodes_[member].name});
  }
  return ends;
}

std::vector<std::uint32_t> SystemReader::services_named(const YAML::Node& node,
                                                        const Indices& indices) {
  const std::string name = node.Scalar().substr(0, node.Scalar().find('['));
  const auto array = service_arrays_.find(name);
  if (array == service_arrays_.end()) {
    std::vector<std::string> known;
    for (const auto& [other, services] : service_arrays_) known.push_back(other);
    fail("unknown service '" + name + "'" + did_you_mean(name, known), node);
  }
  return members_named(node, array->second, indices);
}

// ---- callbacks ----------------------------------------------------------------------------------

std::string SystemReader::group_named(const NodeOf& node, const YAML::Node& value) const {
  std::string group = scalar(value, "'group'");
  if (node.groups.contains(group)) return group;
  std::vector<std::string> known;
  for (const auto& [name, reentrant] : node.groups) known.push_back(name);
  fail("node " + node.name + " has no group '" + group + "'" +
           (known.empty() ? "; it has no groups" : "; it has: " + known_instead(group, known)),
       value);
}

void SystemReader::read_callbacks(NodeOf& node) {
  if (const YAML::Node groups = node.value["groups"]) {
    for (const auto& [key, value] : entries(groups, "'groups'", {})) {
      node.groups[key.Scalar()] =
          one_of<bool>(value, "a group", {{"exclusive", false}, {"reentrant", true}});
    }
  }
  if (const YAML::Node callbacks = node.value["callbacks"]) {
    for (const auto& [key, value] : entries(callbacks, "'callbacks'", {})) {
      read_callback(node, key, value);
    }
  }
  read_clients(node);
  check_server(node);
  if (node.callbacks.empty()) fail("node '" + node.name + "' has no callback", node.key);
}

void SystemReader::read_callback(NodeOf& node, const YAML::Node& key, const YAML::Node& value) {
  Callback callback;
  callback.node = node.name;
  callback.name = key.Scalar();
  check_plain_name(key, "a callback");
  callback.indices = node.indices;
  callback.position = at(key);
  std::string group, by;
  bool does = false;
  for (const auto& [word, part] : entries(value, "callback '" + callback.name + "'",
                                          {"takes", "timer", "serves", "group", "do"})) {
    const std::string& what = word.Scalar();
    if (what == "group") {
      group = group_named(node, part);
    } else if (what == "do") {
      does = true;
      if (part.IsMap()) {
        for (const auto& [output, code] : entries(part, "'do'", {})) {
          scalar(code, "what is done");
          callback.outcomes.emplace_back(text_of(output), text_of(code));
        }
        if (callback.outcomes.empty()) fail("'do' is empty", part);
      } else {
        scalar(part, "'do'");
        callback.code =
            part.Scalar() == unknown_code ? make_unknown(callback, word) : text_of(part);
      }
    } else {
      if (!by.empty()) fail("a callback has one of 'takes', 'timer' and 'serves'", word);
      by = what;
      scalar(part, "'" + what + "'");
      if (what == "takes") {
        callback.kind = Callback::Kind::subscription;
        callback.takes = text_of(part);
      } else if (what == "timer") {
        const Expression period =
            program_syntax::parse_constant(text_of(part), context(node.indices));
        if (period.kind != ValueKind::integer || period.value < 0) {
          fail("'timer' is some milliseconds", part);
        }
      } else {
        callback.kind = Callback::Kind::service;
        const auto members = services_named(part, node.indices);
        if (members.size() != 1) fail("a callback serves one service", part);
        callback.model = members.front();
        if (!names_.services.at(callback.model).is_server(node.name, 0)) {
          fail("node " + node.name + " is not the server of " + part.Scalar(), part);
        }
      }
    }
  }
  if (by == "takes") check_taken(callback);
  if (by.empty())
    fail("callback '" + callback.name + "' needs 'takes:', 'timer:' or 'serves:'", key);
  if (!does) fail("callback '" + callback.name + "' needs 'do:'", key);
  if (!callback.outcomes.empty() && by != "takes") fail("a map under 'do' goes with 'takes'", key);
  node.callbacks.push_back(std::move(callback));
  node.callback_groups.push_back(group);
}

ScalarText SystemReader::make_unknown(const Callback& callback, const YAML::Node& key) {
  ModelInstance model;
  model.name = "_unknown_" + std::to_string(system_.models.size());
  take_name(model.name, key);
  model.automaton = make_unknown_code(callback.whole_name());
  model.source = ModelInstance::Source::executor;
  model.position = at(key);
  names_.models.emplace(
      model.name, ModelName{static_cast<std::uint32_t>(system_.models.size()), {}, false, {}});
  ScalarText code = text_of(key).replaced_by(model.name + ".begin;");
  system_.models.push_back(std::move(model));
  return code;
}

void SystemReader::check_taken(const Callback& callback) const {
  const std::string& text = callback.takes.value();
  const std::size_t end = text.find_first_of("[.!");
  if (end != std::string::npos && end > 0) return;
  throw ParseError("'takes' names a model and its input or output, as in \"image.read\"",
                   callback.takes.position(0));
}

void SystemReader::read_clients(NodeOf& node) {
  struct Settings {
    std::string group;
    YAML::Node code;
  };
  std::map<std::uint32_t, Settings> settings;
  if (const YAML::Node clients = node.value["clients"]) {
    for (const auto& [key, value] : entries(clients, "'clients'", {})) {
      Settings own;
      if (value.IsMap()) {
        for (const auto& [word, part] : entries(value, "a client", {"group", "do"})) {
          if (word.Scalar() == "group") {
            own.group = group_named(node, part);
          } else {
            scalar(part, "'do'");
            own.code.reset(part);
          }
        }
      } else {
        own.group = group_named(node, value);
      }
      bool is_client = false;
      for (const std::uint32_t member : services_named(key, node.indices)) {
        if (!names_.services.at(member).client_of(node.name, 0)) continue;
        is_client = true;
        settings[member].group = own.group;
        settings[member].code.reset(own.code);
      }
      if (!is_client) fail("node " + node.name + " is no client of " + key.Scalar(), key);
    }
  }
  for (auto& [model, service] : names_.services) {
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
    callback.position = at(node.key);
    const auto own = settings.find(model);
    callback.has_code = own != settings.end() && own->second.code.IsScalar();
    if (callback.has_code) {
      callback.code = text_of(own->second.code);
      service.own_code.insert(node.name);
    }
    node.callbacks.push_back(std::move(callback));
    node.callback_groups.push_back(own == settings.end() ? "" : own->second.group);
  }
}

void SystemReader::check_server(const NodeOf& node) const {
  for (const auto& [model, service] : names_.services) {
    if (!service.is_server(node.name, 0)) continue;
    const auto serving = std::count_if(
        node.callbacks.begin(), node.callbacks.end(), [&, of = model](const Callback& callback) {
          return callback.kind == Callback::Kind::service && callback.model == of;
        });
    if (serving == 1) continue;
    fail("one callback of node '" + node.name + "' says `serves: " + service.name + "`" +
             (serving == 0 ? ", and none does" : ", and more do"),
         node.key);
  }
}

std::vector<std::string> SystemReader::takers_of(const NodeOf& node, const std::string& callback,
                                                 const std::string& topic) {
  std::vector<std::string> takers;
  const auto array = names_.models.find(topic.substr(0, topic.find('[')));
  for (const Callback& other : node.callbacks) {
    if (other.kind != Callback::Kind::subscription) continue;
    if (!callback.empty() && other.name != callback) continue;
    const std::string text = other.takes.value();
    const std::size_t end = text.find_first_of("[.! ");
    if (text.substr(0, end) != array->first) continue;
    if (!array->second.dimensions.empty()) {
      const std::vector<Value> place = program_syntax::parse_member_before(
          other.takes, context(node.indices), array->second.dimensions);
      std::string suffix;
      for (const Value index : place)
        suffix += (suffix.empty() ? "[" : ",") + std::to_string(index);
      if (topic != array->first + suffix + "]") continue;
    }
    takers.push_back(other.name);
  }
  return takers;
}

}  // namespace maide
