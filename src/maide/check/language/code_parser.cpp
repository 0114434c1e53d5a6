// The language (names that are no identifiers are in double quotes; comments run from `//` or `#`
// to the end of the line):
//
//   statement := label* [idle] ( M.input; | M.input -> output; | switch M.input { arm* }
//              | wait M -> output; | select { choice* } )
//              | label* ( if * block [ else block ] | if fair * block [ else block ]
//              | if (e) block [ else (block | if ...) ] | loop block | repeat e block
//              | while (e) block | for k in e..e block | break; | continue; | stop; | skip;
//              | var x: type [= e | = any]; | x = e; | x = any [fair] e..e; | [when (e)] atomic
//              block | call p(arguments); | return; | offer M; | withdraw M; | run T; | join T; |
//              kill E; | restart E; | end; | unknown; )
//              Behind each may stand at "FILE:LINE", where it ends with `;` before that.
//   arm := (output | quiet) block      block := { statement* }      label := @name
//   choice := [when (e)] on M.input { arm* } | [when (e)] on M.input block
//           | [when (e)] on M.input -> output block | [when (e)] on M!output block
//           | when (e) block | otherwise block | timeout N block
//   input := name [(e, ...)]      output := name [(x | var x | value, ...)]
//   type := e..e | bool | {word, ...}
// M, x: a name, of an array with its indices, as in grant[r, 0]. The output `arrived` of a model
// that has none is that all has arrived which the program sent; M may be a topic's reader then:
// image[logger].
#include "maide/check/language/code_parser.hpp"

#include <algorithm>
#include <iterator>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "maide/base/text.hpp"
#include "maide/check/language/term_parser.hpp"
#include "maide/check/text/tokens.hpp"

namespace maide::syntax {
namespace {

constexpr int max_nesting = 200;  // of blocks: the parser and all walks over the tree recurse

// Keywords that begin a statement.
constexpr std::string_view openers[] = {"loop",   "repeat", "if",    "skip",   "stop",  "switch",
                                        "wait",   "select", "while", "for",    "break", "continue",
                                        "return", "call",   "var",   "atomic", "idle"};
// Words that begin a statement if a name stands behind them, or `;` behind `unknown` and `end`.
constexpr std::pair<std::string_view, Statement::Kind> verbs[] = {
    {"offer", Statement::Kind::offer},     {"withdraw", Statement::Kind::withdraw},
    {"run", Statement::Kind::run},         {"join", Statement::Kind::join},
    {"unknown", Statement::Kind::unknown}, {"spin", Statement::Kind::spin},
    {"kill", Statement::Kind::kill},       {"restart", Statement::Kind::restart},
    {"end", Statement::Kind::end}};
// Keywords inside of one; those that begin an arm of a `select` may be names of variables, too.
constexpr std::string_view arm_words[] = {"on", "when", "otherwise", "timeout"};
constexpr std::string_view others[] = {"else", "quiet"};

template <typename Words>
bool contains(const Words& words, std::string_view what) {
  return std::find(std::begin(words), std::end(words), what) != std::end(words);
}

const KnownNames no_names;

class CodeParser {
 public:
  // Keeps references.
  explicit CodeParser(const ScalarText& text, const KnownNames& names = no_names)
      : text_(text), names_(names), tokens_(text), terms_(tokens_) {}

  Code parse_code(std::string_view what_has_none) {
    Code code = begin_code();
    while (!tokens_.at_end()) {
      if (tokens_.peek().is("}")) tokens_.fail("this '}' closes nothing", tokens_.peek());
      code.block.statements.push_back(parse_statement());
    }
    if (code.block.statements.empty() && !what_has_none.empty()) {
      tokens_.fail(std::string(what_has_none) +
                       " has no statement; one that does nothing is written `skip;`",
                   tokens_.peek());
    }
    return code;
  }

  Code parse_variables() {
    Code code = begin_code();
    while (!tokens_.at_end()) {
      const Token first = tokens_.peek();
      tokens_.expect("var", "before a variable");
      Statement& statement = code.block.statements.emplace_back();
      statement.place = tokens_.place(first);
      parse_declaration(statement);
    }
    return code;
  }

  Term parse_expression() {
    Term term = terms_.parse();
    expect_end();
    return term;
  }

