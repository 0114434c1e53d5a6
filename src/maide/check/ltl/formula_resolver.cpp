// From the syntax tree of a formula to one over atoms: names have their meaning in a system. A name
// may be a variable, a constant, a word, or the begin of `program@label`, `model.input`,
// `model!output`; which of them shows here, for the tree does not know.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "maide/base/text.hpp"
#include "maide/check/language/code_parser.hpp"
#include "maide/check/language/term_parser.hpp"
#include "maide/check/ltl/formula.hpp"
#include "maide/check/text/tokens.hpp"

namespace maide {
namespace {

using Operator = FormulaNode::Operator;
using syntax::Sign;
using syntax::Term;

constexpr int max_size = 2000;
constexpr double max_expanded_size = 10'000;  // of the normal form, in which each <-> doubles

// A formula, or an expression that is one if it is true or false.
struct Operand {
  Formula formula;
  std::optional<Expression> expression;
  TextPlace begin;
};

// The operator of formulas that the sign is; none of a sign of expressions alone.
std::optional<Operator> formula_operator(Sign sign) {
  switch (sign) {
    case Sign::negation: return Operator::negation;
    case Sign::conjunction: return Operator::conjunction;
    case Sign::disjunction: return Operator::disjunction;
    case Sign::implication: return Operator::implication;
    case Sign::equivalence: return Operator::equivalence;
    case Sign::next: return Operator::next;
    case Sign::finally: return Operator::finally;
    case Sign::globally: return Operator::globally;
    case Sign::until: return Operator::until;
    case Sign::release: return Operator::release;
    case Sign::weak_until: return Operator::weak_until;
    default: return std::nullopt;
  }
}

class FormulaResolver {
 public:
  FormulaResolver(const syntax::Formula& formula, const FormulaScope& scope,
                  std::vector<Expression>* expressions)
      : from_(formula), scope_(scope), expressions_(expressions) {}

  // The ranges of `forall`; none without it.
  Dimensions quantifier() {
    Dimensions dimensions;
    for (const syntax::Index& index : from_.indices) dimensions.push_back(range(index.range));
    if (member_count(dimensions) > max_array_members) {
      fail("'forall' has too many instances", from_.begin);
    }
    return dimensions;
  }

  // With these values of the indices.
  Formula resolve(const std::vector<Value>& values) {
    values_ = values;
    Formula formula = formula_of(operand(from_.root));
    if (expanded_size(formula) > max_expanded_size) {
      fail("the formula is too large: each <-> and W doubles what stands around it", from_.begin);
    }
    return formula;
  }

 private:
  SourcePosition position(TextPlace place) const { return {from_.file, place.line, place.column}; }
  [[noreturn]] void fail(const std::string& message, TextPlace place) const {
    throw ParseError(message, position(place));
  }

  // ---- Formulas ---------------------------------------------------------------------------------

  Formula make(Operator op, Formula left, Formula right, TextPlace place) {
    if (++size_ > max_size) fail("the formula is too large", place);
    return make_formula(op, std::move(left), std::move(right));
  }
  Formula make_atom(const Atom& atom, TextPlace place) {
    if (++size_ > max_size) fail("the formula is too large", place);
    return make_formula(atom);
  }

  Operand operand(const Term& term) {
    switch (term.kind) {
      case Term::Kind::number:
        return {nullptr, make_constant(term.value, ValueKind::integer), term.begin};
      case Term::Kind::boolean:
        return {nullptr, make_constant(term.value, ValueKind::boolean), term.begin};
      case Term::Kind::name: return named(term);
      case Term::Kind::operation: break;
    }
    if (const auto op = formula_operator(term.sign)) {
      Formula left = formula_of(operand(term.operands[0]));
      Formula right = term.operands.size() == 1 ? nullptr : formula_of(operand(term.operands[1]));
      return {make(*op, std::move(left), std::move(right), term.place), {}, term.begin};
    }
    const Expression::Operator op = operator_of(term.sign).value();
    Expression left = expression_of(operand(term.operands[0]));
    if (term.operands.size() == 1) {
      return {nullptr, make_unary(op, std::move(left), position(term.place)), term.begin};
    }
    Expression right = expression_of(operand(term.operands[1]));
    return {nullptr, make_binary(op, std::move(left), std::move(right), position(term.place)),
            term.begin};
  }

