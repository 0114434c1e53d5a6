// Recursive descent over formulas; the grammar stands in formula.hpp. A word `F`, `G`, ... is the
// operator unless `@` or `.` follows it: `F !a!b` is "finally not", a model named F is quoted.
#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "maide/base/text.hpp"
#include "maide/check/language/expression_parser.hpp"
#include "maide/check/ltl/formula.hpp"
#include "maide/check/text/tokens.hpp"

namespace maide {
namespace {

using Operator = FormulaNode::Operator;

constexpr std::string_view symbols[] = {
    "<->", "->", "=>", "[]", "<>", "&&", "||", "==", "!=", "<=", ">=", "..", "&", "|", "!", "(",
    ")",   "@",  ".",  "<",  ">",  "+",  "-",  "*",  "/",  "%",  "[",  "]",  ",", ":", "="};
constexpr int max_nesting = 200;  // the parser and all walks over formulas recurse
constexpr int max_size = 2000;
constexpr double max_expanded_size = 10'000;  // of the normal form, in which each <-> doubles

// A formula, or an expression that is one if it is true or false.
struct Operand {
  Formula formula;
  std::optional<Expression> expression;
  Token first;
};

class Parser {
 public:
  Parser(const ScalarText& text, const FormulaScope& scope, std::vector<Expression>* expressions)
      : text_(text), tokens_(text, symbols), scope_(scope), expressions_(expressions) {}

  // The ranges of `forall`, if the text begins with it.
  Dimensions parse_quantifier() {
    Dimensions dimensions;
    const Token first = tokens_.peek();
    if (!first.is("forall") || tokens_.peek(1).is("@") || tokens_.peek(1).is("."))
      return dimensions;
    tokens_.next();
    ExpressionParser numbers(tokens_, [this](const Token& name) { return find_constant(name); });
    do {
      const Token index = tokens_.next();
      if (!index.is_name()) tokens_.fail("expected an index as in 'forall i in 0..4:'", index);
      tokens_.expect("in", "behind an index, as in 'forall i in 0..4:'");
      indices_.push_back(index.text);
      dimensions.push_back(numbers.parse_range("a bound of 'forall'"));
    } while (tokens_.accept(","));
    tokens_.expect(":", "behind the indices of 'forall'");
    if (member_count(dimensions) > max_array_members) {
      tokens_.fail("'forall' has too many instances", first);
    }
    return dimensions;
  }
  void set_indices(const std::vector<Value>& values) { values_ = values; }

  Formula parse() {
    Formula formula = parse_equivalence();
    const Token& rest = tokens_.peek();
    if (rest.is(")")) tokens_.fail("this ')' closes nothing", rest);
    fail_foreign(rest);
    if (rest.kind != Token::Kind::end) {
      tokens_.fail("expected an operator, not " + to_string(rest), rest);
    }
    if (expanded_size(formula) > max_expanded_size) {
      throw ParseError("the formula is too large: each <-> and W doubles what stands around it",
                       text_.position(0));
    }
    return formula;
  }

 private:
  Formula make(Operator op, Formula left, Formula right = nullptr) {
    if (++size_ > max_size) tokens_.fail("the formula is too large", tokens_.peek());
    return std::make_shared<FormulaNode>(FormulaNode{op, {}, std::move(left), std::move(right)});
  }

  Formula make_atom(const Atom& atom, const Token& first) {
    if (++size_ > max_size) tokens_.fail("the formula is too large", first);
    return std::make_shared<FormulaNode>(FormulaNode{Operator::atom, atom, nullptr, nullptr});
  }

  void deeper() {
    if (++nesting_ > max_nesting) {
      tokens_.fail("the formula is nested too deeply", tokens_.peek());
    }
  }

  void fail_foreign(const Token& token) const {
    static constexpr std::pair<std::string_view, std::string_view> foreign[] = {
        {"until", "U"},      {"release", "R"},   {"next", "X"},     {"always", "G"},
        {"globally", "G"},   {"finally", "F"},   {"TRUE", "true"},  {"True", "true"},
        {"eventually", "F"}, {"FALSE", "false"}, {"False", "false"}};
    for (const auto& [theirs, ours] : foreign) {
      if (token.kind == Token::Kind::quoted || token.text != theirs) continue;
      tokens_.fail(fmt::format("'{}' is no sign here: it is '{}'", theirs, ours), token);
    }
    tokens_.fail_foreign(token);
  }

