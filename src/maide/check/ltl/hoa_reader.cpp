// Recursive descent over the format's grammar. Labels become disjunctions of letters, and a
// transition is made for each; marks of a state go to all transitions that leave it.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "maide/base/error.hpp"
#include "maide/base/text_cursor.hpp"
#include "maide/check/ltl/ltl_automaton.hpp"
#include "maide/formats/names.hpp"

namespace maide {

// The words of the Hanoi Omega-Automata format: headers (`States:`), names, aliases (`@a`),
// numbers, strings, `--BODY--` and its like, single characters. Comments nest.

struct HoaToken {
  enum class Kind : std::uint8_t { header, word, alias, number, string, marker, symbol, end };
  Kind kind = Kind::end;
  std::string text;  // a header without its colon, a string without quotes and escapes
  TextPlace place;
};

// How it reads in a message.
std::string to_string(const HoaToken& token);

// Reads as it goes. Throws ParseError.
class HoaTokens {
 public:
  // Keeps a reference to the text.
  HoaTokens(std::string_view text, const std::string& file)
      : cursor_(text, file, TextCursor::Columns::bytes), token_(scan()) {}

  const HoaToken& peek() const { return token_; }
  HoaToken next();
  // Consumes the next token if it is that marker, word or symbol.
  bool accept(std::string_view what);
  void expect(std::string_view what);
  // The token must be a number, at most `most`.
  std::uint64_t value(const HoaToken& token, const char* what, std::uint64_t most) const;

  SourcePosition position(const HoaToken& token) const { return cursor_.in_file(token.place); }
  [[noreturn]] void fail(const std::string& message, const HoaToken& token) const {
    cursor_.fail(message, token.place);
  }

 private:
  HoaToken scan();
  bool skip_comment();
  void scan_string(HoaToken& token);
  void scan_name(HoaToken& token);

  TextCursor cursor_;
  HoaToken token_;
};

namespace {

bool begins_name(char c) { return is_letter(c) || c == '_'; }
bool continues_name(char c) { return begins_name(c) || is_digit(c) || c == '-'; }
bool continues_marker(char c) { return begins_name(c) || c == '-'; }

}  // namespace

std::string to_string(const HoaToken& token) {
  return token.kind == HoaToken::Kind::end ? "the end of the file" : shown(token.text);
}

HoaToken HoaTokens::next() {
  HoaToken token = std::move(token_);
  token_ = scan();
  return token;
}

bool HoaTokens::accept(std::string_view what) {
  using Kind = HoaToken::Kind;
  if (token_.text != what || token_.kind == Kind::string || token_.kind == Kind::header) {
    return false;
  }
  next();
  return true;
}

void HoaTokens::expect(std::string_view what) {
  if (accept(what)) return;
  fail("expected '" + std::string(what) + "', not " + to_string(token_), token_);
}

std::uint64_t HoaTokens::value(const HoaToken& token, const char* what, std::uint64_t most) const {
  std::uint64_t number = 0;
  const char* end = token.text.data() + token.text.size();
  const bool is_number =
      token.kind == HoaToken::Kind::number &&
      std::from_chars(token.text.data(), end, number).ec != std::errc::invalid_argument;
  if (!is_number) fail(std::string("expected ") + what + ", not " + to_string(token), token);
  const bool fits = std::from_chars(token.text.data(), end, number).ec == std::errc();
  if (!fits || number > most) {
    fail(std::string(what) + " goes up to " + std::to_string(most) + " here", token);
  }
  return number;
}

// Comments nest.
bool HoaTokens::skip_comment() {
  const TextPlace open = cursor_.place();
  if (!cursor_.accept("/*")) return false;
  for (int depth = 1; depth > 0;) {
    if (cursor_.at_end()) cursor_.fail("this comment is not closed", open);
    if (cursor_.accept("/*")) {
      ++depth;
    } else if (cursor_.accept("*/")) {
      --depth;
    } else {
      cursor_.take();
    }
  }
  return true;
}

void HoaTokens::scan_string(HoaToken& token) {
  token.kind = HoaToken::Kind::string;
  std::string_view rest = cursor_.rest();
  if (!take_quoted_name(rest, token.text)) fail("this string is not closed", token);
  cursor_.take(cursor_.rest().size() - rest.size());
}

// A word, or, with a colon at its end, a header.
void HoaTokens::scan_name(HoaToken& token) {
  token.text += cursor_.take_while(continues_name);
  token.kind = cursor_.accept(":") ? HoaToken::Kind::header : HoaToken::Kind::word;
}

HoaToken HoaTokens::scan() {
  using Kind = HoaToken::Kind;
  do {
    cursor_.skip_blanks();
  } while (skip_comment());
  HoaToken token;
  token.place = cursor_.place();
  if (cursor_.at_end()) return token;
  const char first = cursor_.peek();
  if (first == '"') {
    scan_string(token);
  } else if (begins_name(first)) {
    scan_name(token);
  } else if (first == '@') {
    token.text = cursor_.take();
    scan_name(token);
    token.kind = Kind::alias;
  } else if (is_digit(first)) {
    token.kind = Kind::number;
    token.text = cursor_.take_while(is_digit);
  } else if (cursor_.rest().starts_with("--")) {
    token.kind = Kind::marker;
    token.text = cursor_.take_while(continues_marker);
  } else {
    token.kind = Kind::symbol;
    token.text = cursor_.take();
  }
  return token;
}

namespace {

using Letters = std::vector<Letter>;  // a disjunction

constexpr std::size_t most_letters = 4096;
constexpr std::size_t most_implicit_atoms = 12;  // each state has 2^atoms transitions
constexpr std::uint64_t largest_state_number = 1'000'000;
constexpr int max_nesting = 200;

class HoaReader {
 public:
  HoaReader(std::string_view text, const std::string& file, const FormulaScope& scope)
      : text_(text), tokens_(text, file), scope_(scope) {}