  Formula formula_of(const Operand& operand) {
    if (operand.formula) return operand.formula;
    const Expression& expression = *operand.expression;
    if (expression.kind != ValueKind::boolean && expression.kind != ValueKind::unknown) {
      fail("expected what is true or false, and this is " + to_string(expression.kind) +
               ": compare it",
           operand.begin);
    }
    if (expression.is_constant()) {
      return make(expression.value != 0 ? Operator::truth : Operator::falsity, nullptr, nullptr,
                  operand.begin);
    }
    if (expressions_ == nullptr) fail("there are no variables here", operand.begin);
    expressions_->push_back(expression);
    return make_atom({Atom::Kind::expression, static_cast<std::uint32_t>(expressions_->size() - 1),
                      0, Atom::any_program},
                     operand.begin);
  }

  Expression expression_of(const Operand& operand) const {
    if (operand.expression) return *operand.expression;
    fail("expected an expression over variables, not a formula", operand.begin);
  }

  // ---- Constants and indices --------------------------------------------------------------------

  std::optional<Expression> constant_of(const std::string& name) const {
    for (std::size_t i = 0; i < from_.indices.size() && i < values_.size(); ++i) {
      if (from_.indices[i].name.text == name) return make_constant(values_[i], ValueKind::integer);
    }
    if (scope_.names == nullptr) return std::nullopt;
    const auto place = scope_.names->constants.find(name);
    if (place == scope_.names->constants.end()) return std::nullopt;
    return place->second;
  }

  // Where a word may stand, too.
  std::optional<Expression> constant_as_value(const syntax::Name& name) const {
    return name.may_be_constant() ? constant_of(name.text) : std::nullopt;
  }

  // An expression in which all names are those of constants.
  Expression expression_of_constants(const Term& term) const {
    if (term.is_name()) {
      auto constant = constant_of(term.name.text);
      if (!constant) fail("unknown constant '" + term.name.text + "'", term.place);
      if (term.has_indices) fail("'" + term.name.text + "' is no array", term.place);
      constant->line = term.place.line;
      constant->column = term.place.column;
      return *constant;
    }
    if (term.kind != Term::Kind::operation) {
      return make_constant(
          term.value, term.kind == Term::Kind::boolean ? ValueKind::boolean : ValueKind::integer);
    }
    const Expression::Operator op = operator_of(term.sign).value();
    Expression left = expression_of_constants(term.operands[0]);
    if (term.operands.size() == 1) return make_unary(op, std::move(left), position(term.place));
    return make_binary(op, std::move(left), expression_of_constants(term.operands[1]),
                       position(term.place));
  }
  Value number(const Term& term, std::string_view what) const {
    const Expression value = expression_of_constants(term);
    require(value, ValueKind::integer, what, position(term.begin));
    if (value.is_constant()) return value.value;
    fail(std::string(what) + " is made of numbers, constants and indices of arrays alone",
         term.begin);
  }
  Expression::Dimension range(const syntax::Range& range) const {
    constexpr std::string_view what = "a bound of 'forall'";
    const Expression::Dimension made{number(range.low, what), number(range.high, what)};
    if (made.low <= made.high) return made;
    fail(fmt::format("{} goes from the least to the greatest, and {} is greater than {}", what,
                     made.low, made.high),
         range.low.begin);
  }

  // "[2,0]", the indices being known at once; "" of none.
  std::string suffix_of(const std::vector<Term>& indices) const {
    std::string suffix;
    for (const Term& index : indices) {
      suffix += (suffix.empty() ? "[" : ",") + std::to_string(number(index, "an index"));
    }
    return suffix.empty() ? suffix : suffix + "]";
  }

  // ---- Names ------------------------------------------------------------------------------------

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

  // A name in brackets behind a service is one of its clients: "lookup[planner]".
  std::optional<std::uint32_t> client_of(const std::string& owner,
                                         const std::vector<Term>& brackets) const {
    if (!is_service(owner) || brackets.size() != 1 || !brackets.front().is_name()) return {};
    const std::vector<End>& clients = scope_.names->services.at(find_model(owner)->first).clients;
    const std::string& name = brackets.front().name.text;
    for (std::uint32_t client = 0; client < clients.size(); ++client) {
      const End& end = clients[client];
      if ((end.node.empty() ? scope_.programs[end.program].name : end.node) == name) return client;
    }
    return std::nullopt;
  }