  bool accept_either(std::string_view one, std::string_view other) {
    return tokens_.accept(one) || tokens_.accept(other);
  }

  Formula parse_equivalence() { return formula_of(parse_operand()); }

  // All operators, so that brackets may stand around either kind.
  Operand parse_operand() {
    deeper();
    Operand left = parse_implication();
    while (tokens_.accept("<->")) {
      left = {
          make(Operator::equivalence, formula_of(left), formula_of(parse_implication())), {}, {}};
    }
    --nesting_;
    return left;
  }

  Operand parse_implication() {
    deeper();
    Operand left = parse_disjunction();
    if (tokens_.accept("->")) {
      const Formula condition = formula_of(left);
      left = {make(Operator::implication, condition, formula_of(parse_implication())), {}, {}};
    }
    --nesting_;
    return left;
  }

  Operand parse_disjunction() {
    Operand left = parse_conjunction();
    while (accept_either("||", "|")) {
      const Formula first = formula_of(left);
      left = {make(Operator::disjunction, first, formula_of(parse_conjunction())), {}, {}};
    }
    return left;
  }

  Operand parse_conjunction() {
    Operand left = parse_until();
    while (accept_either("&&", "&")) {
      const Formula first = formula_of(left);
      left = {make(Operator::conjunction, first, formula_of(parse_until())), {}, {}};
    }
    return left;
  }

  Operand parse_until() {
    deeper();
    Operand left = parse_unary();
    for (const auto& [word, op] :
         {std::pair("U", Operator::until), {"R", Operator::release}, {"W", Operator::weak_until}}) {
      if (tokens_.accept(word)) {
        const Formula first = formula_of(left);
        left = {make(op, first, formula_of(parse_until())), {}, {}};
        break;
      }
    }
    --nesting_;
    return left;
  }

  Operand parse_unary() {
    deeper();
    Operand result;
    if (tokens_.accept("!")) {
      result = {make(Operator::negation, formula_of(parse_unary())), {}, {}};
    } else if (tokens_.accept("[]") || accept_word("G")) {
      result = {make(Operator::globally, formula_of(parse_unary())), {}, {}};
    } else if (tokens_.accept("<>") || accept_word("F")) {
      result = {make(Operator::finally, formula_of(parse_unary())), {}, {}};
    } else if (accept_word("X")) {
      result = {make(Operator::next, formula_of(parse_unary())), {}, {}};
    } else {
      result = parse_comparison();
    }
    --nesting_;
    return result;
  }

  bool accept_word(std::string_view word) {
    if (tokens_.peek(1).is("@") || tokens_.peek(1).is(".") || tokens_.peek(1).is(":")) return false;
    return tokens_.accept(word);
  }

  // ---- expressions -----------------------------------------------------------------------------

  Formula formula_of(const Operand& operand) {
    if (operand.formula) return operand.formula;
    const Expression& expression = *operand.expression;
    if (expression.kind != ValueKind::boolean) {
      tokens_.fail("expected what is true or false, and this is " + to_string(expression.kind) +
                       ": compare it",
                   operand.first);
    }
    if (expression.is_constant()) {
      return make(expression.value != 0 ? Operator::truth : Operator::falsity, nullptr);
    }
    if (expressions_ == nullptr) tokens_.fail("there are no variables here", operand.first);
    expressions_->push_back(expression);
    return make_atom({Atom::Kind::expression, static_cast<std::uint32_t>(expressions_->size() - 1),
                      0, Atom::any_program},
                     operand.first);
  }

  Expression expression_of(const Operand& operand) {
    if (operand.expression) return *operand.expression;
    tokens_.fail("expected an expression over variables, not a formula", operand.first);
  }