  Taken parse_taken() {
    Taken taken;
    taken.file = text_.position(0).file;
    taken.model = parse_model();
    taken.name_place = tokens_.place(tokens_.peek(1));
    if (tokens_.accept("!")) {
      taken.is_output = true;
      taken.event = parse_event(taken.model, "output", true);
    } else {
      tokens_.expect(".", "after model '" + taken.model.name.text + "'");
      taken.event = parse_event(taken.model, "input", false);
      if (tokens_.accept("->")) taken.output = parse_event(taken.model, "output", true);
    }
    expect_end();
    return taken;
  }

  Event parse_output_alone() {
    Event event = parse_event({}, "output", true);
    expect_end();
    return event;
  }

  Timer parse_timer() {
    Timer timer;
    timer.comes_once = tokens_.peek().is("once") && !tokens_.peek(1).is(".");
    if (timer.comes_once) tokens_.next();
    timer.period = parse_expression();
    return timer;
  }

  Declared parse_declared() {
    Declared declared;
    declared.name = parse_plain_name("a name");
    if (tokens_.accept("[")) {
      declared.indices = terms_.parse_index_list("[i in 0..4]");
      tokens_.expect("]", "behind the indices");
    }
    expect_end();
    return declared;
  }

  Head parse_head() {
    Head head;
    head.name = parse_plain_name("a procedure's name");
    tokens_.expect("(", "behind a procedure's name");
    while (!tokens_.accept(")")) {
      if (!head.parameters.empty()) tokens_.expect(",", "between parameters");
      const Token token = tokens_.peek();
      Name parameter = parse_plain_name("a parameter");
      for (const Name& other : head.parameters) {
        if (other.text != parameter.text) continue;
        tokens_.fail("the parameter '" + parameter.text + "' is there twice", token);
      }
      head.parameters.push_back(std::move(parameter));
    }
    expect_end();
    return head;
  }

  Reference parse_reference() {
    Reference reference;
    reference.name = parse_model();
    if (tokens_.accept(".")) reference.part = parse_plain_name("a callback").text;
    expect_end();
    return reference;
  }

  Formula parse_formula() {
    Formula formula;
    formula.file = text_.position(0).file;
    formula.begin = place_of_offset(0);
    const Token& first = tokens_.peek();
    if (first.is("forall") && !tokens_.peek(1).is("@") && !tokens_.peek(1).is(".")) {
      tokens_.next();
      formula.indices = terms_.parse_index_list("'forall i in 0..4:'");
      tokens_.expect(":", "behind the indices of 'forall'");
    }
    formula.root = terms_.parse_formula();
    const Token& rest = tokens_.peek();
    if (rest.is(")")) tokens_.fail("this ')' closes nothing", rest);
    terms_.fail_foreign(rest);
    if (!tokens_.at_end()) tokens_.fail("expected an operator, not " + to_string(rest), rest);
    return formula;
  }

 private:
  TextPlace place_of_offset(std::size_t offset) const {
    const SourcePosition position = text_.position(offset);
    return {position.line, position.column};
  }
  Code begin_code() const {
    Code code;
    code.file = text_.position(0).file;
    code.begin = place_of_offset(0);
    code.end = place_of_offset(text_.value().size());
    code.last = place_of_offset(text_.value().find_last_not_of(" \t\r\n"));
    return code;
  }
  void expect_end() {
    if (tokens_.at_end()) return;
    tokens_.fail("nothing may follow here, and there is " + to_string(tokens_.peek()),
                 tokens_.peek());
  }
  Name parse_plain_name(std::string_view what) {
    const Token token = tokens_.next();
    if (!token.is_name()) {
      tokens_.fail("expected " + std::string(what) + ", not " + to_string(token), token);
    }
    return to_name(tokens_, token);
  }

  // ---- Blocks -----------------------------------------------------------------------------------

  Block parse_block(std::string_view where) {
    const Token open = tokens_.peek();
    tokens_.expect("{", where);
    return close_block(open);
  }
  // The rest of a block.
  Block close_block(const Token& open) {
    deeper(open);
    Block block;
    while (!tokens_.accept("}")) {
      if (tokens_.at_end()) tokens_.fail("this '{' is not closed", open);
      block.statements.push_back(parse_statement());
    }
    --nesting_;
    return block;
  }
  void deeper(const Token& token) {
    if (++nesting_ > max_nesting) tokens_.fail("blocks are nested too deeply", token);
  }
  // Of a loop: `break` and `continue` may stand in it.
  Block parse_body(std::string_view where) {
    ++loops_;
    Block block = parse_block(where);
    --loops_;
    return block;
  }

