#include "maide/check/language/term_parser.hpp"

#include <fmt/format.h>

#include <charconv>
#include <span>
#include <string>
#include <system_error>
#include <utility>

namespace maide::syntax {
namespace {

constexpr int max_term_nesting = 200;  // the parser and all walks over the tree recurse
constexpr int max_operations = 2000;   // `a + b + c` is as deep as it is long

// Operators of the same strength.
struct Level {
  enum class Kind : std::uint8_t { from_left, to_right, prefix };
  struct Row {
    std::string_view text;
    Sign sign;
  };
  Kind kind;
  std::span<const Row> rows;
};

constexpr Level::Row equivalence[] = {{"<->", Sign::equivalence}};
constexpr Level::Row implication[] = {{"->", Sign::implication}};
constexpr Level::Row disjunction[] = {{"||", Sign::disjunction}};
constexpr Level::Row conjunction[] = {{"&&", Sign::conjunction}};
constexpr Level::Row disjunction_of_formulas[] = {{"||", Sign::disjunction},
                                                  {"|", Sign::disjunction}};
constexpr Level::Row conjunction_of_formulas[] = {{"&&", Sign::conjunction},
                                                  {"&", Sign::conjunction}};
constexpr Level::Row equality[] = {{"==", Sign::equal}, {"!=", Sign::unequal}};
constexpr Level::Row order[] = {
    {"<=", Sign::at_most}, {">=", Sign::at_least}, {"<", Sign::less}, {">", Sign::greater}};
constexpr Level::Row comparison[] = {{"==", Sign::equal},   {"!=", Sign::unequal},
                                     {"<=", Sign::at_most}, {">=", Sign::at_least},
                                     {"<", Sign::less},     {">", Sign::greater}};
constexpr Level::Row sum[] = {{"+", Sign::plus}, {"-", Sign::minus}};
constexpr Level::Row product[] = {{"*", Sign::times}, {"/", Sign::divide}, {"%", Sign::remainder}};
constexpr Level::Row signs[] = {{"-", Sign::negate}, {"!", Sign::negation}};
constexpr Level::Row minus[] = {{"-", Sign::negate}};
constexpr Level::Row until[] = {{"U", Sign::until}, {"R", Sign::release}, {"W", Sign::weak_until}};
constexpr Level::Row temporal[] = {{"!", Sign::negation}, {"[]", Sign::globally},
                                   {"G", Sign::globally}, {"<>", Sign::finally},
                                   {"F", Sign::finally},  {"X", Sign::next}};

using Kind = Level::Kind;
constexpr Level expression_levels[] = {
    {Kind::from_left, disjunction}, {Kind::from_left, conjunction}, {Kind::from_left, equality},
    {Kind::from_left, order},       {Kind::from_left, sum},         {Kind::from_left, product},
    {Kind::prefix, signs}};
constexpr std::size_t level_of_sum = 4;
constexpr Level formula_levels[] = {{Kind::from_left, equivalence},
                                    {Kind::to_right, implication},
                                    {Kind::from_left, disjunction_of_formulas},
                                    {Kind::from_left, conjunction_of_formulas},
                                    {Kind::to_right, until},
                                    {Kind::prefix, temporal},
                                    {Kind::from_left, comparison},
                                    {Kind::from_left, sum},
                                    {Kind::from_left, product},
                                    {Kind::prefix, minus}};

bool owns(const Token& token) {
  return token.is("@") || token.is(".") || token.is("!") || token.is(":");
}

}  // namespace

Name to_name(const TokenStream& tokens, const Token& token) {
  return {token.text, token.kind == Token::Kind::quoted, tokens.place(token)};
}

std::int64_t parse_integer(const TokenStream& tokens, const Token& token) {
  std::int64_t value = 0;
  const char* const end = token.text.data() + token.text.size();
  const auto [stop, error] = std::from_chars(token.text.data(), end, value);
  if (token.kind == Token::Kind::number && error == std::errc::result_out_of_range) {
    tokens.fail("this number does not fit into 64 bits", token);
  }
  if (token.kind != Token::Kind::number || error != std::errc() || stop != end) {
    tokens.fail("expected a number, not " + to_string(token), token);
  }
  return value;
}

Term TermParser::parse() { return parse_all(Grammar::expression, 0); }
Term TermParser::parse_sum() { return parse_all(Grammar::expression, level_of_sum); }
Term TermParser::parse_formula() { return parse_all(Grammar::formula, 0); }

Term TermParser::parse_all(Grammar grammar, std::size_t weakest) {
  if (nesting_ == 0) operations_ = 0;
  return parse_level(grammar, weakest);
}

Range TermParser::parse_range() {
  Range range;
  range.low = parse_sum();
  tokens_.expect("..", "between the least and the greatest");
  range.high = parse_sum();
  return range;
}

std::vector<Index> TermParser::parse_index_list(std::string_view as_in) {
  std::vector<Index> indices;
  do {
    const Token name = tokens_.next();
    if (!name.is_name()) {
      tokens_.fail(fmt::format("expected an index as in {}, not {}", as_in, to_string(name)), name);
    }
    tokens_.expect("in", fmt::format("behind an index, as in {}", as_in));
    for (const Index& other : indices) {
      if (other.name.text == name.text) {
        tokens_.fail("the index '" + name.text + "' is there twice", name);
      }
    }
    indices.push_back({to_name(tokens_, name), parse_range()});
  } while (tokens_.accept(","));
  return indices;
}

void TermParser::deeper(Grammar grammar, const Token& token) {
  const std::string what = grammar == Grammar::formula ? "the formula" : "this expression";
  if (++nesting_ > max_term_nesting) tokens_.fail(what + " is nested too deeply", token);
  if (++operations_ > max_operations) tokens_.fail(what + " is too large", token);
}

namespace {

std::span<const Level> levels_of(bool is_formula) {
  return is_formula ? std::span<const Level>(formula_levels) : expression_levels;
}

// The sign of an operator that the token is, among the levels from `weakest` to `strongest`.
struct FoundSign {
  Sign sign = Sign::none;
  std::size_t level = 0;
  bool goes_right = false;
};
FoundSign find_sign(std::span<const Level> levels, std::size_t weakest, std::size_t strongest,
                    bool is_prefix, const Token& token, const Token& behind) {
  for (std::size_t at = weakest; at < levels.size() && at <= strongest; ++at) {
    const Level& level = levels[at];
    if ((level.kind == Level::Kind::prefix) != is_prefix) continue;
    for (const auto& [text, sign] : level.rows) {
      if (!token.is(text)) continue;
      // A word that names something: F@label.
      const bool is_name =
          is_prefix && token.kind == Token::Kind::identifier && owns(behind) && !behind.is("!");
      if (!is_name) return {sign, at, level.kind == Level::Kind::to_right};
    }
  }
  return {};
}

Term make_operation(Sign sign, TextPlace place, TextPlace begin) {
  Term term;
  term.kind = Term::Kind::operation;
  term.sign = sign;
  term.place = place;
  term.begin = begin;
  return term;
}

}  // namespace

// Invariant: all operators of `weakest` and of stronger levels are consumed, and no weaker one.
// `strength` is the level of what was read so far: a stronger operator cannot take it as its left
// side.
Term TermParser::parse_level(Grammar grammar, std::size_t weakest) {
  const std::span<const Level> levels = levels_of(grammar == Grammar::formula);
  const auto find = [&](std::size_t strongest, bool is_prefix) {
    return find_sign(levels, weakest, strongest, is_prefix, tokens_.peek(), tokens_.peek(1));
  };
  std::size_t strength = levels.size();
  Term left;
  if (const FoundSign prefix = find(strength, true); prefix.sign != Sign::none) {
    const Token token = tokens_.next();
    deeper(grammar, token);
    left = make_operation(prefix.sign, tokens_.place(token), tokens_.place(token));
    left.operands.push_back(parse_level(grammar, prefix.level));
    --nesting_;
    strength = prefix.level;
  } else {
    left = parse_primary(grammar);
  }
  for (;;) {
    const FoundSign infix = find(strength, false);
    if (infix.sign == Sign::none) return left;
    const Token token = tokens_.next();
    deeper(grammar, token);
    Term term = make_operation(infix.sign, tokens_.place(token), left.begin);
    term.operands.push_back(std::move(left));
    term.operands.push_back(parse_level(grammar, infix.goes_right ? infix.level : infix.level + 1));
    --nesting_;
    left = std::move(term);
    strength = infix.level;
  }
}

Term TermParser::parse_brackets(Grammar grammar, const Token& open) {
  deeper(grammar, open);
  Term inner = parse_level(grammar, 0);
  inner.begin = tokens_.place(open);
  if (!tokens_.accept(")")) {
    fail_foreign(tokens_.peek());
    tokens_.fail("expected ')' for this '(', not " + to_string(tokens_.peek()) + " at " +
                     to_string(tokens_.position(tokens_.peek())),
                 open);
  }
  --nesting_;
  return inner;
}

Term TermParser::parse_primary(Grammar grammar) {
  const Token first = tokens_.next();
  if (first.is("(")) return parse_brackets(grammar, first);
  Term term;
  term.place = term.begin = tokens_.place(first);
  if (first.kind == Token::Kind::number) {
    if (tokens_.peek().is(".") && tokens_.peek(1).kind == Token::Kind::number) {
      tokens_.fail("numbers are whole, without a fraction", first);
    }
    term.value = parse_integer(tokens_, first);
    return term;
  }
  const bool is_formula = grammar == Grammar::formula;
  if ((first.is("true") || first.is("false")) && !(is_formula && owns(tokens_.peek()))) {
    term.kind = Term::Kind::boolean;
    term.value = first.is("true") ? 1 : 0;
    return term;
  }
  if (!first.is_name()) {
    fail_foreign(first);
    tokens_.fail(std::string("expected ") + (is_formula ? "a formula" : "an expression") +
                     ", not " + to_string(first),
                 first);
  }
  if (first.is("not") && (tokens_.peek().is_name() || tokens_.peek().is("("))) fail_foreign(first);
  Term name = parse_name_behind(grammar, first);
  if (!is_formula && tokens_.peek().is(".") && tokens_.peek(1).is("there")) {
    tokens_.next();
    name.parts.push_back({'.', to_name(tokens_, tokens_.next()), false, {}, {}, false, {}});
  }
  // Where an operand begins behind it, it was meant for an operator: `always p@end`.
  const Token& behind = tokens_.peek();
  const bool is_alone = name.parts.empty() && !name.has_indices;
  const bool is_infix = behind.is("U") || behind.is("R") || behind.is("W");
  if (is_formula && is_alone && !is_infix && (behind.is_name() || behind.is("("))) {
    fail_foreign(first);
  }
  return name;
}

Term TermParser::parse_name() { return parse_name_behind(Grammar::expression, tokens_.next()); }

Term TermParser::parse_name_behind(Grammar grammar, const Token& name) {
  Term term;
  term.kind = Term::Kind::name;
  term.name = to_name(tokens_, name);
  term.place = term.begin = term.name.place;
  term.has_indices = parse_indices(term.operands, grammar);
  if (grammar == Grammar::formula) {
    parse_indices(term.reader, grammar);
    parse_parts(term);
  }
  return term;
}

bool TermParser::parse_indices(std::vector<Term>& indices, Grammar grammar) {
  if (!tokens_.accept("[")) return false;
  do {
    Term index = parse_sum();
    // A reader of a topic: image[detector.on_image].
    if (grammar == Grammar::formula && index.is_name() && tokens_.accept(".")) {
      index.parts.push_back({'.', to_name(tokens_, tokens_.next()), false, {}, {}, false, {}});
    }
    indices.push_back(std::move(index));
  } while (tokens_.accept(","));
  tokens_.expect("]", "behind an index");
  return true;
}

void TermParser::parse_parts(Term& term) {
  while (owns(tokens_.peek())) {
    const Token sign = tokens_.next();
    const Token name = tokens_.next();
    if (!name.is_name()) {
      tokens_.fail("expected a name after '" + sign.text + "', not " + to_string(name), name);
    }
    NamePart part;
    part.sign = sign.text.front();
    part.name = to_name(tokens_, name);
    part.has_indices = parse_indices(part.indices, Grammar::formula);
    parse_indices(part.reader, Grammar::formula);
    parse_values(part);
    term.parts.push_back(std::move(part));
  }
}

void TermParser::parse_values(NamePart& part) {
  if (!tokens_.accept("(")) return;
  part.has_values = true;
  while (!tokens_.peek().is(")")) {
    const Token token = tokens_.next();
    if (token.kind == Token::Kind::end) tokens_.fail("this '(' is not closed", token);
    part.values.push_back({token.text, token.kind == Token::Kind::quoted, tokens_.place(token)});
  }
  tokens_.next();
}

std::string_view own_sign_of_formulas(std::string_view foreign) {
  static constexpr std::pair<std::string_view, std::string_view> signs[] = {
      {"until", "U"},      {"release", "R"},   {"next", "X"},     {"always", "G"},
      {"globally", "G"},   {"finally", "F"},   {"TRUE", "true"},  {"True", "true"},
      {"eventually", "F"}, {"FALSE", "false"}, {"False", "false"}};
  for (const auto& [theirs, ours] : signs) {
    if (foreign == theirs) return ours;
  }
  return own_sign(foreign);
}

void TermParser::fail_foreign(const Token& token) const {
  const std::string_view ours = own_sign_of_formulas(token.text);
  if (token.kind == Token::Kind::quoted || ours.empty()) return;
  tokens_.fail(fmt::format("'{}' is no sign here: it is '{}'", token.text, ours), token);
}

}  // namespace maide::syntax
