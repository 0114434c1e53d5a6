// Recursive descent over formulas; the grammar stands in formula.hpp. A word `F`, `G`, ... is the
// operator unless `@` or `.` follows it: `F !a!b` is "finally not", a model named F is quoted.
#include <algorithm>

#include "maide/base/text.hpp"
#include "maide/check/language/tokens.hpp"
#include "maide/check/ltl/formula.hpp"

namespace maide {
namespace {

using Operator = FormulaNode::Operator;

constexpr std::string_view symbols[] = {"<->", "->", "[]", "<>", "&&", "||", "&",
                                        "|",   "!",  "(",  ")",  "@",  "."};
constexpr int max_nesting = 200;  // the parser and all walks over formulas recurse
constexpr int max_size = 2000;
constexpr double max_expanded_size = 10'000;  // of the normal form, in which each <-> doubles

// Nodes of the negation normal form, or an upper bound.
double expanded_size(const Formula& formula) {
  if (!formula) return 0;
  const double size = 1 + expanded_size(formula->left) + expanded_size(formula->right);
  const bool doubles = formula->op == Operator::equivalence || formula->op == Operator::weak_until;
  return doubles ? 2 * size : size;
}

class Parser {
 public:
  Parser(const ScalarText& text, const FormulaScope& scope)
      : text_(text), tokens_(text, symbols), scope_(scope) {}

  Formula parse() {
    Formula formula = parse_equivalence();
    const Token& rest = tokens_.peek();
    if (rest.is(")")) tokens_.fail("this ')' closes nothing", rest);
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

  void deeper() {
    if (++nesting_ > max_nesting) {
      tokens_.fail("the formula is nested too deeply", tokens_.peek());
    }
  }

  bool accept_either(std::string_view one, std::string_view other) {
    return tokens_.accept(one) || tokens_.accept(other);
  }

  Formula parse_equivalence() {
    deeper();
    Formula left = parse_implication();
    while (tokens_.accept("<->")) left = make(Operator::equivalence, left, parse_implication());
    --nesting_;
    return left;
  }

  Formula parse_implication() {
    deeper();
    Formula left = parse_disjunction();
    if (tokens_.accept("->")) left = make(Operator::implication, left, parse_implication());
    --nesting_;
    return left;
  }

  Formula parse_disjunction() {
    Formula left = parse_conjunction();
    while (accept_either("||", "|")) left = make(Operator::disjunction, left, parse_conjunction());
    return left;
  }

  Formula parse_conjunction() {
    Formula left = parse_until();
    while (accept_either("&&", "&")) left = make(Operator::conjunction, left, parse_until());
    return left;
  }

  Formula parse_until() {
    deeper();
    Formula left = parse_unary();
    for (const auto& [word, op] :
         {std::pair("U", Operator::until), {"R", Operator::release}, {"W", Operator::weak_until}}) {
      if (tokens_.accept(word)) {
        left = make(op, left, parse_until());
        break;
      }
    }
    --nesting_;
    return left;
  }

  Formula parse_unary() {
    deeper();
    Formula result;
    if (tokens_.accept("!")) {
      result = make(Operator::negation, parse_unary());
    } else if (tokens_.accept("[]") || accept_word("G")) {
      result = make(Operator::globally, parse_unary());
    } else if (tokens_.accept("<>") || accept_word("F")) {
      result = make(Operator::finally, parse_unary());
    } else if (accept_word("X")) {
      result = make(Operator::next, parse_unary());
    } else {
      result = parse_primary();
    }
    --nesting_;
    return result;
  }

  bool accept_word(std::string_view word) {
    if (tokens_.peek(1).is("@") || tokens_.peek(1).is(".")) return false;
    return tokens_.accept(word);
  }

  Formula parse_primary() {
    const Token token = tokens_.next();
    if (token.is("(")) {
      Formula inner = parse_equivalence();
      if (!tokens_.accept(")")) {
        tokens_.fail("expected ')' for this '(', not " + to_string(tokens_.peek()) + " at " +
                         to_string(tokens_.position(tokens_.peek())),
                     token);
      }
      return inner;
    }
    if (!token.is_name()) {
      tokens_.fail("expected a formula, not " + to_string(token), token);
    }
    const bool names_owner =
        tokens_.peek().is("@") || tokens_.peek().is(".") || tokens_.peek().is("!");
    if (token.is("true") && !names_owner) return make(Operator::truth, nullptr);
    if (token.is("false") && !names_owner) return make(Operator::falsity, nullptr);
    return parse_atom(token);
  }

  Formula parse_atom(const Token& owner) {
    const Token separator = tokens_.next();
    if (!separator.is("@") && !separator.is(".") && !separator.is("!")) {
      tokens_.fail(
          "expected program@label, model.input or model!output, not " + to_string(owner) + " alone",
          owner);
    }
    const Token name = tokens_.next();
    if (!name.is_name()) {
      tokens_.fail("expected a name after '" + separator.text + "', not " + to_string(name), name);
    }
    auto node = std::make_shared<FormulaNode>(FormulaNode{Operator::atom, {}, nullptr, nullptr});
    node->atom =
        separator.is("@") ? find_label(owner, name) : find_event(owner, name, separator.is("."));
    if (++size_ > max_size) tokens_.fail("the formula is too large", owner);
    return node;
  }

  Atom find_label(const Token& owner, const Token& name) {
    std::vector<std::string> known;
    for (std::uint32_t index = 0; index < scope_.programs.size(); ++index) {
      const Program& program = scope_.programs[index];
      known.push_back(program.name);
      if (program.name != owner.text) continue;
      if (name.text == "end") return {Atom::Kind::end, index, 0};
      const auto place = std::find(program.labels.begin(), program.labels.end(), name.text);
      if (place == program.labels.end()) {
        tokens_.fail("program " + owner.text + " has no label '" + name.text +
                         "'; it has: " + join_labels(program),
                     name);
      }
      return {Atom::Kind::label, index, static_cast<std::uint32_t>(place - program.labels.begin())};
    }
    tokens_.fail("unknown program '" + owner.text + "'; there is: " + join(known), owner);
  }

  static std::string join_labels(const Program& program) {
    std::vector<std::string> labels = program.labels;
    labels.emplace_back("end");
    return join(labels);
  }

  Atom find_event(const Token& owner, const Token& name, bool is_input) {
    std::vector<std::string> known;
    for (std::uint32_t index = 0; index < scope_.models.size(); ++index) {
      const ProgramInterface& model = scope_.models[index];
      known.push_back(model.name);
      if (model.name != owner.text) continue;
      const Alphabet& alphabet = is_input ? *model.inputs : *model.outputs;
      const auto symbol = alphabet.find(name.text);
      if (!symbol) {
        tokens_.fail("model " + owner.text + " has no " + (is_input ? "input '" : "output '") +
                         name.text +
                         "'; it has: " + (alphabet.empty() ? "none" : join(alphabet.names())),
                     name);
      }
      return {is_input ? Atom::Kind::input : Atom::Kind::output, index, *symbol};
    }
    tokens_.fail("unknown model '" + owner.text + "'; there is: " + join(known), owner);
  }

  const ScalarText& text_;
  TokenStream tokens_;
  const FormulaScope& scope_;
  int nesting_ = 0, size_ = 0;
};

}  // namespace

Formula parse_formula(const ScalarText& text, const FormulaScope& scope) {
  return Parser(text, scope).parse();
}

}  // namespace maide