  // ---- Statements -------------------------------------------------------------------------------

  // A word before `.` names a model, whatever the word is.
  bool is_keyword(std::string_view word) const {
    return tokens_.peek().kind == Token::Kind::identifier && tokens_.peek().is(word) &&
           !tokens_.peek(1).is(".");
  }
  bool accept_keyword(std::string_view word) {
    if (!is_keyword(word)) return false;
    tokens_.next();
    return true;
  }
  void expect_semicolon(std::string_view where = "at the end of the statement") {
    accept_origin();
    tokens_.expect(";", where);
  }
  bool is_at(std::size_t ahead) const {
    return tokens_.peek(ahead).is("at") && tokens_.peek(ahead + 1).kind == Token::Kind::quoted;
  }
  // `at "FILE:LINE"`, or with a column: what the statement was made from.
  void accept_origin() {
    if (!is_at(0)) return;
    tokens_.next();
    const Token token = tokens_.next();
    SourcePosition origin;
    origin.file = token.text;
    std::vector<int> numbers;
    while (numbers.size() < 2) {
      const std::size_t colon = origin.file.rfind(':');
      if (colon == std::string::npos) break;
      const std::string number = origin.file.substr(colon + 1);
      constexpr std::size_t most_digits = 8;
      const bool is_number = !number.empty() && number.size() <= most_digits &&
                             number.find_first_not_of("0123456789") == std::string::npos;
      if (!is_number) break;
      numbers.insert(numbers.begin(), std::stoi(number));
      origin.file.resize(colon);
    }
    if (numbers.empty() || origin.file.empty()) {
      tokens_.fail("behind 'at' stands a place, as in at \"node.cpp:12\"", token);
    }
    origin.line = numbers.front();
    if (numbers.size() > 1) origin.column = numbers.back();
    origin_ = std::move(origin);
  }

  Statement parse_statement() {
    Statement statement;
    while (tokens_.peek().is("@")) statement.labels.push_back(parse_label());
    const Token first = tokens_.peek();
    statement.place = tokens_.place(first);
    if (!statement.labels.empty() && (tokens_.at_end() || first.is("}"))) {
      tokens_.fail("a label stands before a statement; to mark this point write `@" +
                       statement.labels.back().text + " skip;`",
                   first);
    }
    if (!first.is_name()) tokens_.fail("expected a statement, not " + to_string(first), first);
    statement.is_idle = accept_keyword("idle");
    parse_simple(tokens_.peek(), statement);
    if (!origin_) accept_origin();  // behind a block
    statement.origin = std::exchange(origin_, std::nullopt);
    using Kind = Statement::Kind;
    if (statement.is_idle && statement.kind != Kind::give && statement.kind != Kind::give_arms &&
        statement.kind != Kind::wait && statement.kind != Kind::select) {
      tokens_.fail("'idle' stands before an input, a 'switch', a 'wait' or a 'select'", first);
    }
    return statement;
  }

  Name parse_label() {
    tokens_.expect("@", "before a label");
    const Token name = tokens_.next();
    if (!name.is_name()) {
      tokens_.fail("expected a label's name after '@', not " + to_string(name), name);
    }
    if (tokens_.peek().is(".") && name.kind == Token::Kind::identifier) {
      tokens_.fail("behind '@' stands the name of a label, and then a statement, as in `@here " +
                       name.text + ".input;`",
                   name);
    }
    if (name.text == "end") {
      tokens_.fail("the label 'end' is taken: it holds when the program has ended", name);
    }
    return to_name(tokens_, name);
  }