  // A name in brackets is one of a topic's readers unless it is a constant.
  bool is_reader(const std::string& owner, const std::vector<Term>& brackets) const {
    return is_topic(owner) && brackets.size() == 1 && brackets.front().is_name() &&
           !constant_as_value(brackets.front().name);
  }
  // "[logger]", "[detector[0].on_image]".
  std::string reader_of(const std::vector<Term>& brackets) const {
    const Term& reader = brackets.front();
    std::string text = "[" + reader.name.text + suffix_of(reader.operands);
    for (const syntax::NamePart& part : reader.parts) text += "." + part.name.text;
    return text + "]";
  }
  // The name with its indices, and of a topic the reader.
  std::string whole_name(const syntax::Name& name, const std::vector<Term>& indices,
                         const std::vector<Term>& reader) const {
    std::string whole = name.text;
    if (is_reader(name.text, indices)) return whole + reader_of(indices);
    if (client_of(name.text, indices)) return whole + "[" + indices.front().name.text + "]";
    whole += suffix_of(indices);
    if (reader.empty()) return whole;
    if (is_reader(name.text, reader)) return whole + reader_of(reader);
    fail("what stands in these brackets is no reader of " + name.text, reader.front().begin);
  }

  Operand named(const Term& term) {
    if (term.parts.empty()) {
      if (auto variable = variable_or_word(term)) return {nullptr, std::move(variable), term.begin};
    }
    return owned(term);
  }

  // A variable or constant of the file, or a word; none if the name is none of them.
  std::optional<Expression> variable_or_word(const Term& term) const {
    if (auto constant = constant_as_value(term.name)) return constant;
    if (scope_.names == nullptr) return std::nullopt;
    if (auto variable = variable_named(term.name.text, term)) return variable;
    if (term.has_indices) return std::nullopt;
    if (const auto word = scope_.words->find(term.name.text)) {
      return make_constant(*word, ValueKind::word);
    }
    return std::nullopt;
  }

  // A variable of the file, or "node.variable"; `indices` has its indices.
  std::optional<Expression> variable_named(const std::string& whole, const Term& indices) const {
    const auto place = scope_.names->variables.find(whole);
    if (place == scope_.names->variables.end()) return std::nullopt;
    Expression leaf = place->second.leaf;
    const Dimensions& dimensions = leaf.dimensions;
    const std::string& name = indices.name.text;
    if (dimensions.empty()) {
      if (indices.has_indices) fail("'" + name + "' is no array", indices.place);
      return leaf;
    }
    if (!indices.has_indices) {
      fail("'" + name + "' is an array: say which member, as in " + name +
               member_suffix(dimensions, 0),
           indices.place);
    }
    for (const Term& index : indices.operands) {
      leaf.operands.push_back(expression_of_constants(index));
      require(leaf.operands.back(), ValueKind::integer, "an index", position(index.begin));
    }
    if (leaf.operands.size() != dimensions.size()) {
      fail(fmt::format("'{}' has {} {}, not {}", name, dimensions.size(),
                       dimensions.size() == 1 ? "index" : "indices", leaf.operands.size()),
           indices.place);
    }
    return leaf;
  }

  // program@label, program.variable, model.input, model!output, program:model.input.
  Operand owned(const Term& term) {
    const syntax::Name owner{whole_name(term.name, term.operands, term.reader), false, term.place};
    if (term.parts.empty()) {
      const std::string_view sign = syntax::own_sign_of_formulas(term.name.text);
      if (!sign.empty() && !term.name.is_quoted) {
        fail(fmt::format("'{}' is no sign here: it is '{}'", term.name.text, sign), term.place);
      }
      fail("expected program@label, model.input or model!output, not '" + owner.text +
               "' alone: no variable, constant or word has this name",
           term.place);
    }
    const syntax::NamePart& part = term.parts.front();
    if (part.sign == ':') return of_program(owner, term);
    if (scope_.names != nullptr && scope_.names->nodes.contains(owner.text)) {
      return of_node(owner, term);
    }
    if (part.sign == '.' && part.name.is("there") && names_service(term.name.text)) {
      check_last(term, 1);
      auto variable = variable_named(presence_of(term.name.text), term);
      if (!variable) variable = make_constant(1, ValueKind::boolean);  // it is so from the begin
      return {nullptr, std::move(variable), owner.place};
    }
    check_last(term, 1);
    if (part.sign == '@')
      return {make_atom(find_label(owner, part.name), owner.place), {}, owner.place};
    if (part.sign == '.' && find_program(owner.text)) {
      syntax::Name name = part.name;
      name.text += suffix_of(part.indices);
      return {nullptr, find_variable(*find_program(owner.text), name), owner.place};
    }
    return {find_event(owner, part, Atom::any_program), {}, owner.place};
  }

