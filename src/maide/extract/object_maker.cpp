#include "maide/extract/object_maker.hpp"

#include <algorithm>
#include <cctype>
#include <map>
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

Value ObjectMaker::make_empty(const std::string& of_class) {
  Value made;
  made.kind = Value::Kind::object;
  made.type = of_class;
  made.index = static_cast<int>(walk_.model.objects.size());
  walk_.model.objects.push_back({of_class, {}, none});
  return made;
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
    return is_copy ? copy(arguments[0], place) : make(entry->name, arguments, place);
  }
  refuse_parts(type, place);
  return construct_known(of_class, arguments, place, hint);
}

Value ObjectMaker::construct_known(const std::string& of_class, const Arguments& arguments,
                                   const Place& place, const std::string& hint) {
  if (RowReader::makes(of_class)) {
    return walk_.rows->make(of_class, arguments, place, hint);
  }
  if (const ApiRow* row = walk_.table.find_method(of_class, "()")) {
    return walk_.rows->construct(*row, of_class, arguments, place);
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
  if (const ApiRow* row = walk_.table.find_function(of_class);
      row != nullptr && row->means == "inert") {
    return length_of_time(of_class, row->returns, arguments);
  }
  const bool is_known = walk_.names.is_known_type(of_class, walk_.values.frame().scope);
  if (!is_known) {
    writer_.hole(place, "an object of " + of_class, any_matters(arguments));
  } else if (any_matters(arguments)) {
    writer_.hole(place, "an end is given to " + of_class, true);
  }
  return data_value(is_plain_type(of_class) ? "" : of_class);
}

// Whether something is called when an object of the class comes or goes.
bool ObjectMaker::has_code(const std::string& type) const {
  const Class* entry = walk_.names.find_class(class_of_type(type), walk_.values.frame().scope);
  if (entry == nullptr || entry->is_enumeration || is_pointer_type(type)) return false;
  const std::string name = last_part(entry->name);
  return !walk_.names.all_methods(*entry, name).empty() ||
         !walk_.names.all_methods(*entry, "~" + name).empty() || !entry->bases.empty() ||
         entry->declared.contains(name) || entry->declared.contains("~" + name);
}

// Containers of objects make and end them when they like.
void ObjectMaker::refuse_parts(const std::string& type, const Place& place) {
  const std::string inner = template_arguments(type);
  if (inner.empty()) return;
  std::string part;
  int depth = 0;
  for (const char character : inner + ",") {
    if (character == '<') ++depth;
    if (character == '>') --depth;
    if (character != ',' || depth > 0) {
      part += character;
      continue;
    }
    if (has_code(part)) writer_.hole(place, "a container of objects of " + part, true);
    if (!is_pointer_type(part)) refuse_parts(part, place);
    part.clear();
  }
}

// An object that has the same in its fields.
Value ObjectMaker::copy(const Value& value, const Place& place) {
  if (value.kind != Value::Kind::object || value.is_pointer) return value;
  const std::string of_class = walk_.object(value.index).of_class;
  const Class* entry = walk_.names.find_class(of_class, "");
  const std::string name = last_part(of_class);
  bool is_strange = walk_.object(value.index).node != none;
  if (entry != nullptr) {
    const std::vector<int> makers = walk_.names.all_methods(*entry, name);
    is_strange = is_strange || !entry->bases.empty() ||
                 !walk_.names.all_methods(*entry, "~" + name).empty() ||
                 std::ranges::any_of(makers, [&](int maker) {
                   const auto& types = walk_.function(maker).parameter_types;
                   return !types.empty() && last_part(class_of_type(types[0])) == name;
                 });
  }
  if (is_strange) {
    writer_.hole(place, "a copy of an object of " + of_class, true);
    return value;
  }
  Value made = value;
  made.index = make_empty(of_class).index;
  const std::map<std::string, Value> fields = walk_.object(value.index).fields;
  for (const auto& [field, held] : fields) {
    walk_.object(made.index).fields[field] =
        copy(walk_.values.read_field(value.index, field, none), place);
  }
  return made;
}

Value ObjectMaker::converted(const std::string& type, Value value, const Place& place) {
  if (is_pointer_type(type)) {
    value.is_pointer = true;
    return value;
  }
  const Class* entry = walk_.names.find_class(class_of_type(type), walk_.values.frame().scope);
  const bool is_other = entry != nullptr && !entry->is_enumeration && type != "auto";
  if (value.kind == Value::Kind::object) {
    const std::string& of_class = walk_.object(value.index).of_class;
    if (is_other && of_class != entry->name && !walk_.names.derives_from(of_class, entry->name)) {
      writer_.hole(place, "an object of " + of_class + " becomes one of " + entry->name, true);
    }
    return type.ends_with("&") ? value : copy(value, place);
  }
  if (!is_other || value.kind == Value::Kind::mixed) return value;
  if (walk_.names.find_class(value.type, walk_.values.frame().scope) == entry) return value;
  if (value.type != "?" || value.matters()) return make(entry->name, {std::move(value)}, place);
  if (has_code(type))
    writer_.hole(place, "what is not known becomes an object of " + entry->name, true);
  return value;
}

// A constructor may keep what it is given by reference, and change it later.
void ObjectMaker::share_arguments(const std::string& type, const std::vector<Expression>& given,
                                  std::size_t first) {
  const Class* entry = walk_.names.find_class(class_of_type(type), walk_.values.frame().scope);
  if (entry == nullptr || entry->is_enumeration) return;
  const std::vector<int> makers = walk_.names.all_methods(*entry, last_part(entry->name));
  for (std::size_t i = first; i < given.size(); ++i) {
    const std::size_t at = i - first;
    const bool is_taken = std::ranges::any_of(makers, [&](int maker) {
      const Function& function = walk_.function(maker);
      return at < function.parameters.size() && walk_.may_be_written(function, at);
    });
    const bool is_held = makers.empty() && at < entry->members.size() &&
                         walk_.variable(entry->members[at]).is_reference;
    if (is_taken || is_held) walk_.expressions->share(given[i]);
  }
}

Value ObjectMaker::first_value(const Variable& variable, const std::vector<Expression>& expressions,
                               bool is_set, const Place& place) {
  const std::string type = class_of_type(variable.type);
  const bool holds_pointer = variable.is_pointer || is_pointer_type(variable.type);
  const bool is_list = expressions.size() == 1 && expressions[0].kind == Expression::Kind::list;
  const bool is_filled = is_list && !holds_pointer && !variable.is_reference &&
                         walk_.names.find_class(type, walk_.values.frame().scope) != nullptr;
  std::vector<Value> arguments =
      walk_.expressions->evaluate_all(is_filled ? expressions[0].operands : expressions, place);
  if (!holds_pointer && !variable.is_reference) {
    share_arguments(variable.type, is_filled ? expressions[0].operands : expressions, 0);
  }
  if (variable.is_array && (has_code(variable.type) || any_matters(arguments))) {
    writer_.hole(place, "an array of objects", true);
  }
  // An array is a pointer, too: its letters may change.
  const bool is_fixed = variable.type.find("const") != std::string::npos;
  if (variable.is_array && !is_fixed && !any_matters(arguments)) return data_value(type);
  Value value;
  if (arguments.empty() && (holds_pointer || variable.is_reference)) {
    value.kind = Value::Kind::null;
    return value;
  }
  if (variable.is_reference && !expressions.empty()) {
    const bool is_constant = variable.type.starts_with("const ");
    is_constant ? walk_.expressions->forget(expressions[0])
                : walk_.expressions->share(expressions[0]);
  }
  const bool is_copy =
      (is_set && !is_filled) || variable.is_reference || holds_pointer || type == "auto";
  if (!is_copy) return construct(variable.type, std::move(arguments), place, variable.name);
  if (arguments.size() != 1) {
    if (any_matters(arguments)) writer_.hole(place, "a pointer to what is not known", true);
    return unknown_value();
  }
  if (holds_pointer) arguments[0].is_pointer = true;
  if (variable.is_reference && !arguments[0].matters()) return data_value(type);
  if (variable.is_reference || holds_pointer) return arguments[0];
  return converted(variable.type, std::move(arguments[0]), place);
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
  Value self = make_empty(entry.name);
  if (!is_node) {
    fill(self, entry, arguments, place);
    return self;
  }
  begin_node(self, last_part(entry.name), place);
  const bool others_run = std::exchange(walk_.values.others_run, false);
  const int node = walk_.node_of(self);
  Program start = writer_.write(Phase::start, node, [&] { fill(self, entry, arguments, place); });
  walk_.values.others_run = others_run;
  if (has_steps(start.code) && !writer_.is_silent() && writer_.has_begun()) {
    writer_.hole(place, "main communicates before it makes this node", false);
  }
  walk_.model.nodes[static_cast<std::size_t>(node)].start = std::move(start);
  return self;
}

Value ObjectMaker::make_plain_node(const Arguments& arguments, const Place& place) {
  Value self = make_empty("rclcpp::Node");
  begin_node(self, "node", place);
  name_node(walk_.model.nodes.back(), arguments, place);
  return self;
}

void ObjectMaker::fill(const Value& self, const Class& entry, const Arguments& arguments,
                       const Place& place) {
  const Overloads makers = walk_.names.constructors(entry, arguments.size());
  const bool is_aggregate = !arguments.empty() && entry.bases.empty() &&
                            !entry.declared.contains(last_part(entry.name)) &&
                            arguments.size() <= entry.members.size();
  if (is_aggregate) return fill_in_order(self, entry, arguments, place);
  const bool is_known = makers.bodies.size() == 1 || (makers.bodies.empty() && arguments.empty());
  if (!is_known || makers.may_be_elsewhere) {
    writer_.hole(place, "constructors of " + entry.name + ": which one is not known",
                 any_matters(arguments));
    return;
  }
  const auto caller = walk_.values.enter(std::make_shared<Frame>());
  walk_.values.frame().self = self;
  walk_.values.frame().scope = entry.name;
  const std::string made = std::exchange(walk_.object(self.index).being_made, entry.name);
  const Function* maker = makers.bodies.empty() ? nullptr : &walk_.function(makers.bodies[0]);
  const Arguments fitted =
      maker != nullptr ? walk_.calls->bind_parameters(*maker, arguments, place) : Arguments{};
  make_bases(self, entry, maker, place);
  make_members(self, entry, maker);
  walk_.values.enter(caller);
  if (maker != nullptr) {
    walk_.calls->inline_function(makers.bodies[0], self, fitted, nullptr, place);
  }
  walk_.object(self.index).being_made = made;
}

// Point{1, 2}: the first members have these values.
void ObjectMaker::fill_in_order(const Value& self, const Class& entry, const Arguments& arguments,
                                const Place& place) {
  make_members(self, entry, nullptr);
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    const Variable& member = walk_.variable(entry.members[i]);
    walk_.values.set_field(self.index, member, converted(member.type, arguments[i], place));
  }
}