  void parse_simple(const Token& first, Statement& statement) {
    using Kind = Statement::Kind;
    if (accept_keyword("loop")) {
      statement.kind = Kind::loop;
      statement.body = parse_body("after 'loop'");
    } else if (accept_keyword("repeat")) {
      parse_repeat(statement);
    } else if (accept_keyword("if")) {
      parse_if(statement);
    } else if (accept_keyword("skip")) {
      expect_semicolon("after 'skip'");
    } else if (accept_keyword("stop")) {
      statement.kind = Kind::stop;
      expect_semicolon("after 'stop'");
    } else if (accept_keyword("wait")) {
      statement.kind = Kind::wait;
      statement.model = parse_model();
      tokens_.expect("->", "after 'wait " + statement.model.name.text + "'");
      statement.arms.push_back(parse_awaited(statement.model));
      expect_semicolon();
    } else if (accept_keyword("switch")) {
      statement.kind = Kind::give_arms;
      parse_give(statement);
      parse_arms(first, statement);
    } else if (accept_keyword("while")) {
      statement.kind = Kind::repeat_while;
      statement.expression = parse_condition("after 'while'");
      statement.body = parse_body("after 'while (...)'");
    } else if (accept_keyword("for")) {
      statement.kind = Kind::repeat_for;
      statement.name = parse_new_name("an index");
      tokens_.expect("in", "behind the index of a 'for'");
      statement.range = terms_.parse_range();
      statement.body = parse_body("after 'for k in LOW..HIGH'");
    } else if (accept_keyword("break") || accept_keyword("continue")) {
      statement.kind = first.is("break") ? Kind::leave : Kind::next_round;
      if (loops_ == 0) tokens_.fail("this '" + first.text + "' is in no loop", first);
      expect_semicolon("after '" + first.text + "'");
    } else if (accept_keyword("return")) {
      statement.kind = Kind::give_back;
      expect_semicolon("after 'return'");
    } else if (accept_keyword("call")) {
      parse_call(statement);
    } else if (accept_keyword("var")) {
      parse_declaration(statement);
    } else if (accept_keyword("atomic")) {
      parse_atomic(statement);
    } else if (tokens_.peek().is("when") && tokens_.peek(1).is("(")) {
      tokens_.next();
      statement.expression = parse_condition("after 'when'");
      if (!accept_keyword("atomic")) {
        tokens_.fail("outside of a 'select', 'atomic { ... }' stands behind 'when (...)', not " +
                         to_string(tokens_.peek()),
                     tokens_.peek());
      }
      parse_atomic(statement);
    } else if (accept_keyword("select")) {
      parse_select(first, statement);
    } else if (!parse_verb(first, statement)) {
      parse_named(first, statement);
    }
  }

  // `offer M;`, `run T;`: whether one stands here. These words are no keywords elsewhere.
  bool parse_verb(const Token& first, Statement& statement) {
    using Kind = Statement::Kind;
    const auto verb =
        std::ranges::find_if(verbs, [&](const auto& known) { return first.is(known.first); });
    if (verb == std::end(verbs) || first.kind != Token::Kind::identifier) return false;
    const bool is_alone = verb->second == Kind::unknown || verb->second == Kind::end;
    const bool may_be_alone = is_alone || verb->second == Kind::spin;
    const bool has_name = !is_alone && tokens_.peek(1).is_name() && !is_at(1);
    const bool ends_there = tokens_.peek(1).is(";") || is_at(1);
    if (!has_name && !(may_be_alone && ends_there)) return false;
    tokens_.next();
    statement.kind = verb->second;
    if (statement.kind == Kind::spin) {
      parse_spin(statement);
      return true;
    }
    if (statement.kind == Kind::run || statement.kind == Kind::join) {
      statement.name = parse_plain_name("a thread");
    } else if (statement.kind == Kind::kill || statement.kind == Kind::restart) {
      statement.name = parse_plain_name("an executor, program or process");
    } else if (!is_alone) {
      statement.model = parse_model();
    }
    expect_semicolon();
    return true;
  }

  // Behind `spin`.
  void parse_spin(Statement& statement) {
    using Spin = Statement::Spin;
    const auto accept = [&](std::string_view word, Spin spin) {
      if (tokens_.accept(word)) statement.spin = spin;
    };
    accept("once", Spin::once);
    accept("some", Spin::some);
    accept("all", Spin::all);
    const bool is_named = tokens_.peek().is_name() && !tokens_.peek().is("until") &&
                          !tokens_.peek().is("timeout") && !is_at(0);
    if (is_named) {
      statement.name = parse_plain_name("an executor");
    }
    if (statement.spin == Spin::ever) accept("until", Spin::until);
    const bool is_counted = statement.spin == Spin::some || statement.spin == Spin::all;
    if (is_counted && !tokens_.peek().is(";") && !is_at(0)) statement.expression = terms_.parse();
    if (statement.spin == Spin::until) {
      statement.model = parse_model();
      tokens_.expect("->", "after 'spin until " + statement.model.name.text + "'");
      statement.arms.push_back(parse_awaited(statement.model));
    }
    const bool may_be_late = statement.spin == Spin::until || statement.spin == Spin::once;
    if (may_be_late && tokens_.peek().is("timeout")) {
      parse_time_out(statement);
    } else {
      expect_semicolon();
    }
  }