  using Level = Operand (Parser::*)();
  // Operands of `next`, joined by operators of the same strength, from the left.
  Operand parse_level(Level next,
                      std::span<const std::pair<std::string_view, Expression::Operator>> level) {
    Operand left = (this->*next)();
    for (bool goes_on = true; goes_on;) {
      goes_on = false;
      for (const auto& [symbol, op] : level) {
        if (!tokens_.peek().is(symbol)) continue;
        const SourcePosition place = tokens_.position(tokens_.next());
        Expression first = expression_of(left);
        const Operand right = (this->*next)();
        left = {nullptr, make_binary(op, std::move(first), expression_of(right), place),
                left.first};
        goes_on = true;
        break;
      }
    }
    return left;
  }

  Operand parse_comparison() {
    using enum Expression::Operator;
    static constexpr std::pair<std::string_view, Expression::Operator> level[] = {
        {"==", equal},    {"!=", unequal}, {"<=", at_most},
        {">=", at_least}, {"<", less},     {">", greater}};
    return parse_level(&Parser::parse_sum, level);
  }
  Operand parse_sum() {
    using enum Expression::Operator;
    static constexpr std::pair<std::string_view, Expression::Operator> level[] = {{"+", plus},
                                                                                  {"-", minus}};
    return parse_level(&Parser::parse_product, level);
  }
  Operand parse_product() {
    using enum Expression::Operator;
    static constexpr std::pair<std::string_view, Expression::Operator> level[] = {
        {"*", times}, {"/", divide}, {"%", remainder}};
    return parse_level(&Parser::parse_primary, level);
  }

  std::optional<Expression> constant_of(const std::string& name) const {
    for (std::size_t i = 0; i < indices_.size() && i < values_.size(); ++i) {
      if (indices_[i] == name) return make_constant(values_[i], ValueKind::integer);
    }
    if (scope_.names == nullptr) return std::nullopt;
    const auto place = scope_.names->constants.find(name);
    if (place == scope_.names->constants.end()) return std::nullopt;
    return place->second;
  }

  Expression find_constant(const Token& name) {
    if (const auto constant = constant_of(name.text)) return *constant;
    tokens_.fail("unknown constant '" + name.text + "'", name);
  }

  const ModelName* find_model(const std::string& name) const {
    if (scope_.names == nullptr) return nullptr;
    const auto place = scope_.names->models.find(name.substr(0, name.find('[')));
    return place == scope_.names->models.end() ? nullptr : &place->second;
  }
  bool is_topic(const std::string& name) const {
    const ModelName* const model = find_model(name);
    return model != nullptr && model->is_topic;
  }
  bool is_service(const std::string& name) const {
    const ModelName* const model = find_model(name);
    return model != nullptr && !model->is_topic && scope_.names->services.contains(model->first);
  }

  // "[logger]" behind a topic's name: its reader's model.
  std::string parse_reader(const std::string& topic) {
    if (!is_topic(topic) || !tokens_.peek().is("[")) return "";
    tokens_.next();
    const Token reader = tokens_.next();
    if (!reader.is_name()) tokens_.fail("expected a reader of " + topic, reader);
    std::string suffix = "[" + reader.text + parse_suffix();
    if (tokens_.accept(".")) suffix += "." + tokens_.next().text;
    suffix += "]";
    tokens_.expect("]", "behind a reader");
    return suffix;
  }

  // "[2,0]" behind a name, its indices being known at once; "" if there are none. A name there is
  // one of a topic's readers unless it is a constant.
  std::string parse_suffix() {
    if (!tokens_.peek().is("[")) return "";
    if (tokens_.peek(1).is_name() && !constant_of(tokens_.peek(1).text)) return "";
    tokens_.next();
    std::string suffix;
    ExpressionParser numbers(tokens_, [this](const Token& name) { return find_constant(name); });
    do {
      suffix += (suffix.empty() ? "[" : ",") + std::to_string(numbers.parse_constant("an index"));
    } while (tokens_.accept(","));
    tokens_.expect("]", "behind an index");
    return suffix + "]";
  }

