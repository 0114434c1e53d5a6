#include "maide/extract/end_maker.hpp"

#include <algorithm>
#include <map>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "maide/extract/object_maker.hpp"
#include "maide/extract/type_names.hpp"

namespace maide::extract {
namespace {

struct EndWord {
  Entity::Kind kind;
  std::string type;
};

const std::map<std::string, EndWord>& end_words() {
  static const std::map<std::string, EndWord> words{
      {"publisher", {Entity::Kind::publisher, "rclcpp::Publisher"}},
      {"subscription", {Entity::Kind::subscription, "rclcpp::Subscription"}},
      {"service", {Entity::Kind::service, "rclcpp::Service"}},
      {"client", {Entity::Kind::client, "rclcpp::Client"}},
      {"timer", {Entity::Kind::timer, "rclcpp::TimerBase"}},
      {"group", {Entity::Kind::group, "rclcpp::CallbackGroup"}}};
  return words;
}

// Types as they are written: one may be without its package.
bool is_same_message(const std::string& one, const std::string& other) {
  const bool is_whole =
      one.find("::") != std::string::npos && other.find("::") != std::string::npos;
  return one.empty() || other.empty() || one == other ||
         (!is_whole && last_part(one) == last_part(other));
}

bool is_topic(Entity::Kind kind) {
  return kind == Entity::Kind::publisher || kind == Entity::Kind::subscription;
}

}  // namespace

bool EndMaker::knows(const std::string& word) { return end_words().contains(word); }

EndMaker::Given EndMaker::at(const Expression& call, const std::vector<Value>& arguments,
                             std::size_t place) {
  if (place >= arguments.size()) return {};
  return {&call.operands[place + 1], arguments[place]};
}

Value EndMaker::make(const std::string& word, const Expression& call, const Value& self,
                     const std::vector<Value>& arguments) {
  Entity entity;
  entity.kind = end_words().at(word).kind;
  entity.node = walk_.node_of(self);
  entity.place = call.place;
  const bool is_other_node = writer_.node() != none && writer_.node() != entity.node;
  // A client may be made where it is used: nothing comes for it before it has asked.
  const bool is_local_client = word == "client" && writer_.phase() == Phase::callback;
  const bool is_spun = writer_.node() == none && walk_.main_executor != none;
  const bool is_late = writer_.phase() != Phase::start || writer_.is_conditional() || is_spun;
  if ((is_late && !is_local_client) || entity.node == none || is_other_node) {
    writer_.hole(call.place, "a " + word + " that is made later, or under a condition", true);
    return unknown_value();
  }
  const bool has_name = word != "timer" && word != "group";
  if (has_name && (arguments.empty() || arguments[0].kind != Value::Kind::text)) {
    writer_.hole(call.place, "the name of a " + word + " is no constant", true);
    return unknown_value();
  }
  if (has_name && arguments[0].text.find('{') != std::string::npos) {
    writer_.hole(call.place, "a name that is filled in", true);
  }
  entity.name = has_name ? resolve(arguments[0].text, entity.node) : word;
  if (is_local_client) {
    if (const int known = find_made_here(entity); known != none) return known_client(known);
  }
  entity.type = call.operands[0].type;
  read_arguments(entity, word, call, arguments);
  entity.label = label_for(entity, word);
  if (word == "service") writer_.emit("offer " + entity.label + ";", call.place);
  return walk_.objects->make_entity(std::move(entity), end_words().at(word).type);
}

Value EndMaker::make_publisher(const std::string& what, const std::string& of_class,
                               const std::vector<Value>& arguments, const Place& place) {
  std::istringstream words(what);
  Entity entity;
  std::string kept;
  words >> entity.name >> entity.depth >> kept;
  for (const Value& argument : arguments) {
    if (walk_.node_of(argument) != none) entity.node = walk_.node_of(argument);
  }
  entity.place = place;
  const bool is_late = writer_.phase() != Phase::start || writer_.is_conditional();
  if (is_late || entity.node == none) {
    writer_.hole(place, "a publisher that is made later, or under a condition", true);
    return unknown_value();
  }
  if (!kept.empty()) {
    writer_.hole(place, "what was sent before somebody came is kept for him", false);
  }
  entity.label = label_for(entity, "publisher");
  return walk_.objects->make_entity(std::move(entity), of_class);
}

// Of an earlier walk through the same call.
int EndMaker::find_made_here(const Entity& entity) const {
  for (std::size_t i = 0; i < walk_.model.entities.size(); ++i) {
    const Entity& other = walk_.model.entities[i];
    const bool is_same = other.kind == entity.kind && other.node == entity.node &&
                         other.place == entity.place && other.name == entity.name;
    if (is_same) return static_cast<int>(i);
  }
  return none;
}

Value EndMaker::known_client(int index) const {
  Value value;
  value.kind = Value::Kind::entity;
  value.type = "rclcpp::Client";
  value.index = index;
  return value;
}

void EndMaker::read_arguments(Entity& entity, const std::string& word, const Expression& call,
                              const std::vector<Value>& arguments) {
  if (word == "publisher") {
    set_quality(entity, at(call, arguments, 1));
    set_options(entity, at(call, arguments, 2));
    refuse_more(call, arguments, 3);
  } else if (word == "subscription") {
    set_quality(entity, at(call, arguments, 1));
    set_callback(entity, at(call, arguments, 2));
    set_options(entity, at(call, arguments, 3));
    refuse_more(call, arguments, 4);
  } else if (word == "service") {
    set_callback(entity, at(call, arguments, 1));
    set_quality(entity, at(call, arguments, 2));
    set_group(entity, at(call, arguments, 3));
    refuse_more(call, arguments, 4);
  } else if (word == "client") {
    set_quality(entity, at(call, arguments, 1));
    set_group(entity, at(call, arguments, 2));
    refuse_more(call, arguments, 3);
  } else if (word == "timer") {
    if (!arguments.empty()) entity.period = milliseconds_of(arguments[0].text);
    set_callback(entity, at(call, arguments, 1));
    set_group(entity, at(call, arguments, 2));
    refuse_more(call, arguments, 3);
  } else {
    set_kind_of_group(entity, call, arguments);
  }
}

void EndMaker::refuse_more(const Expression& call, const std::vector<Value>& arguments,
                           std::size_t most) {
  if (arguments.size() > most) writer_.hole(call.place, "arguments that are not followed", true);
}

// A number, or a quality of service. A depth that is not known stays open: the language has that.
void EndMaker::set_quality(Entity& entity, const Given& quality) {
  const bool is_service = !is_topic(entity.kind);
  if (quality.expression == nullptr) {
    if (!is_service) writer_.hole(entity.place, "an end without a quality of service", false);
    entity.depth = "10";
    return;
  }
  const Value& value = quality.value;
  if (value.kind == Value::Kind::qos) {
    entity.depth = value.text;
    entity.is_best_effort = value.is_best_effort;
    entity.is_transient = value.is_transient;
    const bool is_odd = is_service && (value.text != "10" || value.is_best_effort);
    if (is_odd) writer_.hole(entity.place, "a service of another quality", false);
  } else if (value.kind == Value::Kind::number && is_decimal(value.text)) {
    entity.depth = value.text;
  } else if (is_service &&
             last_part(quality.expression->text) == "rmw_qos_profile_services_default") {
    entity.depth = "10";
  } else if (is_plain_type(value.type) && !value.type.empty()) {
    entity.depth.clear();
  } else {
    writer_.hole(entity.place, "a quality of service that is not known", false);
  }
  if (entity.depth == "0") writer_.hole(entity.place, "a depth of 0", false);
  if (entity.is_transient) {
    writer_.hole(entity.place, "what was sent before somebody came is kept for him", false);
  }
}

void EndMaker::set_callback(Entity& entity, const Given& callback) {
  if (callback.value.kind == Value::Kind::callable) {
    entity.callbacks.push_back(callback.value);
  } else {
    writer_.hole(entity.place, "a callback that is not known", true);
  }
}

void EndMaker::set_group(Entity& entity, const Given& group) {
  if (group.expression == nullptr || group.value.kind == Value::Kind::null) return;
  const bool is_group = group.value.kind == Value::Kind::entity &&
                        walk_.entity(group.value.index).kind == Entity::Kind::group;
  if (is_group && walk_.entity(group.value.index).node == entity.node) {
    entity.group_entity = group.value.index;
  } else {
    writer_.hole(entity.place, "a group that is not known", true);
  }
}

void EndMaker::set_options(Entity& entity, const Given& options) {
  if (options.expression == nullptr) return;
  if (options.value.kind != Value::Kind::object || !options.value.type.ends_with("Options")) {
    writer_.hole(entity.place, "options that are not known", true);
    return;
  }
  for (const auto& [name, value] : walk_.object(options.value.index).fields) {
    const Value now = walk_.values.read_field(options.value.index, name, none);
    if (name == "callback_group" && entity.kind == Entity::Kind::subscription) {
      set_group(entity, {options.expression, now});
    } else {
      writer_.hole(entity.place, "the option " + name, true);
    }
  }
}

void EndMaker::set_kind_of_group(Entity& entity, const Expression& call,
                                 const std::vector<Value>& arguments) {
  const std::string kind = call.operands.size() > 1 ? last_part(call.operands[1].text) : "";
  entity.is_reentrant = kind == "Reentrant";
  const bool is_known = kind == "Reentrant" || kind == "MutuallyExclusive";
  const bool is_plain =
      arguments.size() == 1 || (arguments.size() == 2 && arguments[1].condition == "true");
  if (!is_known || !is_plain) writer_.hole(call.place, "a group of no known kind", true);
}

std::string EndMaker::resolve(const std::string& name, int node) const {
  const Node& of = walk_.model.nodes[static_cast<std::size_t>(node)];
  std::string space = of.space;
  while (space.starts_with('/')) space.erase(0, 1);
  const std::string root = space.empty() ? "/" : "/" + space + "/";
  if (name.starts_with("~/")) return root + of.name + name.substr(1);
  return name.starts_with('/') ? name : root + name;
}

// Ends of one topic have one word in the file; so have those of a service.
std::string EndMaker::label_for(const Entity& entity, const std::string& word) const {
  const bool has_name = entity.name.starts_with('/');
  for (const Entity& other : walk_.model.entities) {
    if (!has_name || other.name != entity.name) continue;
    const bool is_same = is_topic(entity.kind) == is_topic(other.kind);
    if (!is_same || other.label.empty()) continue;
    if (!is_same_message(entity.type, other.type)) {
      writer_.hole(entity.place, "ends of two types at " + entity.name, false);
    }
    return other.label;
  }
  return walk_.objects->label_of(has_name ? entity.name.substr(1) : entity.name, word);
}

}  // namespace maide::extract