  void parse_time_out(Statement& statement) {
    const TextPlace place = tokens_.place(tokens_.peek());
    statement.select_arms.push_back(parse_select_arm());
    statement.select_arms.back().place = place;
  }

  // What begins with a name: an input, or a variable that is set.
  void parse_named(const Token& first, Statement& statement) {
    if (!tokens_.peek(1).is(".")) require_statement(first);
    Term name = terms_.parse_name();
    if (tokens_.peek().is("=")) {
      statement.target = std::move(name);
      parse_assignment(statement);
      return;
    }
    statement.kind = Statement::Kind::give;
    statement.model = std::move(name);
    parse_event_of(statement);
    if (tokens_.accept("->")) statement.arms.push_back(parse_awaited(statement.model));
    if (statement.arms.empty() && tokens_.peek().is("timeout")) {
      return parse_time_out(statement);
    }
    expect_semicolon();
  }

  // Of a word that is no keyword and has no '.' behind it.
  void require_statement(const Token& first) const {
    const auto fail = [&](const std::string& what) {
      tokens_.fail("'" + first.text + what, first);
    };
    if (first.kind == Token::Kind::identifier) {
      if (first.is("else")) fail("' follows no 'if' block");
      if (first.is("quiet")) fail("' is an arm of 'switch'");
      if (contains(openers, first.text)) fail("' is a keyword here");
      const bool is_set = tokens_.peek(1).is("=") || tokens_.peek(1).is("[");
      if (contains(arm_words, first.text) && !is_set) {
        fail("' begins an arm of a 'select', and this is none");
      }
      if (first.is("elif") || first.is("elsif") || first.is("elseif")) {
        fail("' begins no statement; it is 'else if'");
      }
    }
    if (tokens_.peek(1).is("=") || tokens_.peek(1).is("[")) return;
    if (contains(declared_, first.text) || contains(names_.variables, first.text)) {
      fail("' is a variable: a statement sets it, as in `" + first.text + " = e;`");
    }
    if (contains(names_.constants, first.text)) fail("' is a constant, and begins no statement");
    if (contains(names_.procedures, first.text)) {
      fail("' is a procedure: a statement calls it, as in `call " + first.text + "(...);`");
    }
    if (contains(names_.models, first.text)) return;
    const std::vector<std::string> keywords(std::begin(openers), std::end(openers));
    std::vector<std::string> known = keywords;
    known.emplace_back("else if");
    for (const auto* names : {&names_.models, &declared_, &names_.variables}) {
      known.insert(known.end(), names->begin(), names->end());
    }
    const std::string near = did_you_mean(first.text, known);
    if (!near.empty()) fail("' begins no statement" + near);
    fail(
        "' begins no statement: one gives an input (`model.input;`), sets a variable (`x = e;`), "
        "or "
        "begins with " +
        join(keywords));
  }

  Term parse_condition(const std::string& where) {
    tokens_.expect("(", where);
    Term condition = terms_.parse();
    if (!tokens_.peek().is(")")) tokens_.fail_foreign(tokens_.peek());
    tokens_.expect(")", "behind a condition");
    return condition;
  }

  void parse_repeat(Statement& statement) {
    statement.kind = Statement::Kind::repeat;
    const Token first = tokens_.peek();
    if (first.kind != Token::Kind::number && !first.is_name() && !first.is("(") && !first.is("-")) {
      tokens_.fail("expected a number after 'repeat', not " + to_string(first), first);
    }
    statement.expression = terms_.parse_sum();
    statement.body = parse_body("after 'repeat N'");
  }

  void parse_if(Statement& statement) {
    using Kind = Statement::Kind;
    if (tokens_.peek().is("(")) {
      statement.kind = Kind::when;
      statement.expression = parse_condition("after 'if'");
      statement.body = parse_block("after 'if (...)'");
    } else {
      statement.kind = Kind::choice;
      statement.is_fair = tokens_.accept("fair");
      tokens_.expect("*", "after 'if' (`if *` is a choice, `if (e)` asks for a condition)");
      statement.body = parse_block("after 'if *'");
    }
    if (!tokens_.accept("else")) return;
    if (!is_keyword("if")) {
      statement.otherwise = parse_block("after 'else'");
      return;
    }
    deeper(tokens_.peek());
    statement.otherwise.statements.push_back(parse_statement());
    --nesting_;
  }