  LtlAutomaton read() {
    read_header();
    read_body();
    if (tokens_.peek().kind != HoaToken::Kind::end) {
      tokens_.fail("a file has one automaton; this begins something else", tokens_.peek());
    }
    finish();
    return std::move(automaton_);
  }

 private:
  using Kind = HoaToken::Kind;

  // Header

  void read_header() {
    const HoaToken first = tokens_.next();
    if (first.kind != Kind::header || first.text != "HOA") {
      tokens_.fail("an automaton begins with 'HOA: v1', not " + to_string(first), first);
    }
    const HoaToken version = tokens_.next();
    if (version.text != "v1") {
      tokens_.fail("version v1 of the format is read, not " + to_string(version), version);
    }
    while (!tokens_.accept("--BODY--")) {
      const HoaToken header = tokens_.next();
      if (header.kind != Kind::header) {
        tokens_.fail("expected a header or '--BODY--', not " + to_string(header), header);
      }
      read_header_item(header);
    }
    if (!has_acceptance_) tokens_.fail("the header has no 'Acceptance:'", tokens_.peek());
  }

  void read_header_item(const HoaToken& header) {
    if (header.text == "States") {
      states_ = number("the number of states", largest_state_number);
    } else if (header.text == "Start") {
      starts_.push_back(tokens_.peek());
      number("the initial state", largest_state_number);
      refuse_conjunction();
    } else if (header.text == "AP") {
      read_atoms(header);
    } else if (header.text == "Alias") {
      const HoaToken name = tokens_.next();
      if (name.kind != Kind::alias) {
        tokens_.fail("expected the name of an alias, not " + to_string(name), name);
      }
      Letters letters = read_label();
      if (!aliases_.emplace(name.text, std::move(letters)).second) {
        tokens_.fail("the alias " + name.text + " is there twice", name);
      }
    } else if (header.text == "Acceptance") {
      read_acceptance(header);
    } else if (header.text[0] >= 'A' && header.text[0] <= 'Z') {
      // The format's rule: a header that begins with a capital letter changes the meaning.
      tokens_.fail("the header '" + header.text + ":' is not understood", header);
    } else {
      while (!is_header_end(tokens_.peek())) tokens_.next();
    }
  }