// Bases come first, whatever the order in which they are written.
void ObjectMaker::make_bases(const Value& self, const Class& entry, const Function* maker,
                             const Place& place) {
  std::vector<const Initialiser*> left;
  if (maker != nullptr) {
    for (const Initialiser& initialiser : maker->initialisers) left.push_back(&initialiser);
  }
  std::erase_if(left, [&](const Initialiser* initialiser) {
    return std::ranges::any_of(entry.members, [&](int member) {
      return walk_.variable(member).name == initialiser->member;
    });
  });
  for (const std::string& base : entry.bases) {
    const Class* known = walk_.names.find_class(base, outer_part(entry.name));
    const auto given = std::ranges::find_if(left, [&](const Initialiser* initialiser) {
      return last_part(initialiser->member) == last_part(base);
    });
    const bool is_own = known == &entry;
    if (known == nullptr && !walk_.table.has_class(base)) {
      writer_.hole(place, "a base " + base + " that is not known", true);
    }
    if (given == left.end()) {
      if (known != nullptr && !is_own) fill(self, *known, {}, place);
      continue;
    }
    const Initialiser& initialiser = **given;
    left.erase(given);
    if (known == nullptr || is_own) {
      initialise_api_base(self, entry, initialiser);
    } else {
      fill(self, *known, walk_.expressions->evaluate_all(initialiser.arguments, initialiser.place),
           initialiser.place);
    }
  }
  for (const Initialiser* initialiser : left) {
    const bool is_own = last_part(initialiser->member) == last_part(entry.name);
    const std::vector<Value> values =
        walk_.expressions->evaluate_all(initialiser->arguments, initialiser->place);
    writer_.hole(
        initialiser->place,
        is_own ? "a constructor that calls another one" : "a base or member " + initialiser->member,
        is_own || any_matters(values));
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
  name_node(walk_.model.nodes[static_cast<std::size_t>(walk_.node_of(self))], values,
            initialiser.place);
}

// Node(name), Node(name, options), Node(name, namespace), Node(name, namespace, options).
void ObjectMaker::name_node(Node& node, const Arguments& arguments, const Place& place) {
  const auto is_text = [&](std::size_t i) {
    return arguments.size() > i && arguments[i].kind == Value::Kind::text;
  };
  const bool has_space = arguments.size() > 1 && arguments[1].type != "rclcpp::NodeOptions";
  if (is_text(0)) node.name = arguments[0].text;
  if (is_text(1)) node.space = arguments[1].text;
  if (!is_text(0) || (has_space && !is_text(1))) {
    writer_.hole(place, "the name of a node is no constant", false);
  }
}

// In the order in which the class has them.
void ObjectMaker::make_members(const Value& self, const Class& entry, const Function* maker) {
  for (const int index : entry.members) {
    const Variable& member = walk_.variable(index);
    if (member.is_static) continue;
    const Initialiser* given = nullptr;
    if (maker != nullptr) {
      for (const Initialiser& initialiser : maker->initialisers) {
        if (initialiser.member == member.name) given = &initialiser;
      }
    }
    Value value = given != nullptr
                      ? first_value(member, given->arguments, false, given->place)
                      : first_value(member, member.arguments, member.is_set, member.place);
    if (!value.matters() && (value.type.empty() || value.type == "?")) {
      value.type = class_of_type(member.type);
    }
    walk_.values.set_field(self.index, member, std::move(value));
  }
}

}  // namespace maide::extract