  Operand parse_primary() {
    const Token token = tokens_.next();
    if (token.is("(")) {
      Operand inner = parse_operand();
      inner.first = token;
      if (!tokens_.accept(")")) {
        fail_foreign(tokens_.peek());
        tokens_.fail("expected ')' for this '(', not " + to_string(tokens_.peek()) + " at " +
                         to_string(tokens_.position(tokens_.peek())),
                     token);
      }
      return inner;
    }
    const SourcePosition place = tokens_.position(token);
    if (token.is("-")) {
      deeper();
      const Operand operand = parse_primary();
      --nesting_;
      return {nullptr, make_unary(Expression::Operator::negate, expression_of(operand), place),
              token};
    }
    if (token.kind == Token::Kind::number) {
      return {nullptr, make_constant(parse_integer(tokens_, token), ValueKind::integer), token};
    }
    if (!token.is_name()) {
      fail_foreign(token);
      tokens_.fail("expected a formula, not " + to_string(token), token);
    }
    const Token& next = tokens_.peek();
    const bool names_owner = next.is("@") || next.is(".") || next.is("!") || next.is(":");
    if ((token.is("true") || token.is("false")) && !names_owner) {
      return {nullptr, make_constant(token.is("true") ? 1 : 0, ValueKind::boolean), token};
    }
    if (!names_owner) {
      if (const auto variable = parse_variable(token)) return {nullptr, *variable, token};
      if (!tokens_.peek().is("[")) fail_foreign(token);
    }
    return parse_owned(token);
  }

  // A variable or constant of the file, or a word; none if the name is none of them.
  std::optional<Expression> parse_variable(const Token& name) {
    if (auto constant = constant_of(name.text)) return constant;
    if (scope_.names == nullptr) return std::nullopt;
    if (auto variable = parse_variable_named(name.text, name)) return variable;
    if (tokens_.peek().is("[")) return std::nullopt;
    if (const auto word = scope_.words->find(name.text)) {
      return make_constant(*word, ValueKind::word);
    }
    return std::nullopt;
  }

  // Of the file, or "node.variable".
  std::optional<Expression> parse_variable_named(const std::string& whole, const Token& name) {
    const auto place = scope_.names->variables.find(whole);
    if (place == scope_.names->variables.end()) return std::nullopt;
    Expression leaf = place->second.leaf;
    ExpressionParser numbers(tokens_, [this](const Token& index) { return find_constant(index); });
    leaf.operands = numbers.parse_indices(leaf.dimensions, name);
    return leaf;
  }

  // program@label, program.variable, model.input, model!output, program:model.input.
  Operand parse_owned(const Token& token) {
    Token owner = token;
    owner.text += parse_suffix();
    owner.text += parse_reader(token.text);
    const Token separator = tokens_.next();
    if (separator.is(":")) return parse_of_program(owner);
    if (!separator.is("@") && !separator.is(".") && !separator.is("!")) {
      tokens_.fail("expected program@label, model.input or model!output, not " + to_string(owner) +
                       " alone: no variable, constant or word has this name",
                   owner);
    }
    Token name = parse_name_behind(separator);
    if (scope_.names != nullptr && scope_.names->nodes.contains(owner.text)) {
      if (separator.is(".") && !tokens_.peek().is("@")) {
        const auto variable = parse_variable_named(owner.text + "." + name.text, name);
        if (variable) return {nullptr, *variable, owner};
        tokens_.fail("node " + owner.text + " has no variable '" + name.text + "'", name);
      }
      if (separator.is(".")) {
        owner.text += "." + name.text;
        tokens_.next();
        name = tokens_.next();
      }
      return {find_node_label(owner, name), {}, owner};
    }
    if (separator.is("@")) return {make_atom(find_label(owner, name), owner), {}, owner};
    if (separator.is(".") && find_program(owner.text)) {
      name.text += parse_suffix();
      return {nullptr, find_variable(*find_program(owner.text), name), owner};
    }
    return {find_event(owner, name, separator.is("."), Atom::any_program), {}, owner};
  }

  Token parse_name_behind(const Token& separator) {
    Token name = tokens_.next();
    if (name.is_name()) return name;
    tokens_.fail("expected a name after '" + separator.text + "', not " + to_string(name), name);
  }