  // Behind that many parts nothing follows.
  void check_last(const Term& term, std::size_t count) const {
    if (term.parts.size() <= count) return;
    const syntax::NamePart& part = term.parts[count];
    fail(fmt::format("nothing may follow here, and there is '{}{}'", part.sign, part.name.text),
         part.name.place);
  }

  bool names_service(const std::string& name) const {
    if (scope_.names == nullptr) return false;
    const auto model = scope_.names->models.find(name);
    return model != scope_.names->models.end() && !model->second.is_topic &&
           scope_.names->services.contains(model->second.first);
  }

  Operand of_node(const syntax::Name& node, const Term& term) {
    const syntax::NamePart& part = term.parts.front();
    const bool has_label = term.parts.size() > 1 && term.parts[1].sign == '@';
    if (part.sign == '.' && !has_label) {
      check_last(term, 1);
      Term indices;
      indices.name = part.name;
      indices.place = part.name.place;
      indices.has_indices = part.has_indices;
      indices.operands = part.indices;
      auto variable = variable_named(node.text + "." + part.name.text, indices);
      if (variable) return {nullptr, std::move(variable), node.place};
      fail("node " + node.text + " has no variable '" + part.name.text + "'", part.name.place);
    }
    check_last(term, part.sign == '.' ? 2 : 1);
    if (part.sign != '.') return {find_node_label(node, part.name), {}, node.place};
    const syntax::Name callback{node.text + "." + part.name.text, false, node.place};
    return {find_node_label(callback, term.parts[1].name), {}, node.place};
  }

  Operand of_program(const syntax::Name& program, const Term& term) {
    const auto index = find_program(program.text);
    if (!index || !scope_.programs[*index].nodes.empty()) fail_unknown_program(program, false);
    const syntax::NamePart& model = term.parts.front();
    const bool is_event =
        term.parts.size() > 1 && (term.parts[1].sign == '.' || term.parts[1].sign == '!');
    if (!is_event) {
      fail("expected model.input or model!output behind a program and ':'", model.name.place);
    }
    check_last(term, 2);
    const syntax::Name owner{whole_name(model.name, model.indices, model.reader), false,
                             model.name.place};
    return {find_event(owner, term.parts[1], *index), {}, program.place};
  }

  std::optional<std::uint32_t> find_program(const std::string& name) const {
    for (std::uint32_t index = 0; index < scope_.programs.size(); ++index) {
      if (scope_.programs[index].name == name) return index;
    }
    return std::nullopt;
  }

  // `or_node`: a node would do.
  [[noreturn]] void fail_unknown_program(const syntax::Name& owner, bool or_node) {
    std::vector<std::string> known;
    for (const Program& program : scope_.programs) {
      if (program.nodes.empty()) known.push_back(program.name);
    }
    or_node = or_node && scope_.names != nullptr && !scope_.names->nodes.empty();
    if (or_node) {
      known.insert(known.end(), scope_.names->nodes.begin(), scope_.names->nodes.end());
    }
    fail("unknown program " + std::string(or_node ? "or node '" : "'") + owner.text +
             "'; there is: " + known_instead(owner.text, known),
         owner.place);
  }

  Expression find_variable(std::uint32_t owner, const syntax::Name& name) {
    const Program& program = scope_.programs[owner];
    std::optional<Expression> found;
    std::vector<std::string> known;
    for (std::uint32_t index = 0; index < program.variables.size(); ++index) {
      const ProgramVariable& variable = program.variables[index];
      if (std::ranges::find(known, variable.name) == known.end()) {
        known.push_back(variable.name);
      }
      if (variable.name != name.text) continue;
      if (found) {
        fail("program " + program.name + " has several variables '" + name.text +
                 "': give them names of their own",
             name.place);
      }
      found.emplace();
      found->op = Expression::Operator::local;
      found->kind = variable.type.kind;
      found->owner = owner;
      found->index = index;
      found->name = program.name + "." + name.text;
    }
    if (found) return *found;
    fail("program " + program.name + " has no variable '" + name.text +
             "'; it has: " + known_instead(name.text, known),
         name.place);
  }

