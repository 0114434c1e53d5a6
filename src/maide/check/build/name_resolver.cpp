#include "maide/check/build/name_resolver.hpp"

#include <algorithm>
#include <cstdlib>

#include "maide/base/text.hpp"

namespace maide::program_syntax {
namespace {

constexpr std::uint64_t max_slots = 10'000;  // of a program's variables

// A name that was taken for a word of a model's.
bool is_unknown_name(const Expression& expression) {
  return expression.op == Expression::Operator::shared && expression.kind == ValueKind::unknown;
}

}  // namespace

Work::Work(const Context& known, SourcePosition begin)
    : context(&known), position(std::move(begin)) {
  scopes.emplace_back();  // of the indices of an array
  for (const auto& [name, index] : known.indices) {
    scopes.back().names[name] = {Binding::Kind::constant, index, {}, false, nullptr};
  }
}

// ---- Names --------------------------------------------------------------------------------------

const Binding* NameResolver::find_binding(const std::string& name) const {
  for (std::size_t i = work_.scopes.size(); i-- > 0;) {
    const auto place = work_.scopes[i].names.find(name);
    if (place != work_.scopes[i].names.end()) return &place->second;
    if (work_.scopes[i].is_barrier) break;
  }
  return nullptr;
}

std::vector<std::string> NameResolver::names_of_variables() const {
  std::vector<std::string> names;
  for (std::size_t i = work_.scopes.size(); i-- > 0;) {
    for (const auto& [name, binding] : work_.scopes[i].names) {
      if (binding.kind == Binding::Kind::variable) names.push_back(name);
    }
    if (work_.scopes[i].is_barrier) break;
  }
  for (const auto& [name, variable] : context().names.variables) names.push_back(name);
  return names;
}

std::optional<Binding> NameResolver::find(const std::string& name) const {
  if (const Binding* binding = find_binding(name)) return *binding;
  if (const auto own = work_.own.find(name); own != work_.own.end()) {
    work_.tree.file_variables.insert(name);
    return own->second;
  }
  const Names& file = context().names;
  if (const std::string of_node = name_in_node(name); !of_node.empty()) return find(of_node);
  if (const auto place = file.variables.find(name); place != file.variables.end()) {
    work_.tree.file_variables.insert(name);
    const VariableName& variable = place->second;
    name_models(variable.leaf.index, variable.leaf.dimensions);
    return Binding{Binding::Kind::variable, variable.leaf, variable.type, false, nullptr};
  }
  if (const auto place = file.constants.find(name); place != file.constants.end()) {
    return Binding{Binding::Kind::constant, place->second, {}, false, nullptr};
  }
  if (const auto place = file.models.find(name); place != file.models.end()) {
    Binding binding{Binding::Kind::model, {}, {}, false, nullptr};
    binding.expression.op = Expression::Operator::shared;
    binding.expression.index = place->second.first;
    binding.expression.dimensions = place->second.dimensions;
    binding.expression.name = name;
    binding.model = &place->second;
    return binding;
  }
  return std::nullopt;
}

std::optional<Binding> NameResolver::find_value(const syntax::Name& name) const {
  std::optional<Binding> binding = find(name.text);
  const bool is_word =
      binding && binding->kind == Binding::Kind::constant && !name.may_be_constant();
  return is_word ? std::nullopt : binding;
}

std::string NameResolver::name_in_node(const std::string& name) const {
  const Callback* const of = context().callback != nullptr ? context().callback : context().starts;
  if (of == nullptr || !work_.calls.empty()) return "";
  std::string whole = of->node + "." + name;
  return context().names.variables.contains(whole) ? whole : "";
}

void NameResolver::name_models(std::uint32_t first, const Dimensions& dimensions) const {
  const auto count = static_cast<std::uint32_t>(member_count(dimensions));
  for (std::uint32_t i = 0; i < count; ++i) work_.names.insert(first + i);
}

void NameResolver::check_new(const syntax::Name& name) const {
  if (find_binding(name.text) != nullptr) {
    fail("there is a '" + name.text + "' here already", name.place);
  }
  const Names& file = context().names;
  if (!name_in_node(name.text).empty()) {
    fail("'" + name.text + "' is a name of the node's already", name.place);
  }
  if (file.variables.contains(name.text) || file.constants.contains(name.text) ||
      file.models.contains(name.text)) {
    fail("'" + name.text + "' is a name of the file's already", name.place);
  }
}

// ---- Expressions --------------------------------------------------------------------------------

Expression NameResolver::expression(const syntax::Term& term) const {
  using Kind = syntax::Term::Kind;
  if (term.kind == Kind::name) return named(term);
  if (term.kind != Kind::operation) {
    return make_constant(term.value,
                         term.kind == Kind::boolean ? ValueKind::boolean : ValueKind::integer);
  }
  const Expression::Operator op = operator_of(term.sign).value();
  // Only `==` and `!=` take words.
  const bool takes_words = term.sign == syntax::Sign::equal || term.sign == syntax::Sign::unequal;
  std::vector<Expression> operands;
  for (const syntax::Term& operand : term.operands) {
    operands.push_back(expression(operand));
    if (!takes_words && is_unknown_name(operands.back())) fail_unknown(operand);
  }
  if (operands.size() == 1) return make_unary(op, std::move(operands[0]), position(term.place));
  return make_binary(op, std::move(operands[0]), std::move(operands[1]), position(term.place));
}

Expression NameResolver::expression(const syntax::Term& term, ValueKind kind,
                                    std::string_view what) const {
  Expression made = expression(term);
  if (kind != ValueKind::word && is_unknown_name(made)) fail_unknown(term);
  require(made, kind, what, position(term.begin));
  return made;
}

void NameResolver::fail_unknown(const syntax::Term& term) const {
  const std::string& name = term.name.text;
  std::vector<std::string> known = names_of_variables();
  for (const auto& [constant, value] : context().names.constants) known.push_back(constant);
  fail("unknown name '" + name + "': there is no such variable, constant or word of a variable" +
           did_you_mean(name, known),
       term.place);
}

Expression NameResolver::presence(const syntax::Term& service) const {
  const auto binding = find(service.name.text);
  if (!binding || binding->kind != Binding::Kind::model || binding->model->is_topic ||
      !context().names.services.contains(binding->model->first)) {
    fail("'" + service.name.text + ".there' asks whether a service is there, and '" +
             service.name.text + "' is none",
         service.place);
  }
  const auto variable = find(presence_of(binding->expression.name));
  if (!variable) {
    name_models(binding->model->first, binding->model->dimensions);
    return make_constant(1, ValueKind::boolean);
  }
  Expression leaf = variable->expression;
  leaf.line = service.place.line;
  leaf.column = service.place.column;
  leaf.operands = binding->expression.operands.empty() ? indices(service, leaf.dimensions)
                                                       : binding->expression.operands;
  return leaf;
}

Expression NameResolver::named(const syntax::Term& term) const {
  if (!term.parts.empty()) return presence(term);
  const std::string& name = term.name.text;
  const auto binding = find_value(term.name);
  if (!binding) {
    const auto word = context().words.find(name);
    if (word && !term.has_indices) return make_constant(*word, ValueKind::word);
    if (context().stage != Context::Stage::names || term.has_indices) fail_unknown(term);
    // It may be a word of a model's. It is no constant, for nothing is known of it at once.
    Expression unknown_word;
    unknown_word.op = Expression::Operator::shared;
    unknown_word.kind = ValueKind::unknown;
    unknown_word.name = name;
    return unknown_word;
  }
  if (binding->kind == Binding::Kind::model) {
    fail("'" + name + "' is a model, and an expression has variables and constants", term.place);
  }
  Expression leaf = binding->expression;
  leaf.line = term.place.line;
  leaf.column = term.place.column;
  if (leaf.operands.empty()) {
    leaf.operands = indices(term, leaf.dimensions);
  } else if (term.has_indices) {
    fail("'" + name + "' is no array", term.place);
  }
  return leaf;
}

Expression NameResolver::without_shared(Expression expression, TextPlace begin,
                                        std::string_view where) const {
  if (reads_shared(expression) && context().stage >= Context::Stage::owners) {
    fail("a shared variable stands in assignments and conditions only, not in " +
             std::string(where) + ": read it into a variable of the program's own",
         begin);
  }
  return expression;
}

std::vector<Expression> NameResolver::indices(const syntax::Term& name,
                                              const Dimensions& dimensions) const {
  std::vector<Expression> made;
  const std::string quoted = "'" + name.name.text + "'";
  if (dimensions.empty()) {
    if (name.has_indices) fail(quoted + " is no array", name.place);
    return made;
  }
  if (!name.has_indices) {
    fail(quoted + " is an array: say which member, as in " + name.name.text +
             member_suffix(dimensions, 0),
         name.place);
  }
  for (const syntax::Term& index : name.operands) {
    made.push_back(expression(index, ValueKind::integer, "an index"));
  }
  if (made.size() != dimensions.size()) {
    fail(quoted + " has " + std::to_string(dimensions.size()) +
             (dimensions.size() == 1 ? " index" : " indices") + ", not " +
             std::to_string(made.size()),
         name.place);
  }
  return made;
}

Value NameResolver::constant(const syntax::Term& term, std::string_view what) const {
  const Expression value = expression(term, ValueKind::integer, what);
  if (value.is_constant()) return value.value;
  fail(std::string(what) + " is made of numbers, constants and indices of arrays alone",
       term.begin);
}

Expression::Dimension NameResolver::range(const syntax::Range& range, std::string_view what) const {
  const Expression::Dimension made{constant(range.low, what), constant(range.high, what)};
  if (made.low > made.high) {
    fail(std::string(what) + " goes from the least to the greatest, and " +
             std::to_string(made.low) + " is greater than " + std::to_string(made.high),
         range.low.begin);
  }
  constexpr Value far = Value{1} << 62;
  if (made.low < -far || made.high > far) fail("bounds go up to 2^62", range.low.begin);
  return made;
}

// ---- Types and variables ------------------------------------------------------------------------

Dimensions NameResolver::dimensions(const std::vector<syntax::Index>& indices) const {
  Dimensions dimensions;
  for (const syntax::Index& index : indices) {
    dimensions.push_back(range(index.range, "a bound of an index"));
  }
  if (member_count(dimensions) > max_array_members) {
    fail("an array has at most " + std::to_string(max_array_members) + " members",
         indices.front().name.place);
  }
  return dimensions;
}

ValueType NameResolver::type(const syntax::Type& type) const {
  ValueType made;
  if (type.is_boolean) {
    made.kind = ValueKind::boolean;
    made.high = 1;
    return made;
  }
  if (type.range) {
    const syntax::Term& low = type.range->low;
    if (low.is_name() && !find(low.name.text)) {
      fail("a type is a range as `0..3`, `bool`, or words as `{idle, busy}`, and '" +
               low.name.text + "' is none of it",
           low.place);
    }
    const auto bounds = range(*type.range, "a bound of a variable");
    made.low = bounds.low;
    made.high = bounds.high;
    return made;
  }
  made.kind = ValueKind::word;
  for (const syntax::Name& word : type.words) {
    made.words.push_back(context().words.intern(word.text));
  }
  return made;
}

Expression NameResolver::value_for(const syntax::Term& term, const ValueType& type,
                                   const std::string& name) const {
  Expression value = expression(term, type.kind, "the value of " + name);
  if (value.is_constant() && type.kind == ValueKind::word && !type.contains(value.value)) {
    fail(to_string(value.value, value.kind, context().words) + " is outside of " + name + ": " +
             to_string(type, context().words),
         term.begin);
  }
  return value;
}

std::uint32_t NameResolver::make_slots(const syntax::Name& name, const ValueType& type,
                                       const Dimensions& dimensions) {
  const std::uint64_t count = member_count(dimensions);
  const auto key =
      std::tuple(name.place.line, name.place.column,
                 to_string(type, context().words) + member_suffix(dimensions, count - 1));
  auto& slots = work_.tree.slots;
  if (slots.size() + count > max_slots) {
    fail("a program has at most 10000 variables", name.place);
  }
  const auto [known, is_new] =
      work_.slot_places.try_emplace(key, static_cast<std::uint32_t>(slots.size()));
  for (std::uint64_t member = 0; is_new && member < count; ++member) {
    slots.push_back({name.text + member_suffix(dimensions, member), type, position(name.place)});
    work_.tree.initial.emplace_back();
  }
  return known->second;
}

Expression NameResolver::declare(const syntax::Name& name, const ValueType& type,
                                 const Dimensions& dimensions, bool is_counted) {
  Expression leaf;
  leaf.op = Expression::Operator::local;
  leaf.kind = type.kind;
  leaf.index = make_slots(name, type, dimensions);
  leaf.dimensions = dimensions;
  leaf.name = name.text;
  Scope& scope = work_.scopes.back();
  scope.names[name.text] = {Binding::Kind::variable, leaf, type, is_counted, nullptr};
  const auto count = static_cast<std::uint32_t>(member_count(dimensions));
  for (std::uint32_t i = 0; i < count; ++i) scope.block->slots.push_back(leaf.index + i);
  return leaf;
}

void NameResolver::declare_own() {
  for (const std::string& name : context().own) {
    const VariableName& variable = context().names.variables.at(name);
    auto& slots = work_.tree.slots;
    Binding binding{Binding::Kind::variable, variable.leaf, variable.type, false, nullptr};
    binding.expression.op = Expression::Operator::local;
    binding.expression.index = static_cast<std::uint32_t>(slots.size());
    work_.own.emplace(name, std::move(binding));
    const std::uint64_t count = member_count(variable.leaf.dimensions);
    for (std::uint64_t member = 0; member < count; ++member) {
      slots.push_back({name + member_suffix(variable.leaf.dimensions, member), variable.type,
                       variable.position});
      work_.tree.initial.emplace_back(variable.initial);
    }
  }
}

std::pair<Expression, ValueType> NameResolver::target(const syntax::Term& term) const {
  const std::string& name = term.name.text;
  const auto binding = find(name);
  if (!binding) {
    fail("unknown variable '" + name + "'" + did_you_mean(name, names_of_variables()), term.place);
  }
  if (binding->kind != Binding::Kind::variable) {
    fail("'" + name + "' is no variable, and cannot be set", term.place);
  }
  if (binding->is_counted) {
    fail("'" + name + "' is counted by its 'for', and cannot be set", term.place);
  }
  Expression leaf = named(term);
  for (const Expression& index : leaf.operands) without_shared(index, term.place, "an index");
  return {std::move(leaf), binding->type};
}

ValueType NameResolver::type_of(const Expression& expression) const {
  ValueType type;
  type.kind = expression.kind;
  if (expression.kind == ValueKind::boolean) {
    type.high = 1;
    return type;
  }
  if (expression.is_constant()) {
    type.low = type.high = expression.value;
    if (expression.kind == ValueKind::word) type.words = {expression.value};
    return type;
  }
  if (expression.op == Expression::Operator::local) {
    return work_.tree.slots[expression.index].type;
  }
  if (expression.op == Expression::Operator::shared) return type;  // an error elsewhere
  return range_of(expression);
}

ValueType NameResolver::range_of(const Expression& expression) const {
  using Operator = Expression::Operator;
  const ValueType left = type_of(expression.operands[0]);
  const ValueType right = expression.operands.size() > 1 ? type_of(expression.operands[1]) : left;
  std::vector<Value> ends;
  for (const Value a : {left.low, left.high}) {
    for (const Value b : {right.low, right.high}) {
      Value end = 0;
      bool overflows = false;
      switch (expression.op) {
        case Operator::negate: overflows = __builtin_sub_overflow(Value{0}, a, &end); break;
        case Operator::plus: overflows = __builtin_add_overflow(a, b, &end); break;
        case Operator::minus: overflows = __builtin_sub_overflow(a, b, &end); break;
        case Operator::times: overflows = __builtin_mul_overflow(a, b, &end); break;
        default: break;
      }
      constexpr Value far = Value{1} << 62;
      ends.push_back(overflows ? (a < 0 ? -far : far) : end);
    }
  }
  if (expression.op == Operator::divide || expression.op == Operator::remainder) {
    // No quotient is farther from 0 than the dividend, no remainder than either.
    Value far = std::max(std::abs(left.low), std::abs(left.high));
    if (expression.op == Operator::remainder) {
      far = std::min(far, std::max(std::abs(right.low), std::abs(right.high)) - 1);
    }
    ends = {left.low < 0 || expression.op == Operator::divide ? -far : 0,
            left.high > 0 || expression.op == Operator::divide ? far : 0};
    if (left.low >= 0 && right.low >= 0) ends[0] = 0;
  }
  ValueType type;
  type.low = *std::min_element(ends.begin(), ends.end());
  type.high = *std::max_element(ends.begin(), ends.end());
  return type;
}

}  // namespace maide::program_syntax