  Operand parse_of_program(const Token& program) {
    const auto index = find_program(program.text);
    if (!index || !scope_.programs[*index].nodes.empty()) fail_unknown_program(program, false);
    Token owner = tokens_.next();
    if (!owner.is_name()) tokens_.fail("expected a model, not " + to_string(owner), owner);
    const std::string model = owner.text;
    owner.text += parse_suffix();
    owner.text += parse_reader(model);
    const Token separator = tokens_.next();
    if (!separator.is(".") && !separator.is("!")) {
      tokens_.fail("expected model.input or model!output behind a program and ':'", separator);
    }
    const Token name = parse_name_behind(separator);
    return {find_event(owner, name, separator.is("."), *index), {}, program};
  }

  std::optional<std::uint32_t> find_program(const std::string& name) const {
    for (std::uint32_t index = 0; index < scope_.programs.size(); ++index) {
      if (scope_.programs[index].name == name) return index;
    }
    return std::nullopt;
  }

  // `or_node`: a node would do.
  [[noreturn]] void fail_unknown_program(const Token& owner, bool or_node) {
    std::vector<std::string> known;
    for (const Program& program : scope_.programs) {
      if (program.nodes.empty()) known.push_back(program.name);
    }
    or_node = or_node && scope_.names != nullptr && !scope_.names->nodes.empty();
    if (or_node) {
      known.insert(known.end(), scope_.names->nodes.begin(), scope_.names->nodes.end());
    }
    tokens_.fail("unknown program " + std::string(or_node ? "or node '" : "'") + owner.text +
                     "'; there is: " + known_instead(owner.text, known),
                 owner);
  }

  Expression find_variable(std::uint32_t owner, const Token& name) {
    const Program& program = scope_.programs[owner];
    std::optional<Expression> found;
    std::vector<std::string> known;
    for (std::uint32_t index = 0; index < program.variables.size(); ++index) {
      const ProgramVariable& variable = program.variables[index];
      if (std::find(known.begin(), known.end(), variable.name) == known.end()) {
        known.push_back(variable.name);
      }
      if (variable.name != name.text) continue;
      if (found) {
        tokens_.fail("program " + program.name + " has several variables '" + name.text +
                         "': give them names of their own",
                     name);
      }
      found.emplace();
      found->op = Expression::Operator::local;
      found->kind = variable.type.kind;
      found->owner = owner;
      found->index = index;
      found->name = program.name + "." + name.text;
    }
    if (found) return *found;
    tokens_.fail("program " + program.name + " has no variable '" + name.text +
                     "'; it has: " + known_instead(name.text, known),
                 name);
  }

  // Of a node, or of one of its callbacks: in any of the programs that run it.
  Formula find_node_label(const Token& owner, const Token& name) {
    Formula any;
    std::vector<std::string> known;
    for (std::uint32_t index = 0; index < scope_.programs.size(); ++index) {
      const std::vector<std::string>& labels = scope_.programs[index].labels;
      for (std::uint32_t label = 0; label < labels.size(); ++label) {
        const std::size_t at = labels[label].find('@');
        if (at == std::string::npos) continue;
        const std::string callback = labels[label].substr(0, at);
        if (callback != owner.text && !callback.starts_with(owner.text + ".")) continue;
        known.push_back(labels[label].substr(at + 1));
        if (known.back() != name.text) continue;
        const Formula atom = make_atom({Atom::Kind::label, index, label}, owner);
        any = any ? make(Operator::disjunction, any, atom) : atom;
      }
    }
    if (any) return any;
    tokens_.fail(owner.text + " has no label '" + name.text +
                     "'; it has: " + known_instead(name.text, known),
                 name);
  }

  Atom find_label(const Token& owner, const Token& name) {
    const auto index = find_program(owner.text);
    if (!index || !scope_.programs[*index].nodes.empty()) fail_unknown_program(owner, true);
    const Program& program = scope_.programs[*index];
    if (name.text == "end") return {Atom::Kind::end, *index, 0};
    const auto place = std::find(program.labels.begin(), program.labels.end(), name.text);
    if (place == program.labels.end()) {
      std::vector<std::string> known = program.labels;
      known.emplace_back("end");
      tokens_.fail("program " + owner.text + " has no label '" + name.text +
                       "'; it has: " + known_instead(name.text, known),
                   name);
    }
    return {Atom::Kind::label, *index, static_cast<std::uint32_t>(place - program.labels.begin())};
  }