  static bool is_header_end(const HoaToken& token) {
    return token.kind == Kind::header || token.kind == Kind::end || token.kind == Kind::marker;
  }

  void read_atoms(const HoaToken& header) {
    if (has_atoms_) tokens_.fail("'AP:' is there twice", header);
    has_atoms_ = true;
    const std::uint64_t count = number("the number of atomic propositions", max_automaton_atoms);
    std::set<std::string> seen;
    for (std::uint64_t i = 0; i < count; ++i) {
      const HoaToken name = tokens_.next();
      if (name.kind != Kind::string) {
        tokens_.fail("expected an atomic proposition in quotes, not " + to_string(name), name);
      }
      if (!seen.insert(name.text).second) {
        tokens_.fail("the atomic proposition " + to_string(name) + " is there twice", name);
      }
      const Formula formula =
          parse_formula(ScalarText(name.text, text_, tokens_.position(name)), scope_);
      if (formula->op != FormulaNode::Operator::atom) {
        tokens_.fail(
            "an atomic proposition is program@label, program@end, model.input or "
            "model!output, not " +
                to_string(name),
            name);
      }
      automaton_.atoms.push_back(formula->atom);
    }
  }

  // `Inf(0)&Inf(1)&...` in any order, or `t`. Sets that it does not name are not asked for.
  void read_acceptance(const HoaToken& header) {
    if (has_acceptance_) tokens_.fail("'Acceptance:' is there twice", header);
    has_acceptance_ = true;
    sets_ = number("the number of acceptance sets", 64);
    if (tokens_.accept("t")) return;
    do {
      const HoaToken inf = tokens_.next();
      if (inf.text != "Inf" || !tokens_.accept("(") || tokens_.peek().kind != Kind::number) {
        tokens_.fail(
            "acceptance other than generalized Buchi - Inf(0)&Inf(1)&..., or t - is not read", inf);
      }
      const HoaToken set = tokens_.peek();
      const std::uint64_t index = number("an acceptance set", 63);
      if (index >= sets_) tokens_.fail("there is no acceptance set " + set.text, set);
      required_ |= std::uint64_t{1} << index;
      tokens_.expect(")");
    } while (tokens_.accept("&"));
    if (!is_header_end(tokens_.peek())) {
      tokens_.fail(
          "acceptance other than generalized Buchi - Inf(0)&Inf(1)&..., or t - is not read",
          tokens_.peek());
    }
  }

  // Body

  void read_body() {
    while (!tokens_.accept("--END--")) {
      const HoaToken state = tokens_.next();
      if (state.text == "--ABORT--") tokens_.fail("the automaton was given up: --ABORT--", state);
      if (state.kind != Kind::header || state.text != "State") {
        tokens_.fail("expected 'State:' or '--END--', not " + to_string(state), state);
      }
      read_state();
    }
  }

  void read_state() {
    std::optional<Letters> label;
    if (tokens_.peek().text == "[") label = read_bracketed_label();
    const HoaToken place = tokens_.peek();
    const std::size_t state = state_number();
    if (!defined_.insert(state).second)
      tokens_.fail("state " + place.text + " is there twice", place);
    if (tokens_.peek().kind == Kind::string) tokens_.next();  // its name
    const std::uint64_t marks = read_marks();
    std::uint64_t implicit = 0;  // the next valuation whose transition has no label
    for (;;) {
      const HoaToken next = tokens_.peek();
      const bool is_labelled = next.text == "[" && next.kind == Kind::symbol;
      if (!is_labelled && next.kind != Kind::number) break;
      if (is_labelled && (label || implicit > 0)) {
        tokens_.fail("some transitions of the state have labels of their own, some not", next);
      }
      Letters letters;
      if (is_labelled) {
        letters = read_bracketed_label();
      } else {
        letters = label ? *label : Letters{implicit_letter(implicit++, next)};
      }
      const std::size_t target = state_number();
      refuse_conjunction();
      add_transitions(state, letters, target, marks | read_marks());
    }
    const std::uint64_t valuations = std::uint64_t{1} << automaton_.atoms.size() % 64;
    if (implicit > 0 && implicit != valuations) {
      tokens_.fail(fmt::format("state {} has {} transitions without label, not {}", place.text,
                               implicit, valuations),
                   place);
    }
  }

