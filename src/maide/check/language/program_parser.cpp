#include "maide/check/language/program_parser.hpp"

#include <algorithm>
#include <optional>
#include <tuple>
#include <utility>

#include "maide/base/text.hpp"
#include "maide/formats/names.hpp"

namespace maide::program_syntax {
namespace {

constexpr int max_nesting = 200;                 // of blocks and calls: the parser recurses
constexpr std::size_t max_statements = 200'000;  // with procedures in their places

}  // namespace

void ProgramParser::parse_program() {
  Block& block = work_.tree.statements;
  work_.scopes.push_back({{}, &block, false});
  declare_own();
  parse_statements(block);
  work_.scopes.pop_back();
  if (block.statements.empty()) {
    tokens_.fail("a program has no statement; one that does nothing is written `skip;`",
                 tokens_.peek());
  }
}

void ProgramParser::parse_statements(Block& block) {
  while (tokens_.peek().kind != Token::Kind::end) {
    if (tokens_.peek().is("}")) tokens_.fail("this '}' closes nothing", tokens_.peek());
    block.statements.push_back(parse_statement());
  }
}

std::unique_ptr<Block> ProgramParser::open_block() {
  auto block = std::make_unique<Block>();
  work_.scopes.push_back({{}, block.get(), false});
  return block;
}

std::unique_ptr<Block> ProgramParser::close_block(std::unique_ptr<Block> block,
                                                  std::string_view where) {
  const Token open = tokens_.peek();
  tokens_.expect("{", where);
  return close_open_block(std::move(block), open);
}

std::unique_ptr<Block> ProgramParser::close_open_block(std::unique_ptr<Block> block,
                                                       const Token& open) {
  if (++work_.nesting > max_nesting) tokens_.fail("blocks are nested too deeply", open);
  while (!tokens_.accept("}")) {
    if (tokens_.peek().kind == Token::Kind::end) tokens_.fail("this '{' is not closed", open);
    block->statements.push_back(parse_statement());
  }
  --work_.nesting;
  work_.scopes.pop_back();
  return block;
}

std::unique_ptr<Block> ProgramParser::parse_block(std::string_view where) {
  return close_block(open_block(), where);
}

std::unique_ptr<Block> ProgramParser::parse_body(std::string_view where) {
  ++work_.loops;
  auto block = parse_block(where);
  --work_.loops;
  return block;
}

Statement ProgramParser::parse_statement() {
  Statement statement;
  while (tokens_.peek().is("@")) statement.labels.push_back(parse_label());
  const Token first = tokens_.peek();
  if (++work_.statements > max_statements) {
    tokens_.fail("with its procedures, this program has more than " +
                     std::to_string(max_statements) + " statements",
                 first);
  }
  const SourcePosition place = tokens_.position(first);
  statement.line = place.line;
  statement.column = place.column;
  statement.callback = context_.callback;
  if (!statement.labels.empty() && (first.kind == Token::Kind::end || first.is("}"))) {
    tokens_.fail("a label stands before a statement; to mark this point write `@" +
                     work_.tree.labels[statement.labels.back()] + " skip;`",
                 first);
  }
  if (!first.is_name()) tokens_.fail("expected a statement, not " + to_string(first), first);
  if (accept_keyword("idle")) {
    if (context_.callback != nullptr) {
      tokens_.fail("a callback does not rest: its thread waits for its end", first);
    }
    statement.is_idle = true;
    parse_simple(tokens_.peek(), statement);
    using Kind = Statement::Kind;
    if (statement.kind != Kind::give && statement.kind != Kind::wait &&
        statement.kind != Kind::select) {
      tokens_.fail("'idle' stands before an input, a 'switch', a 'wait' or a 'select'", first);
    }
  } else {
    parse_simple(first, statement);
  }
  return statement;
}

bool ProgramParser::is_keyword(std::string_view word) const {
  return tokens_.peek().kind == Token::Kind::identifier && tokens_.peek().is(word) &&
         !tokens_.peek(1).is(".");
}

bool ProgramParser::accept_keyword(std::string_view word) {
  if (!is_keyword(word)) return false;
  tokens_.next();
  return true;
}

void ProgramParser::expect_semicolon(std::string_view where) { tokens_.expect(";", where); }

void ProgramParser::parse_simple(const Token& first, Statement& statement) {
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
    statement.kind = context_.callback != nullptr ? Kind::leave_callback : Kind::stop;
    expect_semicolon("after 'stop'");
  } else if (accept_keyword("wait")) {
    statement.kind = Kind::wait;
    statement.model = parse_model();
    tokens_.expect("->", "after 'wait " + statement.model.name() + "'");
    statement.arms.push_back(parse_awaited(statement.model));
    expect_semicolon();
  } else if (accept_keyword("switch")) {
    parse_give(statement);
    parse_arms(first, statement);
  } else if (accept_keyword("while")) {
    statement.kind = Kind::repeat_while;
    statement.expression = parse_condition("after 'while'");
    statement.body = parse_body("after 'while (...)'");
  } else if (accept_keyword("for")) {
    parse_for(statement);
  } else if (accept_keyword("break") || accept_keyword("continue")) {
    statement.kind = first.is("break") ? Kind::leave : Kind::next_round;
    if (work_.loops == 0) tokens_.fail("this '" + first.text + "' is in no loop", first);
    expect_semicolon("after '" + first.text + "'");
  } else if (accept_keyword("return")) {
    statement.kind = !work_.calls.empty()           ? Kind::leave_procedure
                     : context_.callback != nullptr ? Kind::leave_callback
                                                    : Kind::stop;
    expect_semicolon("after 'return'");
  } else if (accept_keyword("call")) {
    parse_call(statement);
  } else if (accept_keyword("var")) {
    parse_declaration(statement);
  } else if (accept_keyword("atomic")) {
    statement.kind = Kind::atomic;
    statement.body = parse_block("after 'atomic'");
    check_atomic(*statement.body);
  } else if (accept_keyword("select")) {
    parse_select(first, statement);
  } else if (is_target()) {
    parse_assignment(statement);
  } else {
    if (!tokens_.peek(1).is(".")) require_model(first);
    parse_give(statement);
    if (tokens_.accept("->")) statement.arms.push_back(parse_awaited(statement.model));
    expect_semicolon();
  }
}