  // A name of the program's own.
  Name parse_new_name(std::string_view what) {
    const Token token = tokens_.next();
    if (!token.is_name()) {
      tokens_.fail("expected the name of " + std::string(what) + ", not " + to_string(token),
                   token);
    }
    Name name = to_name(tokens_, token);
    const bool is_taken = is_reserved(name) && !contains(arm_words, name.text);
    if (is_taken || name.is("true") || name.is("false") || name.is("any") || name.is("fair") ||
        name.is("bool")) {
      tokens_.fail("'" + token.text + "' is a keyword here", token);
    }
    return name;
  }

  // Behind `var`.
  void parse_declaration(Statement& statement) {
    statement.kind = Statement::Kind::declare;
    statement.name = parse_new_name("a variable");
    declared_.push_back(statement.name.text);
    if (tokens_.accept("[")) {
      statement.dimensions = terms_.parse_index_list("[i in 0..4]");
      tokens_.expect("]", "behind the indices");
    }
    tokens_.expect(":", "between a variable and its type");
    statement.type = parse_type();
    if (tokens_.accept("=")) {
      statement.is_any = tokens_.peek().is("any") && (tokens_.peek(1).is(";") || is_at(1));
      if (statement.is_any) {
        tokens_.next();
      } else {
        statement.expression = terms_.parse();
      }
    }
    expect_semicolon("at the end of a variable");
  }

  Type parse_type() {
    Type type;
    const Token first = tokens_.peek();
    type.place = tokens_.place(first);
    if (tokens_.accept("bool")) {
      type.is_boolean = true;
      return type;
    }
    if (!tokens_.accept("{")) {
      if (first.is_name() && (tokens_.peek(1).is(";") || tokens_.peek(1).is("="))) {
        tokens_.fail("a type is a range as `0..3`, `bool`, or words as `{idle, busy}`, and " +
                         to_string(first) + " is none of it",
                     first);
      }
      type.range = terms_.parse_range();
      return type;
    }
    do {
      const Token token = tokens_.peek();
      Name word = parse_plain_name("a word");
      for (const Name& other : type.words) {
        if (other.text == word.text) tokens_.fail("'" + word.text + "' is there twice", token);
      }
      type.words.push_back(std::move(word));
    } while (tokens_.accept(","));
    tokens_.expect("}", "behind the words");
    return type;
  }

  void parse_assignment(Statement& statement) {
    statement.kind = Statement::Kind::assign;
    tokens_.expect("=", "behind a variable");
    if (!tokens_.peek().is("any") || tokens_.peek(1).is(";")) {
      statement.expression = terms_.parse();
      expect_semicolon();
      return;
    }
    tokens_.next();
    statement.kind = Statement::Kind::choose;
    statement.is_fair = tokens_.accept("fair");
    statement.range = terms_.parse_range();
    expect_semicolon();
  }

  void parse_atomic(Statement& statement) {
    statement.kind = Statement::Kind::atomic;
    statement.body = parse_block("after 'atomic'");
    check_atomic(statement.body);
  }

  void check_atomic(const Block& block) const {
    for (const Statement& statement : block.statements) {
      using Kind = Statement::Kind;
      const SourcePosition place{text_.position(0).file, statement.place.line,
                                 statement.place.column};
      if (statement.kind != Kind::assign && statement.kind != Kind::when &&
          statement.kind != Kind::repeat_for && statement.kind != Kind::skip) {
        throw ParseError("in 'atomic' stand assignments, 'if (...)' and 'for' alone", place);
      }
      if (!statement.labels.empty()) {
        throw ParseError("control does not stop inside of 'atomic', so no label stands there",
                         place);
      }
      check_atomic(statement.body);
      check_atomic(statement.otherwise);
    }
  }

  void parse_call(Statement& statement) {
    statement.kind = Statement::Kind::call;
    statement.name = parse_plain_name("a procedure's name");
    tokens_.expect("(", "behind a procedure's name");
    while (!tokens_.accept(")")) {
      if (!statement.arguments.empty()) tokens_.expect(",", "between arguments");
      statement.arguments.push_back(terms_.parse());
    }
    expect_semicolon();
  }