  Letter implicit_letter(std::uint64_t valuation, const HoaToken& place) const {
    const std::size_t atoms = automaton_.atoms.size();
    if (atoms > most_implicit_atoms) {
      tokens_.fail(fmt::format("transitions without labels are read for at most {} atomic "
                               "propositions",
                               most_implicit_atoms),
                   place);
    }
    const std::uint64_t all = (std::uint64_t{1} << atoms) - 1;
    if (valuation > all) tokens_.fail("the state has too many transitions without label", place);
    return {valuation, all & ~valuation};
  }

  void add_transitions(std::size_t state, const Letters& letters, std::size_t target,
                       std::uint64_t marks) {
    if (automaton_.states.size() <= std::max(state, target)) {
      automaton_.states.resize(std::max(state, target) + 1);
    }
    for (const Letter& letter : letters) {
      automaton_.states[state].push_back({letter, static_cast<std::uint32_t>(target), marks});
    }
  }

  std::uint64_t read_marks() {
    std::uint64_t marks = 0;
    if (!tokens_.accept("{")) return marks;
    while (!tokens_.accept("}")) {
      const HoaToken place = tokens_.peek();
      const std::uint64_t set = number("an acceptance set", 63);
      if (set >= sets_) tokens_.fail("there is no acceptance set " + place.text, place);
      marks |= std::uint64_t{1} << set;
    }
    return marks;
  }

  // Labels

  Letters read_bracketed_label() {
    tokens_.expect("[");
    Letters letters = read_label();
    tokens_.expect("]");
    return letters;
  }

  Letters read_label() { return read_disjunction(false); }

  // The letters of a label, or of its negation, where conjunctions and disjunctions change places.
  Letters read_disjunction(bool is_negated) {
    if (++nesting_ > max_nesting) tokens_.fail("the label is nested too deeply", tokens_.peek());
    Letters letters = read_conjunction(is_negated);
    while (tokens_.accept("|")) letters = join(letters, read_conjunction(is_negated), is_negated);
    --nesting_;
    return letters;
  }

  Letters read_conjunction(bool is_negated) {
    Letters letters = read_literal(is_negated);
    while (tokens_.accept("&")) letters = join(letters, read_literal(is_negated), !is_negated);
    return letters;
  }

  Letters read_literal(bool is_negated) {
    const HoaToken token = tokens_.next();
    if (token.text == "!" && token.kind == Kind::symbol) {
      if (++nesting_ > max_nesting) tokens_.fail("the label is nested too deeply", token);
      Letters letters = read_literal(!is_negated);
      --nesting_;
      return letters;
    }
    if (token.text == "(" && token.kind == Kind::symbol) {
      Letters letters = read_disjunction(is_negated);
      tokens_.expect(")");
      return letters;
    }
    if (token.kind == Kind::word && (token.text == "t" || token.text == "f")) {
      return (token.text == "t") != is_negated ? Letters{Letter()} : Letters{};
    }
    if (token.kind == Kind::alias) {
      const auto alias = aliases_.find(token.text);
      if (alias == aliases_.end()) tokens_.fail("there is no alias " + token.text, token);
      return is_negated ? negation(alias->second) : alias->second;
    }
    if (token.kind != Kind::number) {
      tokens_.fail("expected a label, not " + to_string(token), token);
    }
    const std::uint64_t atom = tokens_.value(token, "an atomic proposition", 63);
    if (atom >= automaton_.atoms.size()) {
      tokens_.fail("there is no atomic proposition " + token.text, token);
    }
    const std::uint64_t bit = std::uint64_t{1} << atom;
    return {is_negated ? Letter{0, bit} : Letter{bit, 0}};
  }