bool ProgramParser::is_target() const {
  if (tokens_.peek(1).is("=")) return true;
  if (!tokens_.peek(1).is("[")) return false;
  const auto binding = find(tokens_.peek().text);
  return binding && binding->kind == Binding::Kind::variable;
}

void ProgramParser::require_model(const Token& first) const {
  const auto fail = [&](const std::string& what) { tokens_.fail("'" + first.text + what, first); };
  const auto binding = find(first.text);
  if (first.kind == Token::Kind::identifier) {
    if (first.is("else")) fail("' follows no 'if' block");
    if (first.is("quiet")) fail("' is an arm of 'switch'");
    if (is_reserved(first)) fail("' begins an arm of a 'select', and this is none");
  }
  if (binding) {
    if (binding->kind == Binding::Kind::variable) {
      fail("' is a variable: a statement sets it, as in `" + first.text + " = e;`");
    }
    if (binding->kind == Binding::Kind::constant) fail("' is a constant, and begins no statement");
    return;
  }
  const auto& procedures = context_.names.procedures;
  if (procedures.contains(first.text)) {
    fail("' is a procedure: a statement calls it, as in `call " + first.text + "(...);`");
  }
  if (first.is("elif") || first.is("elsif") || first.is("elseif")) {
    fail("' begins no statement; it is 'else if'");
  }
  std::vector<std::string> known = statement_keywords();
  known.emplace_back("else if");
  for (const auto& [name, model] : context_.names.models) known.push_back(name);
  for (std::string& name : names_of_variables()) known.push_back(std::move(name));
  const std::string near = did_you_mean(first.text, known);
  if (!near.empty()) fail("' begins no statement" + near);
  fail(
      "' begins no statement: one gives an input (`model.input;`), sets a variable (`x = e;`), or "
      "begins with " +
      join(statement_keywords()));
}

std::uint32_t ProgramParser::parse_label() {
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
  auto& labels = work_.tree.labels;
  const SourcePosition place = tokens_.position(name);
  const std::string label =
      context_.callback != nullptr ? context_.callback->whole_name() + "@" + name.text : name.text;
  const auto [known, is_new] = work_.label_places.try_emplace(label, place);
  if (is_new) {
    labels.push_back(label);
    return static_cast<std::uint32_t>(labels.size() - 1);
  }
  // In another copy of a procedure it is the same label.
  if (known->second.line != place.line || known->second.column != place.column) {
    tokens_.fail("the label '" + name.text + "' stands before two statements", name);
  }
  return static_cast<std::uint32_t>(std::find(labels.begin(), labels.end(), label) -
                                    labels.begin());
}