  // "(3,go)" behind a name; "" if there are no values.
  std::string parse_values() {
    std::string text;
    if (!tokens_.accept("(")) return text;
    while (!tokens_.peek().is(")")) {
      const Token part = tokens_.next();
      if (part.kind == Token::Kind::end) tokens_.fail("this '(' is not closed", part);
      const auto constant = part.is_name() ? constant_of(part.text) : std::nullopt;
      text += constant ? to_string(constant->value, constant->kind, *scope_.words) : part.text;
    }
    tokens_.next();
    return "(" + text + ")";
  }

  // A name without values is any of them, and a topic's any of its readers' models.
  Formula find_event(const Token& owner, const Token& name, bool is_input, std::uint32_t program) {
    const Atom::Kind kind = is_input ? Atom::Kind::input : Atom::Kind::output;
    const bool is_any_reader = is_topic(owner.text);
    const std::string text = name.text + parse_values();
    Formula any;
    const ProgramInterface* found = nullptr;
    for (std::uint32_t index = 0; index < scope_.models.size(); ++index) {
      const ProgramInterface& model = scope_.models[index];
      const bool is_reader = is_any_reader && model.name.starts_with(owner.text + "[");
      if (model.name != owner.text && !is_reader && !is_reader_of(model.name, owner.text)) continue;
      found = &model;
      const Alphabet& alphabet = is_input ? *model.inputs : *model.outputs;
      for (Symbol symbol = 0; symbol < alphabet.size(); ++symbol) {
        const std::string& known = alphabet.name(symbol);
        const bool is_at_client = is_service(owner.text) && is_numbered(known, text);
        if (known != text && !known.starts_with(text + "(") && !is_at_client) continue;
        const Formula atom = make_atom({kind, index, symbol, program}, owner);
        any = any ? make(Operator::disjunction, any, atom) : atom;
      }
    }
    if (any) return any;
    if (found != nullptr) {
      const Alphabet& alphabet = is_input ? *found->inputs : *found->outputs;
      tokens_.fail("model " + owner.text + " has no " + (is_input ? "input '" : "output '") + text +
                       "'; it has: " + known_instead(text, alphabet.names()),
                   name);
    }
    std::vector<std::string> known;
    for (const ProgramInterface& model : scope_.models) known.push_back(model.name);
    const bool has_nodes = scope_.names != nullptr && !scope_.names->nodes.empty();
    if (has_nodes) {
      known.insert(known.end(), scope_.names->nodes.begin(), scope_.names->nodes.end());
    }
    tokens_.fail("unknown model " + std::string(has_nodes ? "or node '" : "'") + owner.text +
                     "'; there is: " + known_instead(owner.text, known),
                 owner);
  }

  const ScalarText& text_;
  TokenStream tokens_;
  const FormulaScope& scope_;
  std::vector<Expression>* expressions_;
  std::vector<std::string> indices_;
  std::vector<Value> values_;  // of the indices
  int nesting_ = 0, size_ = 0;
};

}  // namespace

Formula parse_formula(const ScalarText& text, const FormulaScope& scope,
                      std::vector<Expression>* expressions) {
  return Parser(text, scope, expressions).parse();
}

std::vector<FormulaInstance> parse_formulas(const ScalarText& text, const FormulaScope& scope,
                                            std::vector<Expression>* expressions) {
  std::vector<FormulaInstance> result;
  const Dimensions dimensions = Parser(text, scope, expressions).parse_quantifier();
  for (std::uint64_t member = 0; member < member_count(dimensions); ++member) {
    Parser parser(text, scope, expressions);
    parser.parse_quantifier();
    parser.set_indices(member_indices(dimensions, member));
    result.push_back({member_suffix(dimensions, member), parser.parse()});
  }
  return result;
}

}  // namespace maide
