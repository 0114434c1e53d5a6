#include "maide/extract/value_store.hpp"

#include <algorithm>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "maide/extract/type_names.hpp"

namespace maide::extract {
namespace {

using Form = Expression::Kind;

void add_root(const Expression& target, std::set<int>& variables) {
  if (target.variable != none) variables.insert(target.variable);
  for (const Expression& operand : target.operands) add_root(operand, variables);
}

// Variables that the expression may change. Functions that it calls are not looked into: what is
// passed to them counts as changed.
void add_changed(const Expression& expression, std::set<int>& variables) {
  const bool changes =
      expression.kind == Form::assign ||
      (expression.kind == Form::other && (expression.text == "++" || expression.text == "--" ||
                                          expression.text == "&" || expression.text == ">>"));
  if (changes) {
    for (const Expression& operand : expression.operands) add_root(operand, variables);
  }
  if (expression.kind == Form::call) {
    for (const Expression& argument : expression.operands) add_root(argument, variables);
  }
  for (const Expression& operand : expression.operands) add_changed(operand, variables);
}

void add_changed(const Statement& statement, std::set<int>& variables) {
  if (statement.variable != none) variables.insert(statement.variable);
  for (const Expression& expression : statement.expressions) add_changed(expression, variables);
  for (const auto& block : statement.blocks) {
    for (const Statement& inner : block) add_changed(inner, variables);
  }
}

// Variables that stand left of an assignment.
void add_assigned(const Expression& expression, std::set<int>& variables) {
  if (expression.kind == Form::assign) add_root(expression.operands[0], variables);
  for (const Expression& operand : expression.operands) add_assigned(operand, variables);
}

void add_assigned(const Statement& statement, std::set<int>& variables) {
  for (const Expression& expression : statement.expressions) add_assigned(expression, variables);
  for (const auto& block : statement.blocks) {
    for (const Statement& inner : block) add_assigned(inner, variables);
  }
}

void make_any(Value& value) {
  if (!value.matters() && value.kind != Value::Kind::status) value.kind = Value::Kind::data;
  value.text.clear();
  value.condition.clear();
  value.presence.clear();
}

// The name under which a class of the sources keeps its member: a base may have one of that name.
std::string name_of(const Variable& member) { return member.of_class + "::" + member.name; }

// What a variable keeps of a truth value: that it is `true` here says nothing about later.
void weaken(Value& value) {
  if (value.condition == "true" || value.condition == "false") value.condition.clear();
  value.presence.clear();
}

}  // namespace

Slot ValueStore::slot_of(const Variable& variable, int index) const {
  Slot slot;
  slot.variable = index;
  slot.name = variable.name;
  slot.is_through_reference = variable.is_reference;
  slot.kind = Slot::Kind::variable;
  if (!variable.of_class.empty() && !variable.is_static) {
    slot.kind = Slot::Kind::field;
    slot.name = name_of(variable);
    const bool is_own = frame_->self.kind == Value::Kind::object;
    slot.object = is_own ? frame_->self.index : none;
    if (!is_own) slot.kind = Slot::Kind::nowhere;
  }
  return slot;
}

Value ValueStore::data_of(int variable) const {
  Value value;
  value.type = variable == none
                   ? "?"
                   : class_of_type(sources_.variables[static_cast<std::size_t>(variable)].type);
  return value;
}

Value* ValueStore::local(int variable) {
  for (Frame* frame = frame_.get(); frame != nullptr; frame = frame->outer.get()) {
    const auto found = frame->values.find(variable);
    if (found != frame->values.end()) return &found->second;
  }
  const auto found = globals_.find(variable);
  return found == globals_.end() ? nullptr : &found->second;
}

Value ValueStore::read(const Slot& slot) {
  if (slot.kind == Slot::Kind::field) return read_field(slot.object, slot.name, slot.variable);
  if (slot.kind == Slot::Kind::nowhere) return data_of(slot.variable);
  Value* kept = local(slot.variable);
  Value value = kept != nullptr ? *kept : data_of(slot.variable);
  if (!value.condition.empty() && value.program != writer_.program()) value.condition.clear();
  if (!frame_->values.contains(slot.variable) && mixed_.contains(key_of(slot.variable))) {
    value = data_of(slot.variable);
    value.kind = Value::Kind::mixed;
  }
  if (is_shared_key(key_of(slot.variable))) make_any(value);
  return value;
}

const Variable* ValueStore::find_member(const std::string& of_class,
                                        const std::string& name) const {
  const auto entry = sources_.classes.find(of_class);
  if (entry == sources_.classes.end()) return nullptr;
  for (const int index : entry->second.members) {
    const Variable& member = sources_.variables[static_cast<std::size_t>(index)];
    if (member.name == name) return &member;
  }
  for (const std::string& base : entry->second.bases) {
    for (std::string around = outer_part(of_class);; around = outer_part(around)) {
      const std::string full = around.empty() ? base : around + "::" + base;
      if (full == of_class) break;
      if (const Variable* member = find_member(full, name)) return member;
      if (around.empty()) break;
    }
  }
  return nullptr;
}

std::string ValueStore::field_of(int object, const std::string& name, int variable) const {
  if (name.find("::") != std::string::npos) return name;
  const Object& of = model_.objects[static_cast<std::size_t>(object)];
  const Variable* member = variable == none
                               ? find_member(of.of_class, name)
                               : &sources_.variables[static_cast<std::size_t>(variable)];
  return member == nullptr || member->of_class.empty() ? name : name_of(*member);
}

Value ValueStore::read_field(int object, const std::string& member, int variable) {
  Object& of = model_.objects[static_cast<std::size_t>(object)];
  const std::string name = field_of(object, member, variable);
  Value value = data_of(variable);
  if (const auto found = of.fields.find(name); found != of.fields.end()) value = found->second;
  value.condition.clear();
  if (mixed_.contains(key_of(object, name))) {
    Value mixed;
    mixed.type = value.type;
    mixed.kind = Value::Kind::mixed;
    return mixed;
  }
  if (is_shared_key(key_of(object, name))) make_any(value);
  return value;
}

void ValueStore::declare(int variable, Value value) {
  weaken(value);
  frame_->values[variable] = std::move(value);
}

std::string ValueStore::key_of(int variable) const {
  const Variable& known = sources_.variables[static_cast<std::size_t>(variable)];
  return "variable " + known.name + " of " + to_string(known.place);
}

void ValueStore::set_field(int object, const Variable& member, Value value) {
  weaken(value);
  if (!is_weak_type(member.type)) keep(value, object);
  field(object, name_of(member)) = std::move(value);
}

// An end, or an object with one.
bool ValueStore::is_end(const Value& value) const {
  const bool is_object = value.kind == Value::Kind::object;
  return value.kind == Value::Kind::entity ||
         (is_object && std::ranges::any_of(model_.entities, [&](const Entity& entity) {
            return std::ranges::find(entity.holders, value.index) != entity.holders.end();
          }));
}

void ValueStore::keep(const Value& value, int holder) {
  if (value.kind == Value::Kind::entity) {
    model_.entities[static_cast<std::size_t>(value.index)].holders.push_back(holder);
  } else if (value.kind == Value::Kind::object) {
    model_.objects[static_cast<std::size_t>(value.index)].holders.push_back(holder);
  }
}

// A field or global: others may read it at any time.
void ValueStore::put(Value& kept, const Value& value, const std::string& key, const Place& place) {
  if (kept.kind == Value::Kind::object && !kept.is_pointer) return put_object(kept, value, place);
  const bool was_set = kept.matters();
  const bool is_same =
      kept.kind == value.kind && kept.index == value.index && value.kind != Value::Kind::callable;
  const bool is_late = writer_.phase() != Phase::start || writer_.is_conditional() || others_run;
  if ((value.matters() || was_set) && !is_same && (was_set || is_late)) mixed_.insert(key);
  if (is_end(kept) && !is_same) {
    writer_.hole(place, "an end goes, or another takes its place", true);
  }
  if (value.matters()) {
    kept = value;
  } else if (!was_set) {
    const std::string type = kept.type;
    if (is_late) forget_constant(kept, key);
    kept = value;
    kept.condition.clear();
    if (is_late) make_any(kept);
    if (kept.type.empty() || kept.type == "?") kept.type = type;
  }
}

// Into an object, not a pointer to one: each field has the other's value.
void ValueStore::put_object(Value& kept, const Value& value, const Place& place) {
  Object& target = model_.objects[static_cast<std::size_t>(kept.index)];
  const bool is_alike =
      value.kind == Value::Kind::object &&
      model_.objects[static_cast<std::size_t>(value.index)].of_class == target.of_class;
  const bool is_followed =
      std::ranges::any_of(target.fields, [](const auto& field) { return field.second.matters(); });
  if (value.matters() ? !is_alike : is_followed) {
    writer_.hole(place, "an object that another takes the place of", true);
  }
  if (!is_alike) {
    for (auto& field : target.fields) make_any(field.second);
    return;
  }
  const auto fields = model_.objects[static_cast<std::size_t>(value.index)].fields;
  for (const auto& [name, field] : fields) {
    put(target.fields[name], field, key_of(kept.index, name), place);
  }
}

void ValueStore::store_local(Value& kept, const Value& value, const Place& place) {
  if (kept.kind == Value::Kind::object && !kept.is_pointer) return put_object(kept, value, place);
  if (is_end(kept)) writer_.hole(place, "an end goes, or another takes its place", true);
  const bool is_known =
      !writer_.is_conditional() && !kept.matters() && !(value.matters() && frame_->has_lambda);
  const std::string type = kept.type.empty() ? value.type : kept.type;
  if (is_known) {
    kept = value;
    weaken(kept);
    if (frame_->has_lambda) make_any(kept);  // it may have captured the one before
    return;
  }
  const bool matters = value.matters() || kept.matters();
  kept = Value{};
  kept.type = type;
  if (matters) kept.kind = Value::Kind::mixed;
}

void ValueStore::store(const Slot& slot, const Value& value, const Place& place) {
  if (slot.kind == Slot::Kind::nowhere || slot.is_through_reference) {
    if (value.matters() || read(slot).matters()) {
      writer_.hole(place, "an end is kept where it is not followed", true);
    }
    return forget(slot);
  }
  const bool is_weak =
      slot.variable != none &&
      is_weak_type(sources_.variables[static_cast<std::size_t>(slot.variable)].type);
  if (slot.kind == Slot::Kind::field) {
    Value& kept = field(slot.object, slot.name);
    if (kept.type.empty() && slot.variable != none) kept.type = data_of(slot.variable).type;
    const bool is_option =
        model_.objects[static_cast<std::size_t>(slot.object)].of_class.ends_with("Options");
    if (!is_option && !is_weak) keep(value, slot.object);
    return put(kept, value, key_of(slot.object, slot.name), place);
  }
  if (frame_->values.contains(slot.variable)) {
    return store_local(frame_->values[slot.variable], value, place);
  }
  // A global, or what a lambda refers to: others may read it at any time.
  Value* kept = local(slot.variable);
  if (!is_weak) keep(value, for_ever);
  put(kept != nullptr ? *kept : globals_[slot.variable], value, key_of(slot.variable), place);
}

void ValueStore::forget(const Slot& slot) {
  if (slot.kind == Slot::Kind::variable) {
    Value* kept = local(slot.variable);
    if (kept == nullptr) return;
    frame_->values.contains(slot.variable) ? make_any(*kept)
                                           : forget_constant(*kept, key_of(slot.variable));
  } else if (slot.kind == Slot::Kind::field) {
    forget_constant(field(slot.object, slot.name), key_of(slot.object, slot.name));
  }
}

// What is changed after the start was another value for code that was gone through before.
void ValueStore::forget_constant(Value& kept, const std::string& key) {
  if (writer_.phase() != Phase::start && !kept.text.empty()) mixed_.insert("any " + key);
  make_any(kept);
}

void ValueStore::share(const Slot& slot) {
  forget(slot);
  if (slot.kind == Slot::Kind::variable) mixed_.insert("any " + key_of(slot.variable));
  if (slot.kind == Slot::Kind::field) mixed_.insert("any " + key_of(slot.object, slot.name));
}

void ValueStore::forget_what_is_set_in(const Statement& loop) {
  std::set<int> changed;
  add_changed(loop, changed);
  for (Frame* frame = frame_.get(); frame != nullptr; frame = frame->outer.get()) {
    for (auto& [variable, value] : frame->values) {
      value.condition.clear();
      if (changed.contains(variable) && !value.matters()) make_any(value);
    }
  }
  std::set<int> assigned;
  add_assigned(loop, assigned);
  for (const int variable : assigned) {
    Value* kept = local(variable);
    if (kept == nullptr || !kept->matters()) continue;
    kept->kind = Value::Kind::mixed;
    kept->condition.clear();
  }
}

}  // namespace maide::extract