Expression ProgramParser::parse_condition(const std::string& where) {
  tokens_.expect("(", where);
  const Token first = tokens_.peek();
  Expression condition = expressions_.parse();
  if (!tokens_.peek().is(")")) tokens_.fail_foreign(tokens_.peek());
  require(condition, ValueKind::boolean, "a condition", tokens_.position(first));
  tokens_.expect(")", "behind a condition");
  return condition;
}

void ProgramParser::parse_repeat(Statement& statement) {
  statement.kind = Statement::Kind::repeat;
  const Token first = tokens_.peek();
  if (first.kind != Token::Kind::number && !first.is_name() && !first.is("(") && !first.is("-")) {
    tokens_.fail("expected a number after 'repeat', not " + to_string(first), first);
  }
  Expression count = without_shared(expressions_.parse_sum(), first, "'repeat'");
  require(count, ValueKind::integer, "the number of a 'repeat'", tokens_.position(first));
  if (count.is_constant() && count.value > static_cast<Value>(max_control_states)) {
    tokens_.fail("'repeat' goes up to " + std::to_string(max_control_states), first);
  }
  if (count.is_constant() && count.value < 0) {
    tokens_.fail("'repeat' goes from 0 on, and this is " + std::to_string(count.value), first);
  }
  statement.expression = std::move(count);
  statement.body = parse_body("after 'repeat N'");
}

void ProgramParser::parse_if(Statement& statement) {
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
  statement.otherwise = std::make_unique<Block>();
  if (!tokens_.accept("else")) return;
  if (!is_keyword("if")) {
    statement.otherwise = parse_block("after 'else'");
    return;
  }
  if (++work_.nesting > max_nesting) tokens_.fail("blocks are nested too deeply", tokens_.peek());
  auto block = open_block();
  block->statements.push_back(parse_statement());
  work_.scopes.pop_back();
  --work_.nesting;
  statement.otherwise = std::move(block);
}

void ProgramParser::parse_bounds(Statement& statement, std::string_view what) {
  const Token first = tokens_.peek();
  statement.expression = without_shared(expressions_.parse_sum(), first, what);
  tokens_.expect("..", "between the least and the greatest");
  statement.upper = without_shared(expressions_.parse_sum(), first, what);
  require(*statement.expression, ValueKind::integer, what, tokens_.position(first));
  require(statement.upper, ValueKind::integer, what, tokens_.position(first));
}

void ProgramParser::parse_for(Statement& statement) {
  statement.kind = Statement::Kind::repeat_for;
  const Token name = parse_new_name("an index");
  tokens_.expect("in", "behind the index of a 'for'");
  parse_bounds(statement, "a bound of a 'for'");
  statement.type = type_of(*statement.expression);
  statement.type.high = std::max(statement.type.high, type_of(statement.upper).high);
  auto block = open_block();
  statement.target = declare(name, statement.type, {}, true);
  ++work_.loops;
  statement.body = close_block(std::move(block), "after 'for k in LOW..HIGH'");
  --work_.loops;
}

void ProgramParser::parse_declaration(Statement& statement) {
  statement.kind = Statement::Kind::assign;
  const Token name = parse_new_name("a variable");
  const Dimensions dimensions = parse_dimensions();
  tokens_.expect(":", "between a variable and its type");
  statement.type = parse_type();
  statement.expression = tokens_.accept("=")
                             ? parse_value_for(statement.type, name.text)
                             : make_constant(statement.type.at(0), statement.type.kind);
  statement.target = declare(name, statement.type, dimensions);
  statement.target.line = statement.line;
  statement.target.column = statement.column;
  statement.slots = static_cast<std::uint32_t>(member_count(dimensions));
  expect_semicolon();
}

void ProgramParser::parse_assignment(Statement& statement) {
  statement.kind = Statement::Kind::assign;
  const Token name = tokens_.peek();
  std::tie(statement.target, statement.type) = parse_target();
  tokens_.expect("=", "behind a variable");
  if (!tokens_.peek().is("any") || tokens_.peek(1).is(";")) {
    statement.expression = parse_value_for(statement.type, name.text);
    expect_semicolon();
    return;
  }
  tokens_.next();
  statement.kind = Statement::Kind::choose;
  statement.is_fair = tokens_.accept("fair");
  const Token first = tokens_.peek();
  parse_bounds(statement, "a bound of 'any'");
  require(make_constant(0, statement.type.kind), ValueKind::integer, "what 'any' chooses",
          tokens_.position(name));
  if (statement.expression->is_constant() && statement.upper.is_constant() &&
      statement.expression->value > statement.upper.value) {
    tokens_.fail("'any' goes from the least to the greatest", first);
  }
  expect_semicolon();
}