  // A label of a node, or of one of its callbacks, in any of the programs that run it.
  Formula find_node_label(const syntax::Name& owner, const syntax::Name& name) {
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
        const Formula atom = make_atom({Atom::Kind::label, index, label}, owner.place);
        any = any ? make(Operator::disjunction, any, atom, owner.place) : atom;
      }
    }
    if (any) return any;
    fail(owner.text + " has no label '" + name.text +
             "'; it has: " + known_instead(name.text, known),
         name.place);
  }

  Atom find_label(const syntax::Name& owner, const syntax::Name& name) {
    const auto index = find_program(owner.text);
    if (!index || !scope_.programs[*index].nodes.empty()) fail_unknown_program(owner, true);
    const Program& program = scope_.programs[*index];
    if (name.text == "end") return {Atom::Kind::end, *index, 0};
    const auto place = std::ranges::find(program.labels, name.text);
    if (place == program.labels.end()) {
      std::vector<std::string> known = program.labels;
      known.emplace_back("end");
      fail("program " + owner.text + " has no label '" + name.text +
               "'; it has: " + known_instead(name.text, known),
           name.place);
    }
    return {Atom::Kind::label, *index, static_cast<std::uint32_t>(place - program.labels.begin())};
  }

  // "(3,go)" behind a name; "" if there are no values.
  std::string values_of(const syntax::NamePart& part) const {
    if (!part.has_values) return "";
    std::string text;
    for (const syntax::Name& value : part.values) {
      const auto constant = constant_as_value(value);
      text += constant ? to_string(constant->value, constant->kind, *scope_.words) : value.text;
    }
    return "(" + text + ")";
  }

  // A value of a type that the queue carries, though no program comes to write it: "write(3)".
  bool may_be_carried(const ProgramInterface& model, std::string_view text) const {
    if (scope_.names == nullptr || !text.ends_with(')')) return false;
    const std::string_view name = text.substr(0, text.find('('));
    const auto number = static_cast<std::uint32_t>(&model - scope_.models.data());
    const auto types = scope_.names->carried.find(number);
    if (types == scope_.names->carried.end() || (name != "write" && name != "message"))
      return false;
    text.remove_prefix(name.size() + 1);
    text.remove_suffix(1);
    const std::vector<std::string_view> values = split(text, ',');
    return std::ranges::equal(values, types->second, [&](auto value, const ValueType& type) {
      return is_of_type(value, type);
    });
  }
  // A step of what arrives late, where it arrives at once. `event`: of a service's client, too,
  // without its number.
  bool may_be_on_its_way(const ProgramInterface& model, const std::string& owner,
                         const std::string& event) const {
    if (is_service(owner.substr(0, owner.find('[')))) {
      return event == "request_arrives" || event == "request_lost" || event == "answer_arrives" ||
             event == "answer_lost";
    }
    if (event == "arrives" || event == "lost") return true;
    const std::size_t values = event.find('(');
    if (event.substr(0, values) != "arrives") return false;
    const std::string given = event.substr(values);
    return std::ranges::any_of(model.inputs->names(),
                               [&](const std::string& input) {
                                 return is_sending(input) && input.ends_with(given);
                               }) ||
           may_be_carried(model, "write" + given);
  }
  bool is_of_type(std::string_view value, const ValueType& type) const {
    if (type.kind == ValueKind::boolean) return value == "true" || value == "false";
    if (type.kind == ValueKind::integer) {
      Value number = 0;
      const auto [end, error] = std::from_chars(value.begin(), value.end(), number);
      return error == std::errc() && end == value.end() && type.contains(number);
    }
    return std::ranges::any_of(
        type.words, [&](Value word) { return to_string(word, type.kind, *scope_.words) == value; });
  }

  // Of "lookup[planner]" the service, and the event gets its name at that client:
  // "answer_arrives2".
  std::string service_of_client(const std::string& owner, std::string& event) const {
    const std::size_t bracket = owner.find('[');
    if (bracket == std::string::npos || !is_service(owner.substr(0, bracket))) return "";
    const std::string name = owner.substr(bracket + 1, owner.size() - bracket - 2);
    Term client;
    client.kind = Term::Kind::name;
    client.name.text = name;
    const auto number = client_of(owner.substr(0, bracket), {client});
    if (!number) return "";
    event = name_at_client(event, *number);
    return owner.substr(0, bracket);
  }

