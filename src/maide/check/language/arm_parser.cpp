// The arms of `switch`, `wait` and `select`, and what makes two arms of one statement the same.
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "maide/check/language/program_parser.hpp"

namespace maide::program_syntax {

Arm ProgramParser::begin_arm(bool is_quiet) {
  const SourcePosition place = tokens_.position(tokens_.peek());
  Arm arm;
  arm.line = place.line;
  arm.column = place.column;
  arm.is_quiet = is_quiet;
  if (is_quiet) tokens_.next();
  return arm;
}

Arm ProgramParser::parse_awaited(const ModelReference& model) {
  if (tokens_.peek().is("quiet")) {
    tokens_.fail("'quiet' is no output: it is an arm of `switch M.input { quiet { } }`",
                 tokens_.peek());
  }
  Arm arm = begin_arm(false);
  arm.output = parse_output(model);
  arm.body = std::make_unique<Block>();
  return arm;
}

Arm ProgramParser::parse_arm(const ModelReference& model, bool may_be_quiet) {
  const Token name = tokens_.peek();
  Arm arm = begin_arm(may_be_quiet && name.is("quiet"));
  auto block = open_block();
  if (!arm.is_quiet) arm.output = parse_output(model);
  arm.body = close_block(std::move(block), "after " + to_string(name));
  return arm;
}

bool ProgramParser::is_same(const Arm& one, const Arm& other) {
  if (one.is_quiet || other.is_quiet) return one.is_quiet == other.is_quiet;
  const Event &a = one.output, &b = other.output;
  if (a.name != b.name || a.arguments.size() != b.arguments.size()) return false;
  for (std::size_t i = 0; i < a.arguments.size(); ++i) {
    const auto &x = a.arguments[i], &y = b.arguments[i];
    if (x.binds && y.binds) continue;
    if (x.binds || y.binds || !x.expression.is_constant() || !y.expression.is_constant() ||
        x.expression.value != y.expression.value) {
      return false;
    }
  }
  return true;
}

bool ProgramParser::is_same(const Expression& one, const Expression& other) {
  if (one.op != other.op || one.index != other.index || one.value != other.value ||
      one.operands.size() != other.operands.size()) {
    return false;
  }
  for (std::size_t i = 0; i < one.operands.size(); ++i) {
    if (!is_same(one.operands[i], other.operands[i])) return false;
  }
  return true;
}

void ProgramParser::add_arm(std::vector<Arm>& arms, Arm arm, const Token& name,
                            std::string_view what) {
  for (const Arm& other : arms) {
    if (is_same(other, arm)) {
      tokens_.fail("this '" + std::string(what) + "' has two arms for " + to_string(name), name);
    }
  }
  arms.push_back(std::move(arm));
}

void ProgramParser::parse_arms(const Token& first, Statement& statement) {
  tokens_.expect("{", "after the input of 'switch'");
  while (!tokens_.accept("}")) {
    const Token name = tokens_.peek();
    if (name.kind == Token::Kind::end) tokens_.fail("this 'switch' is not closed", first);
    add_arm(statement.arms, parse_arm(statement.model, true), name, "switch");
  }
  if (statement.arms.empty()) tokens_.fail("this 'switch' has no arm", first);
}

// ---- select -------------------------------------------------------------------------------------

void ProgramParser::parse_select(const Token& first, Statement& statement) {
  statement.kind = Statement::Kind::select;
  tokens_.expect("{", "after 'select'");
  while (!tokens_.accept("}")) {
    const Token begin = tokens_.peek();
    if (begin.kind == Token::Kind::end) tokens_.fail("this 'select' is not closed", first);
    SelectArm arm = parse_select_arm();
    const SourcePosition place = tokens_.position(begin);
    arm.line = place.line;
    arm.column = place.column;
    check_distinct(statement.select_arms, arm, begin);
    statement.select_arms.push_back(std::move(arm));
  }
  if (statement.select_arms.empty()) tokens_.fail("this 'select' has no arm", first);
}

void ProgramParser::check_distinct(const std::vector<SelectArm>& arms, const SelectArm& arm,
                                   const Token& begin) {
  using Kind = SelectArm::Kind;
  const auto waits = [](const SelectArm& other) {
    return other.kind == Kind::otherwise || other.kind == Kind::timeout;
  };
  for (const SelectArm& other : arms) {
    if (waits(arm) && waits(other)) {
      tokens_.fail("a 'select' has one 'otherwise' or one 'timeout'", begin);
    }
    if (arm.kind != Kind::input || other.kind != Kind::input) continue;
    if (arm.model.is_topic != other.model.is_topic) continue;
    if (arm.event.name != other.event.name || !is_same(arm.model.leaf, other.model.leaf)) continue;
    if (arm.event.has_arguments || other.event.has_arguments) continue;
    tokens_.fail("this 'select' has two arms for " + arm.model.name() + "." + arm.event.name +
                     ": put what may come into the braces of one",
                 begin);
  }
}

SelectArm ProgramParser::parse_select_arm() {
  using Kind = SelectArm::Kind;
  SelectArm arm;
  arm.callback = context_.callback;
  const Token first = tokens_.peek();
  if (tokens_.accept("otherwise")) {
    arm.kind = Kind::otherwise;
    arm.body = parse_block("after 'otherwise'");
    return arm;
  }
  if (tokens_.accept("timeout")) {
    arm.kind = Kind::timeout;
    const Token number = tokens_.peek();
    if (number.is("{")) {
      tokens_.fail("a 'timeout' says how many milliseconds, as in `timeout 100 { }`", number);
    }
    if (expressions_.parse_constant("a time-out") < 0) {
      tokens_.fail("a time-out is some milliseconds", number);
    }
    arm.body = parse_block("after 'timeout N'");
    return arm;
  }
  if (tokens_.accept("when")) arm.guard = parse_condition("after 'when'");
  if (!tokens_.accept("on")) {
    if (!arm.guard) {
      tokens_.fail(
          "expected an arm, which begins with 'on', 'when', 'otherwise' or 'timeout', "
          "not " +
              to_string(first),
          first);
    }
    arm.body = parse_block("after 'when (...)'");
    return arm;
  }
  arm.model = parse_model();
  if (tokens_.accept("!")) {
    arm.kind = Kind::output;
    auto block = open_block();
    arm.event = parse_output(arm.model);
    arm.body = close_block(std::move(block), "after an output");
    return arm;
  }
  arm.kind = Kind::input;
  tokens_.expect(".", "after model '" + arm.model.name() + "'");
  arm.event = parse_input(arm.model);
  if (tokens_.accept("->")) {
    arm.arms.push_back(parse_arm(arm.model, false));
    return arm;
  }
  const Token open = tokens_.peek();
  tokens_.expect("{", "after the input of an arm");
  if (!begins_outputs()) {
    arm.body = close_open_block(open_block(), open);
    return arm;
  }
  while (!tokens_.accept("}")) {
    const Token name = tokens_.peek();
    if (name.kind == Token::Kind::end) tokens_.fail("this '{' is not closed", open);
    add_arm(arm.arms, parse_arm(arm.model, false), name, "on");
  }
  return arm;
}

bool ProgramParser::begins_outputs() const {
  const Token& first = tokens_.peek();
  if (!first.is_name()) return false;
  if (begins_statement(first)) return false;
  return tokens_.peek(1).is("{") || tokens_.peek(1).is("(");
}

}  // namespace maide::program_syntax