void ProgramParser::check_atomic(const Block& block) {
  for (const Statement& statement : block.statements) {
    using Kind = Statement::Kind;
    const SourcePosition place{work_.position.file, statement.line, statement.column};
    const bool is_assignment = statement.kind == Kind::assign && statement.slots == 0;
    if (!is_assignment && statement.kind != Kind::when && statement.kind != Kind::skip) {
      throw ParseError("in 'atomic' stand assignments and 'if (...)' alone", place);
    }
    if (!statement.labels.empty()) {
      throw ParseError("control does not stop inside of 'atomic', so no label stands there", place);
    }
    if (statement.body) check_atomic(*statement.body);
    if (statement.otherwise) check_atomic(*statement.otherwise);
  }
}

void ProgramParser::parse_call(Statement& statement) {
  statement.kind = Statement::Kind::inner;
  const Token name = tokens_.next();
  const auto& procedures = context_.names.procedures;
  const auto known = procedures.find(name.text);
  if (known == procedures.end()) {
    std::vector<std::string> names;
    for (const auto& [other, procedure] : procedures) names.push_back(other);
    tokens_.fail(
        "unknown procedure '" + name.text + "'; there is: " + known_instead(name.text, names),
        name);
  }
  if (contains(work_.calls, name.text)) {
    tokens_.fail(
        "procedure '" + name.text + "' calls itself: " + join(work_.calls) + ", " + name.text,
        name);
  }
  if (++work_.nesting > max_nesting) tokens_.fail("calls are nested too deeply", name);
  const Procedure& procedure = known->second;
  Scope scope;
  scope.is_barrier = true;
  tokens_.expect("(", "behind a procedure's name");
  for (std::size_t i = 0; !tokens_.accept(")"); ++i) {
    if (i > 0) tokens_.expect(",", "between arguments");
    if (i == procedure.parameters.size()) fail_argument_count(procedure, name);
    scope.names.emplace(procedure.parameters[i], parse_call_argument());
  }
  if (scope.names.size() != procedure.parameters.size()) fail_argument_count(procedure, name);
  expect_semicolon();
  statement.body = std::make_unique<Block>();
  statement.body->is_procedure = true;
  scope.block = statement.body.get();
  work_.scopes.push_back(std::move(scope));
  work_.calls.push_back(name.text);
  const int loops = std::exchange(work_.loops, 0);
  ProgramParser(procedure.text, work_).parse_procedure(*statement.body);
  work_.loops = loops;
  work_.calls.pop_back();
  work_.scopes.pop_back();
  --work_.nesting;
}

void ProgramParser::fail_argument_count(const Procedure& procedure, const Token& name) {
  tokens_.fail("procedure '" + name.text + "' takes " +
                   std::to_string(procedure.parameters.size()) +
                   (procedure.parameters.size() == 1 ? " argument: " : " arguments: ") + name.text +
                   "(" + join(procedure.parameters) + ")",
               name);
}

Binding ProgramParser::parse_call_argument() {
  const Token first = tokens_.peek();
  auto binding = first.is_name() ? find(first.text) : std::nullopt;
  if (!binding || binding->kind == Binding::Kind::constant) {
    Expression value = expressions_.parse();
    if (!value.is_constant()) {
      tokens_.fail("an argument is a constant, a model or a variable", first);
    }
    return {Binding::Kind::constant, std::move(value), {}, false};
  }
  tokens_.next();
  Expression& leaf = binding->expression;
  const SourcePosition place = tokens_.position(first);
  leaf.line = place.line;
  leaf.column = place.column;
  if (tokens_.peek().is("[") && leaf.operands.empty()) {
    leaf.operands = expressions_.parse_indices(leaf.dimensions, first);
  }
  if (!tokens_.peek().is(",") && !tokens_.peek().is(")")) {
    tokens_.fail("an argument is a constant, a model or a variable", first);
  }
  return *binding;
}

void ProgramParser::parse_give(Statement& statement) {
  statement.kind = Statement::Kind::give;
  statement.model = parse_model();
  tokens_.expect(".", "after model '" + statement.model.name() + "'");
  statement.input = parse_input(statement.model);
}

Tree parse(const ScalarText& text, const Context& context) {
  Work work(context, text);
  ProgramParser(text, work).parse_program();
  work.tree.names.assign(work.names.begin(), work.names.end());
  return std::move(work.tree);
}

}  // namespace maide::program_syntax
