#include "maide/extract/object_maker.hpp"

#include <algorithm>
#include <cctype>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "maide/extract/call_walker.hpp"
#include "maide/extract/expression_walker.hpp"
#include "maide/extract/row_reader.hpp"
#include "maide/extract/type_names.hpp"

namespace maide::extract {
namespace {

std::string word_of(const std::string& name) {
  std::string word;
  for (const char c : name) {
    word += std::isalnum(static_cast<unsigned char>(c)) != 0 ? c : '_';
  }
  while (word.starts_with('_')) word.erase(0, 1);
  while (word.ends_with('_')) word.pop_back();
  return word.empty() || std::isdigit(static_cast<unsigned char>(word[0])) != 0 ? "n" + word : word;
}

bool is_thread_or_function(const std::string& type) {
  return type == "std::thread" || type == "std::jthread" || type == "std::function";
}

}  // namespace

std::string ObjectMaker::label_of(const std::string& name, const std::string& stem) const {
  // Words of the language, and ours for nodes and programs.
  static const std::set<std::string> taken{"timer", "wait",  "read", "spin",  "main",  "stop",
                                           "start", "loop",  "take", "true",  "false", "threads",
                                           "any",   "while", "do",   "offer", "kill",  "end",
                                           "if",    "on",    "at",   "run",   "join",  "anybody"};
  std::string label = word_of(name);
  const auto is_taken = [&](const std::string& word) {
    return taken.contains(word) || word == stem ||
           std::ranges::any_of(walk_.model.entities,
                               [&](const Entity& e) { return e.label == word; });
  };
  if (is_taken(label)) label += "_" + std::to_string(walk_.model.entities.size());
  return label;
}

Value ObjectMaker::make_entity(Entity entity, const std::string& type) {
  Value value;
  value.kind = Value::Kind::entity;
  value.type = type;
  value.index = static_cast<int>(walk_.model.entities.size());
  if (entity.node != none) {
    walk_.model.nodes[static_cast<std::size_t>(entity.node)].entities.push_back(value.index);
  }
  walk_.model.entities.push_back(std::move(entity));
  return value;
}

// ---- What is constructed ----

Value ObjectMaker::construct(const std::string& type, Arguments arguments, const Place& place,
                             const std::string& hint) {
  const std::string of_class = class_of_type(type);
  const Class* entry = walk_.names.find_class(of_class, walk_.values.frame().scope);
  if (is_pointer_type(type)) {
    if (arguments.size() == 1) return arguments[0];
    if (any_matters(arguments)) writer_.hole(place, "a pointer to what is not known", true);
    return data_value(of_class);
  }
  if (entry != nullptr && !entry->is_enumeration) {
    const bool is_copy = arguments.size() == 1 && arguments[0].kind == Value::Kind::object &&
                         walk_.object(arguments[0].index).of_class == entry->name;
    if (is_copy) {
      writer_.hole(place, "a copy of an object", true);
      return arguments[0];
    }
    return make(entry->name, arguments, place);
  }
  return construct_known(of_class, arguments, place, hint);
}

Value ObjectMaker::construct_known(const std::string& of_class, const Arguments& arguments,
                                   const Place& place, const std::string& hint) {
  if (RowReader::makes(of_class)) {
    return walk_.rows->make(of_class, arguments, place, hint);
  }
  if (of_class == "std::function" && arguments.size() == 1) return arguments[0];
  if (of_class == "std::string" && arguments.size() == 1 && !arguments[0].matters()) {
    return arguments[0];
  }
  if (is_thread_or_function(of_class) && arguments.empty()) {
    Value empty;
    empty.kind = Value::Kind::null;
    return empty;
  }
  const bool is_known = walk_.names.is_known_type(of_class, walk_.values.frame().scope);
  if (!is_known) {
    writer_.hole(place, "an object of " + of_class, any_matters(arguments));
  } else if (any_matters(arguments)) {
    writer_.hole(place, "an end is given to " + of_class, true);
  }
  return data_value(is_plain_type(of_class) ? "" : of_class);
}

// ---- Objects of the sources ----

void ObjectMaker::begin_node(Value& self, const std::string& name, const Place& place) {
  if (writer_.phase() != Phase::start || writer_.is_conditional()) {
    writer_.hole(place, "a node that is made later", true);
  }
  if (writer_.node() != none) writer_.hole(place, "a node that is made by a node", true);
  Node node;
  node.name = name;
  node.object = self.index;
  node.place = place;
  walk_.object(self.index).node = static_cast<int>(walk_.model.nodes.size());
  walk_.model.nodes.push_back(std::move(node));
}

Value ObjectMaker::make(const std::string& of_class, const Arguments& arguments,
                        const Place& place) {
  const Class& entry = *walk_.names.find_class(of_class, "");
  const bool is_node = walk_.names.is_node_class(entry.name);
  if (is_node && writer_.is_silent()) return data_value(entry.name);
  Value self;
  self.kind = Value::Kind::object;
  self.type = entry.name;
  self.index = static_cast<int>(walk_.model.objects.size());
  walk_.model.objects.push_back({entry.name, {}, none});
  if (!is_node) {
    fill(self, entry, arguments, place);
    return self;
  }
  begin_node(self, last_part(entry.name), place);
  const int node = walk_.node_of(self);
  Program start = writer_.write(Phase::start, node, [&] { fill(self, entry, arguments, place); });
  if (has_steps(start.code) && !writer_.is_silent() && writer_.has_begun()) {
    writer_.hole(place, "main communicates before it makes this node", false);
  }
  walk_.model.nodes[static_cast<std::size_t>(node)].start = std::move(start);
  return self;
}

Value ObjectMaker::make_plain_node(const Arguments& arguments, const Place& place) {
  Value self;
  self.kind = Value::Kind::object;
  self.type = "rclcpp::Node";
  self.index = static_cast<int>(walk_.model.objects.size());
  walk_.model.objects.push_back({"rclcpp::Node", {}, none});
  const bool is_named = !arguments.empty() && arguments[0].kind == Value::Kind::text;
  if (!is_named) writer_.hole(place, "the name of a node is no constant", false);
  begin_node(self, is_named ? arguments[0].text : "node", place);
  return self;
}

void ObjectMaker::fill(const Value& self, const Class& entry, const Arguments& arguments,
                       const Place& place) {
  const Overloads makers = walk_.names.constructors(entry, arguments.size());
  const bool is_known = makers.bodies.size() == 1 || (makers.bodies.empty() && arguments.empty());
  if (!is_known || makers.may_be_elsewhere) {
    writer_.hole(place, "constructors of " + entry.name + ": which one is not known",
                 any_matters(arguments));
    return;
  }
  const auto caller = walk_.values.enter(std::make_shared<Frame>());
  walk_.values.frame().self = self;
  walk_.values.frame().scope = entry.name;
  std::set<std::string> initialised;
  if (!makers.bodies.empty()) {
    const Function& maker = walk_.function(makers.bodies[0]);
    walk_.calls->bind_parameters(maker, arguments);
    run_initialisers(self, entry, maker, initialised);
  }
  for (const std::string& base : entry.bases) {
    const Class* known = walk_.names.find_class(base, outer_part(entry.name));
    if (known != nullptr && known != &entry && !initialised.contains(known->name)) {
      fill(self, *known, {}, place);
    } else if (known == nullptr && !walk_.table.has_class(base)) {
      writer_.hole(place, "a base " + base + " that is not known", true);
    }
  }
  default_members(self, entry, initialised);
  walk_.values.enter(caller);
  if (!makers.bodies.empty()) {
    walk_.calls->inline_function(makers.bodies[0], self, arguments, nullptr, place);
  }
}

void ObjectMaker::run_initialisers(const Value& self, const Class& entry, const Function& maker,
                                   std::set<std::string>& initialised) {
  for (const Initialiser& initialiser : maker.initialisers) {
    initialised.insert(initialiser.member);
    const Class* base = nullptr;
    bool is_member = false;
    for (const int member : entry.members) {
      if (walk_.variable(member).name != initialiser.member) continue;
      is_member = true;
      initialise_member(self, walk_.variable(member),
                        walk_.expressions->evaluate_all(initialiser.arguments, initialiser.place),
                        initialiser);
    }
    if (is_member) continue;
    for (const std::string& name : entry.bases) {
      const bool is_named = last_part(name) == last_part(initialiser.member);
      if (is_named) base = walk_.names.find_class(name, outer_part(entry.name));
    }
    const bool is_own = last_part(initialiser.member) == last_part(entry.name);
    if (is_own) {
      writer_.hole(initialiser.place, "a constructor that calls another one", true);
    } else if (base != nullptr) {
      initialised.insert(base->name);
      fill(self, *base, walk_.expressions->evaluate_all(initialiser.arguments, initialiser.place),
           initialiser.place);
    } else {
      initialise_api_base(self, entry, initialiser);
    }
  }
}

void ObjectMaker::initialise_api_base(const Value& self, const Class& entry,
                                      const Initialiser& initialiser) {
  const std::vector<Value> values =
      walk_.expressions->evaluate_all(initialiser.arguments, initialiser.place);
  const bool is_node = last_part(initialiser.member) == "Node" && walk_.node_of(self) != none &&
                       std::ranges::find(entry.bases, "rclcpp::Node") != entry.bases.end();
  if (!is_node) {
    return writer_.hole(initialiser.place, "a base or member " + initialiser.member,
                        any_matters(values));
  }
  Node& node = walk_.model.nodes[static_cast<std::size_t>(walk_.node_of(self))];
  const auto is_text = [&](std::size_t i) {
    return values.size() > i && values[i].kind == Value::Kind::text;
  };
  if (is_text(0)) node.name = values[0].text;
  if (is_text(1)) node.space = values[1].text;
}

void ObjectMaker::initialise_member(const Value& self, const Variable& member,
                                    std::vector<Value> values, const Initialiser& initialiser) {
  const bool holds_pointer =
      member.is_pointer || member.is_reference || is_pointer_type(member.type);
  Value value;
  if (values.size() == 1 && (holds_pointer || values[0].kind == Value::Kind::entity)) {
    value = values[0];
    if (member.is_reference) walk_.expressions->forget(initialiser.arguments[0]);
  } else if (values.empty() && holds_pointer) {
    value.kind = Value::Kind::null;
  } else {
    value =
        walk_.objects->construct(member.type, std::move(values), initialiser.place, member.name);
  }
  if (value.type.empty() && !value.matters()) value.type = class_of_type(member.type);
  walk_.values.set_field(self.index, member.name, std::move(value));
}

void ObjectMaker::default_members(const Value& self, const Class& entry,
                                  const std::set<std::string>& initialised) {
  for (const int index : entry.members) {
    const Variable& member = walk_.variable(index);
    if (initialised.contains(member.name) || member.is_static) continue;
    std::vector<Value> values = walk_.expressions->evaluate_all(member.arguments, member.place);
    const bool holds_pointer =
        member.is_pointer || member.is_reference || is_pointer_type(member.type);
    Value value;
    if (values.size() == 1 && (holds_pointer || member.is_set)) {
      value = values[0];
    } else if (holds_pointer) {
      value.kind = Value::Kind::null;
    } else {
      value = construct(member.type, std::move(values), member.place, member.name);
    }
    if (value.type.empty() && !value.matters()) value.type = class_of_type(member.type);
    walk_.values.set_field(self.index, member.name, std::move(value));
  }
}

}  // namespace maide::extract