  // A name without values is any of them, and a topic's any of its readers' models.
  Formula find_event(const syntax::Name& owner, const syntax::NamePart& part,
                     std::uint32_t program) {
    const bool is_input = part.sign == '.';
    const Atom::Kind kind = is_input ? Atom::Kind::input : Atom::Kind::output;
    const bool is_any_reader = is_topic(owner.text);
    std::string text = part.name.text + values_of(part);
    const std::string event = text;
    const std::string service = service_of_client(owner.text, text);
    Formula any;
    bool is_late = false;
    const ProgramInterface* found = nullptr;
    for (std::uint32_t index = 0; index < scope_.models.size(); ++index) {
      const ProgramInterface& model = scope_.models[index];
      const bool is_reader = is_any_reader && model.name.starts_with(owner.text + "[");
      const bool is_wire = is_wire_to(model.name, owner.text);
      const bool is_other = model.name != owner.text && model.name != service && !is_reader &&
                            !is_wire && !is_reader_of(model.name, owner.text);
      if (is_other) continue;
      is_late = is_late || is_wire;
      if (model.name.find("<-") == std::string::npos) found = &model;
      const Alphabet& alphabet = is_input ? *model.inputs : *model.outputs;
      for (Symbol symbol = 0; symbol < alphabet.size(); ++symbol) {
        const std::string& known = alphabet.name(symbol);
        const bool is_at_client =
            service.empty() && is_service(owner.text) && is_numbered(known, text);
        if (known != text && !known.starts_with(text + "(") && !is_at_client) continue;
        const Formula atom = make_atom({kind, index, symbol, program}, owner.place);
        any = any ? make(Operator::disjunction, any, atom, owner.place) : atom;
      }
    }
    if (any) return any;
    if (found != nullptr) {
      if (!scope_.knows_models) return make_atom({kind, 0, 0, program}, owner.place);
      const bool is_way = !is_input && may_be_on_its_way(*found, owner.text, event);
      if (is_way && !is_late && scope_.at_once != nullptr) {
        scope_.at_once->push_back(owner.text + "!" + event);
      }
      if (is_way || may_be_carried(*found, text)) {
        return make(Operator::falsity, {}, {}, owner.place);
      }
      const Alphabet& alphabet = is_input ? *found->inputs : *found->outputs;
      fail("model " + owner.text + " has no " + (is_input ? "input '" : "output '") + text +
               "'; it has: " + known_instead(text, alphabet.names()),
           part.name.place);
    }
    std::vector<std::string> known;
    for (const ProgramInterface& model : scope_.models) known.push_back(model.name);
    const bool has_nodes = scope_.names != nullptr && !scope_.names->nodes.empty();
    if (has_nodes) {
      known.insert(known.end(), scope_.names->nodes.begin(), scope_.names->nodes.end());
    }
    fail("unknown model " + std::string(has_nodes ? "or node '" : "'") + owner.text +
             "'; there is: " + known_instead(owner.text, known),
         owner.place);
  }

  const syntax::Formula& from_;
  const FormulaScope& scope_;
  std::vector<Expression>* expressions_;
  std::vector<Value> values_;  // of the indices
  int size_ = 0;
};

}  // namespace

std::vector<FormulaInstance> resolve_formulas(const syntax::Formula& formula,
                                              const FormulaScope& scope,
                                              std::vector<Expression>* expressions) {
  std::vector<FormulaInstance> result;
  const Dimensions dimensions = FormulaResolver(formula, scope, expressions).quantifier();
  for (std::uint64_t member = 0; member < member_count(dimensions); ++member) {
    FormulaResolver resolver(formula, scope, expressions);
    result.push_back(
        {member_suffix(dimensions, member), resolver.resolve(member_indices(dimensions, member))});
  }
  return result;
}

Formula parse_formula(const ScalarText& text, const FormulaScope& scope,
                      std::vector<Expression>* expressions) {
  const syntax::Formula formula = syntax::parse_formula(text);
  if (!formula.indices.empty()) {
    throw ParseError("'forall' stands before a property's formula alone", text.position(0));
  }
  return FormulaResolver(formula, scope, expressions).resolve({});
}

}  // namespace maide