  // ---- Models, inputs, outputs ------------------------------------------------------------------

  Term parse_model() {
    if (!tokens_.peek().is_name()) {
      tokens_.fail("expected a model instance, not " + to_string(tokens_.peek()), tokens_.peek());
    }
    return terms_.parse_name();
  }

  void parse_give(Statement& statement) {
    statement.model = parse_model();
    parse_event_of(statement);
  }
  void parse_event_of(Statement& statement) {
    tokens_.expect(".", "after model '" + statement.model.name.text + "'");
    statement.event = parse_event(statement.model, "input", false);
  }

  // `may_declare`: an output, which may declare the variables that take its values.
  Event parse_event(const Term& model, std::string_view what, bool may_declare) {
    const Token name = tokens_.next();
    if (!name.is_name()) {
      tokens_.fail("expected an " + std::string(what) +
                       (model.is_name() ? " of " + model.name.text : "") + ", not " +
                       to_string(name),
                   name);
    }
    Event event;
    event.name = to_name(tokens_, name);
    if (!tokens_.accept("(")) return event;
    event.has_arguments = true;
    do {
      Argument argument;
      if (may_declare && tokens_.accept("var")) {
        argument.is_declared = true;
        argument.term.kind = Term::Kind::name;
        argument.term.name = parse_new_name("a variable");
        argument.term.place = argument.term.begin = argument.term.name.place;
      } else {
        argument.term = terms_.parse();
      }
      event.arguments.push_back(std::move(argument));
    } while (tokens_.accept(","));
    tokens_.expect(")", "behind the values");
    return event;
  }

  // ---- Arms -------------------------------------------------------------------------------------

  Arm begin_arm() const {
    Arm arm;
    arm.place = tokens_.place(tokens_.peek());
    return arm;
  }
  Arm parse_awaited(const Term& model) {
    if (tokens_.peek().is("quiet")) {
      tokens_.fail("'quiet' is no output: it is an arm of `switch M.input { quiet { } }`",
                   tokens_.peek());
    }
    Arm arm = begin_arm();
    arm.output = parse_event(model, "output", true);
    return arm;
  }
  Arm parse_arm(const Term& model, bool may_be_quiet) {
    const Token name = tokens_.peek();
    Arm arm = begin_arm();
    arm.is_quiet = may_be_quiet && tokens_.accept("quiet");
    if (!arm.is_quiet) arm.output = parse_event(model, "output", true);
    arm.body = parse_block("after " + to_string(name));
    return arm;
  }
  void parse_arms(const Token& first, Statement& statement) {
    tokens_.expect("{", "after the input of 'switch'");
    while (!tokens_.accept("}")) {
      if (tokens_.at_end()) tokens_.fail("this 'switch' is not closed", first);
      statement.arms.push_back(parse_arm(statement.model, true));
    }
    if (statement.arms.empty()) tokens_.fail("this 'switch' has no arm", first);
  }

  void parse_select(const Token& first, Statement& statement) {
    using Kind = SelectArm::Kind;
    statement.kind = Statement::Kind::select;
    tokens_.expect("{", "after 'select'");
    bool has_default = false;
    while (!tokens_.accept("}")) {
      const Token begin = tokens_.peek();
      if (tokens_.at_end()) tokens_.fail("this 'select' is not closed", first);
      SelectArm arm = parse_select_arm();
      arm.place = tokens_.place(begin);
      const bool is_default = arm.kind == Kind::otherwise || arm.kind == Kind::timeout;
      if (is_default && has_default) {
        tokens_.fail("a 'select' has one 'otherwise' or one 'timeout'", begin);
      }
      has_default = has_default || is_default;
      statement.select_arms.push_back(std::move(arm));
    }
    if (statement.select_arms.empty()) tokens_.fail("this 'select' has no arm", first);
  }

