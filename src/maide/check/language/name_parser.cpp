#include "maide/check/language/name_parser.hpp"

#include <string>
#include <utility>
#include <vector>

#include "maide/base/text.hpp"

namespace maide::program_syntax {
namespace {

constexpr std::string_view symbols[] = {"->", "==", "!=", "<=", ">=", "&&", "||", "..", "{", "}",
                                        ";",  ".",  "@",  "*",  "<",  ">",  "+",  "-",  "/", "%",
                                        "!",  "(",  ")",  "[",  "]",  ",",  "=",  ":"};
// Keywords that begin a statement.
constexpr std::string_view openers[] = {"loop",   "repeat", "if",    "skip",   "stop",  "switch",
                                        "wait",   "select", "while", "for",    "break", "continue",
                                        "return", "call",   "var",   "atomic", "idle"};
// Those inside of one.
constexpr std::string_view others[] = {"else", "quiet", "on", "when", "otherwise", "timeout"};
constexpr std::uint64_t max_slots = 10'000;  // of a program's variables

}  // namespace

NameParser::NameParser(const ScalarText& text, Work& work)
    : tokens_(text, symbols),
      work_(work),
      context_(*work.context),
      expressions_(tokens_, [this](const Token& name) { return resolve(name); }) {}

bool NameParser::begins_statement(const Token& word) {
  return word.kind == Token::Kind::identifier && contains(openers, word.text);
}

bool NameParser::is_reserved(const Token& word) {
  return begins_statement(word) ||
         (word.kind == Token::Kind::identifier && contains(others, word.text));
}

std::vector<std::string> NameParser::statement_keywords() {
  return {std::begin(openers), std::end(openers)};
}

void NameParser::expect_end() {
  if (tokens_.peek().kind != Token::Kind::end) {
    tokens_.fail("nothing may follow here, and there is " + to_string(tokens_.peek()),
                 tokens_.peek());
  }
}

// ---- names --------------------------------------------------------------------------------------

const Binding* NameParser::find_binding(const std::string& name) const {
  for (std::size_t i = work_.scopes.size(); i-- > 0;) {
    const auto place = work_.scopes[i].names.find(name);
    if (place != work_.scopes[i].names.end()) return &place->second;
    if (work_.scopes[i].is_barrier) break;
  }
  return nullptr;
}

std::vector<std::string> NameParser::names_of_variables() const {
  std::vector<std::string> names;
  for (std::size_t i = work_.scopes.size(); i-- > 0;) {
    for (const auto& [name, binding] : work_.scopes[i].names) {
      if (binding.kind == Binding::Kind::variable) names.push_back(name);
    }
    if (work_.scopes[i].is_barrier) break;
  }
  for (const auto& [name, variable] : context_.names.variables) names.push_back(name);
  return names;
}

std::optional<Binding> NameParser::find(const std::string& name) const {
  if (const Binding* binding = find_binding(name)) return *binding;
  if (const auto own = work_.own.find(name); own != work_.own.end()) {
    work_.tree.file_variables.insert(name);
    return own->second;
  }
  const Names& file = context_.names;
  if (const std::string of_node = name_in_node(name); !of_node.empty()) return find(of_node);
  if (const auto place = file.variables.find(name); place != file.variables.end()) {
    work_.tree.file_variables.insert(name);
    const VariableName& variable = place->second;
    name_models(variable.leaf.index, variable.leaf.dimensions);
    return Binding{Binding::Kind::variable, variable.leaf, variable.type, false};
  }
  if (const auto place = file.constants.find(name); place != file.constants.end()) {
    return Binding{Binding::Kind::constant, place->second, {}, false};
  }
  if (const auto place = file.models.find(name); place != file.models.end()) {
    Binding binding{Binding::Kind::model, {}, {}, false};
    binding.expression.op = Expression::Operator::shared;
    binding.expression.index = place->second.first;
    binding.expression.dimensions = place->second.dimensions;
    binding.expression.name = name;
    binding.model = &place->second;
    return binding;
  }
  return std::nullopt;
}

std::string NameParser::name_in_node(const std::string& name) const {
  const Callback* const of = context_.callback != nullptr ? context_.callback : context_.starts;
  if (of == nullptr || !work_.calls.empty()) return "";
  std::string whole = of->node + "." + name;
  return context_.names.variables.contains(whole) ? whole : "";
}

void NameParser::name_models(std::uint32_t first, const Dimensions& dimensions) const {
  const auto count = static_cast<std::uint32_t>(member_count(dimensions));
  for (std::uint32_t i = 0; i < count; ++i) work_.names.insert(first + i);
}

Expression NameParser::resolve(const Token& name) {
  const auto binding = find(name.text);
  if (!binding) {
    if (const auto word = context_.words.find(name.text)) {
      return make_constant(*word, ValueKind::word);
    }
    std::vector<std::string> known = names_of_variables();
    for (const auto& [constant, value] : context_.names.constants) known.push_back(constant);
    tokens_.fail("unknown name '" + name.text +
                     "': there is no such variable, constant or word of a variable" +
                     did_you_mean(name.text, known),
                 name);
  }
  if (binding->kind == Binding::Kind::model) {
    tokens_.fail("'" + name.text + "' is a model, and an expression has variables and constants",
                 name);
  }
  return binding->expression;
}

Expression NameParser::without_shared(Expression expression, const Token& first,
                                      std::string_view where) {
  if (reads_shared(expression) && !context_.on_value) {
    tokens_.fail("a shared variable stands in assignments and conditions only, not in " +
                     std::string(where) + ": read it into a variable of the program's own",
                 first);
  }
  return expression;
}

Token NameParser::parse_new_name(std::string_view what) {
  Token name = tokens_.next();
  if (!name.is_name()) {
    tokens_.fail("expected the name of " + std::string(what) + ", not " + to_string(name), name);
  }
  if (name.kind == Token::Kind::identifier &&
      (is_reserved(name) || name.is("true") || name.is("false") || name.is("any") ||
       name.is("fair") || name.is("bool"))) {
    tokens_.fail("'" + name.text + "' is a keyword here", name);
  }
  if (find_binding(name.text) != nullptr) {
    tokens_.fail("there is a '" + name.text + "' here already", name);
  }
  const Names& file = context_.names;
  if (!name_in_node(name.text).empty()) {
    tokens_.fail("'" + name.text + "' is a name of the node's already", name);
  }
  if (file.variables.contains(name.text) || file.constants.contains(name.text) ||
      file.models.contains(name.text)) {
    tokens_.fail("'" + name.text + "' is a name of the file's already", name);
  }
  return name;
}

// ---- types and variables ------------------------------------------------------------------------

Dimensions NameParser::parse_dimensions(std::vector<std::string>* indices) {
  Dimensions dimensions;
  const Token first = tokens_.peek();
  if (!tokens_.accept("[")) return dimensions;
  do {
    const Token index = tokens_.next();
    if (!index.is_name()) tokens_.fail("expected an index as in [i in 0..4]", index);
    tokens_.expect("in", "behind an index, as in [i in 0..4]");
    dimensions.push_back(expressions_.parse_range("a bound of an index"));
    if (indices != nullptr) {
      if (contains(*indices, index.text)) {
        tokens_.fail("the index '" + index.text + "' is there twice", index);
      }
      indices->push_back(index.text);
    }
  } while (tokens_.accept(","));
  tokens_.expect("]", "behind the indices");
  if (member_count(dimensions) > max_array_members) {
    tokens_.fail("an array has at most " + std::to_string(max_array_members) + " members", first);
  }
  return dimensions;
}

ValueType NameParser::parse_type() {
  ValueType type;
  const Token first = tokens_.peek();
  if (tokens_.accept("bool")) {
    type.kind = ValueKind::boolean;
    type.high = 1;
    return type;
  }
  if (!tokens_.accept("{")) {
    if (first.is_name() && !find(first.text)) {
      tokens_.fail("a type is a range as `0..3`, `bool`, or words as `{idle, busy}`, and " +
                       to_string(first) + " is none of it",
                   first);
    }
    const auto range = expressions_.parse_range("a bound of a variable");
    type.low = range.low;
    type.high = range.high;
    return type;
  }
  type.kind = ValueKind::word;
  do {
    const Token word = tokens_.next();
    if (!word.is_name()) tokens_.fail("expected a word, not " + to_string(word), word);
    const Value value = context_.words.intern(word.text);
    if (type.contains(value)) tokens_.fail("'" + word.text + "' is there twice", word);
    type.words.push_back(value);
  } while (tokens_.accept(","));
  tokens_.expect("}", "behind the words");
  if (type.words.empty()) tokens_.fail("a variable has at least one value", first);
  return type;
}

Expression NameParser::parse_value_for(const ValueType& type, const std::string& name) {
  const Token first = tokens_.peek();
  Expression value = expressions_.parse();
  require(value, type.kind, "the value of " + name, tokens_.position(first));
  if (value.is_constant() && type.kind == ValueKind::word && !type.contains(value.value)) {
    tokens_.fail(to_string(value.value, value.kind, context_.words) + " is outside of " + name +
                     ": " + to_string(type, context_.words),
                 first);
  }
  return value;
}

std::uint32_t NameParser::make_slots(const Token& name, const ValueType& type,
                                     const Dimensions& dimensions) {
  const SourcePosition place = tokens_.position(name);
  const std::uint64_t count = member_count(dimensions);
  const auto key =
      std::tuple(place.line, place.column,
                 to_string(type, context_.words) + member_suffix(dimensions, count - 1));
  auto& slots = work_.tree.slots;
  if (slots.size() + count > max_slots) tokens_.fail("a program has at most 10000 variables", name);
  const auto [known, is_new] =
      work_.slot_places.try_emplace(key, static_cast<std::uint32_t>(slots.size()));
  for (std::uint64_t member = 0; is_new && member < count; ++member) {
    slots.push_back({name.text + member_suffix(dimensions, member), type, place});
    work_.tree.initial.emplace_back();
  }
  return known->second;
}

Expression NameParser::declare(const Token& name, const ValueType& type,
                               const Dimensions& dimensions, bool is_counted) {
  Expression leaf;
  leaf.op = Expression::Operator::local;
  leaf.kind = type.kind;
  leaf.index = make_slots(name, type, dimensions);
  leaf.dimensions = dimensions;
  leaf.name = name.text;
  Scope& scope = work_.scopes.back();
  scope.names[name.text] = {Binding::Kind::variable, leaf, type, is_counted};
  const auto count = static_cast<std::uint32_t>(member_count(dimensions));
  for (std::uint32_t i = 0; i < count; ++i) scope.block->slots.push_back(leaf.index + i);
  return leaf;
}

void NameParser::declare_own() {
  for (const std::string& name : context_.own) {
    const VariableName& variable = context_.names.variables.at(name);
    auto& slots = work_.tree.slots;
    Binding binding{Binding::Kind::variable, variable.leaf, variable.type, false};
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

std::pair<Expression, ValueType> NameParser::parse_target() {
  const Token name = tokens_.next();
  const auto binding = find(name.text);
  if (!binding) {
    tokens_.fail(
        "unknown variable '" + name.text + "'" + did_you_mean(name.text, names_of_variables()),
        name);
  }
  if (binding->kind != Binding::Kind::variable) {
    tokens_.fail("'" + name.text + "' is no variable, and cannot be set", name);
  }
  if (binding->is_counted) {
    tokens_.fail("'" + name.text + "' is counted by its 'for', and cannot be set", name);
  }
  Expression leaf = binding->expression;
  const SourcePosition place = tokens_.position(name);
  leaf.line = place.line;
  leaf.column = place.column;
  if (leaf.operands.empty()) leaf.operands = expressions_.parse_indices(leaf.dimensions, name);
  for (const Expression& index : leaf.operands) without_shared(index, name, "an index");
  return {std::move(leaf), binding->type};
}

ValueType NameParser::type_of(const Expression& expression) const {
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

ValueType NameParser::range_of(const Expression& expression) const {
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

// Readers of the file's declarations: variables, constants, and the keys of models, programs,
// arrays and procedures.

namespace {

class DeclarationParser : public NameParser {
 public:
  using NameParser::NameParser;

  std::vector<VariableName> parse_variables() {
    std::vector<VariableName> result;
    work_.scopes.push_back({{}, nullptr, false});
    while (tokens_.peek().kind != Token::Kind::end) {
      tokens_.expect("var", "before a variable");
      const Token name = parse_new_name("a variable");
      VariableName variable;
      variable.position = tokens_.position(name);
      variable.leaf.name = name.text;
      variable.leaf.dimensions = parse_dimensions();
      tokens_.expect(":", "between a variable and its type");
      variable.type = parse_type();
      variable.leaf.kind = variable.type.kind;
      variable.initial = variable.type.at(0);
      if (tokens_.accept("=")) {
        const Token first = tokens_.peek();
        const Expression value = parse_value_for(variable.type, name.text);
        if (!value.is_constant()) tokens_.fail("the first value must be known here", first);
        if (!variable.type.contains(value.value)) {
          tokens_.fail("the first value is outside of " + to_string(variable.type, context_.words),
                       first);
        }
        variable.initial = value.value;
      }
      tokens_.expect(";", "at the end of a variable");
      result.push_back(std::move(variable));
    }
    return result;
  }

  Expression parse_constant() {
    const Token first = tokens_.peek();
    Expression value = expressions_.parse();
    if (!value.is_constant()) {
      tokens_.fail("this constant has no value: it divides by zero, or is too large for 64 bits",
                   first);
    }
    expect_end();
    return value;
  }

  Declared parse_declared() {
    const Token name = tokens_.next();
    if (!name.is_name()) tokens_.fail("expected a name, not " + to_string(name), name);
    Declared declared;
    declared.name = name.text;
    declared.dimensions = parse_dimensions(&declared.indices);
    expect_end();
    return declared;
  }

  std::vector<Value> parse_member(const Dimensions& dimensions, bool is_whole) {
    const Token name = tokens_.next();
    std::vector<Value> indices;
    for (const Expression& index : expressions_.parse_indices(dimensions, name)) {
      if (!index.is_constant()) tokens_.fail("an index is known here", name);
      indices.push_back(index.value);
    }
    if (is_whole) expect_end();
    return indices;
  }

  Procedure parse_head(std::string& name) {
    const Token first = tokens_.next();
    if (!first.is_name())
      tokens_.fail("expected a procedure's name, not " + to_string(first), first);
    name = first.text;
    Procedure procedure;
    procedure.position = tokens_.position(first);
    tokens_.expect("(", "behind a procedure's name");
    while (!tokens_.accept(")")) {
      if (!procedure.parameters.empty()) tokens_.expect(",", "between parameters");
      const Token parameter = tokens_.next();
      if (!parameter.is_name()) {
        tokens_.fail("expected a parameter, not " + to_string(parameter), parameter);
      }
      if (contains(procedure.parameters, parameter.text)) {
        tokens_.fail("the parameter '" + parameter.text + "' is there twice", parameter);
      }
      procedure.parameters.push_back(parameter.text);
    }
    expect_end();
    return procedure;
  }
};

// Reads one text with a parser of its own.
template <typename Read>
auto read(const ScalarText& text, const Context& context, Read&& read) {
  Work work(context, text);
  DeclarationParser parser(text, work);
  return read(parser);
}

}  // namespace

std::vector<VariableName> parse_variables(const ScalarText& text, const Context& context) {
  return read(text, context, [](DeclarationParser& parser) { return parser.parse_variables(); });
}

Expression parse_constant(const ScalarText& text, const Context& context) {
  return read(text, context, [](DeclarationParser& parser) { return parser.parse_constant(); });
}

Declared parse_declared(const ScalarText& text, const Context& context) {
  return read(text, context, [](DeclarationParser& parser) { return parser.parse_declared(); });
}

std::vector<Value> parse_member(const ScalarText& text, const Context& context,
                                const Dimensions& dimensions) {
  return read(text, context,
              [&](DeclarationParser& parser) { return parser.parse_member(dimensions, true); });
}

std::vector<Value> parse_member_before(const ScalarText& text, const Context& context,
                                       const Dimensions& dimensions) {
  return read(text, context,
              [&](DeclarationParser& parser) { return parser.parse_member(dimensions, false); });
}

Procedure parse_head(const ScalarText& text, const Context& context, std::string& name) {
  return read(text, context, [&](DeclarationParser& parser) { return parser.parse_head(name); });
}

}  // namespace maide::program_syntax