  Letters negation(const Letters& letters) {
    Letters result{Letter()};
    for (const Letter& letter : letters) {
      Letters literals;
      for (std::size_t atom = 0; atom < automaton_.atoms.size(); ++atom) {
        const std::uint64_t bit = std::uint64_t{1} << atom;
        if ((letter.positive & bit) != 0) literals.push_back({0, bit});
        if ((letter.negative & bit) != 0) literals.push_back({bit, 0});
      }
      result = join(result, literals, true);
    }
    return result;
  }

  Letters join(const Letters& left, const Letters& right, bool is_conjunction) {
    Letters letters;
    if (is_conjunction) {
      for (const Letter& one : left) {
        for (const Letter& other : right) {
          const Letter both{one.positive | other.positive, one.negative | other.negative};
          if (!both.is_contradiction()) letters.push_back(both);
        }
        check_size(letters);
      }
    } else {
      letters = left;
      letters.insert(letters.end(), right.begin(), right.end());
    }
    std::ranges::sort(letters);
    letters.erase(std::unique(letters.begin(), letters.end()), letters.end());
    check_size(letters);
    return letters;
  }

  void check_size(const Letters& letters) const {
    if (letters.size() > most_letters) {
      tokens_.fail(fmt::format("the label stands for more than {} conjunctions", most_letters),
                   tokens_.peek());
    }
  }

  // Numbers

  std::uint64_t number(const char* what, std::uint64_t most) {
    const HoaToken token = tokens_.next();
    return tokens_.value(token, what, most);
  }

  std::size_t state_number() {
    const HoaToken token = tokens_.next();
    const std::uint64_t state = tokens_.value(token, "a state", largest_state_number - 1);
    if (states_ && state >= *states_) {
      tokens_.fail(fmt::format("there is no state {}: 'States:' says {}", state, *states_), token);
    }
    return state;
  }

  void refuse_conjunction() {
    if (tokens_.peek().text == "&" && tokens_.peek().kind == Kind::symbol) {
      tokens_.fail("alternating automata (a conjunction of states) are not read", tokens_.peek());
    }
  }

  // Leaves out the sets that the acceptance does not name, and numbers the others anew.
  void finish() {
    std::size_t count = std::max<std::size_t>(automaton_.states.size(), states_.value_or(0));
    for (const HoaToken& start : starts_) {
      const std::uint64_t state = tokens_.value(start, "a state", largest_state_number - 1);
      if (states_ && state >= *states_) tokens_.fail("there is no state " + start.text, start);
      count = std::max<std::size_t>(count, state + 1);
      automaton_.initial.push_back(static_cast<std::uint32_t>(state));
    }
    automaton_.states.resize(count);
    for (unsigned set = 0; set < 64; ++set) {
      automaton_.mark_count += (required_ >> set & 1) != 0 ? 1 : 0;
    }
    for (auto& transitions : automaton_.states) {
      for (auto& transition : transitions) transition.marks = renumbered(transition.marks);
    }
    automaton_.universal = find_universal(automaton_);
  }

  std::uint64_t renumbered(std::uint64_t marks) const {
    std::uint64_t result = 0;
    unsigned next = 0;
    for (unsigned set = 0; set < 64; ++set) {
      if ((required_ >> set & 1) == 0) continue;
      result |= (marks >> set & 1) << next;
      ++next;
    }
    return result;
  }

  std::string_view text_;
  HoaTokens tokens_;
  const FormulaScope& scope_;
  LtlAutomaton automaton_;
  std::optional<std::uint64_t> states_;
  std::vector<HoaToken> starts_;
  std::set<std::size_t> defined_;
  std::map<std::string, Letters> aliases_;
  std::uint64_t sets_ = 0, required_ = 0;  // acceptance sets; those that must come again and again
  bool has_atoms_ = false, has_acceptance_ = false;
  int nesting_ = 0;
};

}  // namespace

LtlAutomaton read_hoa(std::string_view text, const std::string& file, const FormulaScope& scope) {
  return HoaReader(text, file, scope).read();
}

}  // namespace maide