  SelectArm parse_select_arm() {
    using Kind = SelectArm::Kind;
    SelectArm arm;
    const Token first = tokens_.peek();
    if (tokens_.accept("otherwise")) {
      arm.kind = Kind::otherwise;
      arm.body = parse_block("after 'otherwise'");
      return arm;
    }
    if (tokens_.accept("timeout")) {
      arm.kind = Kind::timeout;
      if (tokens_.peek().is("{")) {
        tokens_.fail("a 'timeout' says how many milliseconds, as in `timeout 100 { }`",
                     tokens_.peek());
      }
      arm.milliseconds = terms_.parse_sum();
      arm.body = parse_block("after 'timeout N'");
      return arm;
    }
    if (tokens_.accept("when")) arm.guard = parse_condition("after 'when'");
    if (!tokens_.accept("on")) {
      if (!arm.guard) {
        tokens_.fail(
            "expected an arm, which begins with 'on', 'when', 'otherwise' or 'timeout', not " +
                to_string(first),
            first);
      }
      arm.body = parse_block("after 'when (...)'");
      return arm;
    }
    parse_on(arm);
    return arm;
  }

  void parse_on(SelectArm& arm) {
    using Kind = SelectArm::Kind;
    arm.model = parse_model();
    if (tokens_.accept("!")) {
      arm.kind = Kind::output;
      arm.event = parse_event(arm.model, "output", true);
      arm.body = parse_block("after an output");
      return;
    }
    arm.kind = Kind::input;
    tokens_.expect(".", "after model '" + arm.model.name.text + "'");
    arm.event = parse_event(arm.model, "input", false);
    if (tokens_.accept("->")) {
      arm.has_arms = true;
      arm.arms.push_back(parse_arm(arm.model, false));
      return;
    }
    const Token open = tokens_.peek();
    tokens_.expect("{", "after the input of an arm");
    arm.has_arms = begins_outputs();
    if (!arm.has_arms) {
      arm.body = close_block(open);
      return;
    }
    while (!tokens_.accept("}")) {
      if (tokens_.at_end()) tokens_.fail("this '{' is not closed", open);
      arm.arms.push_back(parse_arm(arm.model, false));
    }
  }

  // Behind `on M.input {`: outputs and what is done then, no statements.
  bool begins_outputs() const {
    const Token& first = tokens_.peek();
    if (!first.is_name() ||
        (first.kind == Token::Kind::identifier && contains(openers, first.text))) {
      return false;
    }
    return tokens_.peek(1).is("{") || tokens_.peek(1).is("(");
  }

  const ScalarText& text_;
  const KnownNames& names_;
  std::vector<std::string> declared_;  // variables of the text so far
  TokenStream tokens_;
  TermParser terms_;
  std::optional<SourcePosition> origin_;  // of the statement that is being read
  int nesting_ = 0, loops_ = 0;
};

}  // namespace

bool is_reserved(const Name& word) {
  return !word.is_quoted && (contains(openers, word.text) || contains(others, word.text) ||
                             contains(arm_words, word.text));
}

Code parse_program(const ScalarText& text, const KnownNames& names) {
  return CodeParser(text, names).parse_code("a program");
}
Code parse_callback(const ScalarText& text, const KnownNames& names) {
  return CodeParser(text, names).parse_code("a callback");
}
Code parse_procedure(const ScalarText& text, const KnownNames& names) {
  return CodeParser(text, names).parse_code("");
}
Code parse_variables(const ScalarText& text) { return CodeParser(text).parse_variables(); }
Term parse_expression(const ScalarText& text) { return CodeParser(text).parse_expression(); }
Timer parse_timer(const ScalarText& text) { return CodeParser(text).parse_timer(); }
Taken parse_taken(const ScalarText& text) { return CodeParser(text).parse_taken(); }
Event parse_output(const ScalarText& text) { return CodeParser(text).parse_output_alone(); }
Declared parse_declared(const ScalarText& text) { return CodeParser(text).parse_declared(); }
Head parse_head(const ScalarText& text) { return CodeParser(text).parse_head(); }
Formula parse_formula(const ScalarText& text) { return CodeParser(text).parse_formula(); }

Reference parse_reference(const ScalarText& text) {
  Reference reference;
  if (text.value().find('[') != std::string::npos) {
    reference = CodeParser(text).parse_reference();
  } else {
    const SourcePosition place = text.position(0);
    reference.name.kind = Term::Kind::name;
    reference.name.name = {text.value(), true, {place.line, place.column}};
    reference.name.place = reference.name.begin = reference.name.name.place;
  }
  reference.file = text.position(0).file;
  reference.text = text.value();
  return reference;
}

}  // namespace maide::syntax
