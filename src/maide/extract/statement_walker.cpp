#include "maide/extract/statement_walker.hpp"

#include <algorithm>
#include <functional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "maide/extract/call_walker.hpp"
#include "maide/extract/expression_walker.hpp"
#include "maide/extract/finite_loop.hpp"
#include "maide/extract/lock_keeper.hpp"
#include "maide/extract/object_maker.hpp"
#include "maide/extract/row_reader.hpp"
#include "maide/extract/type_names.hpp"

namespace maide::extract {
namespace {

using Form = Expression::Kind;

Code leave_loop() {
  Code code;
  code.kind = Code::Kind::leave;
  return code;
}

// Whether something is called, or else may throw.
bool has_call(const Expression& expression) {
  const bool is_acting =
      expression.kind == Form::other &&
      (expression.text == "new" || expression.text == "[" || expression.text == "*");
  return expression.kind == Form::call || expression.kind == Form::construct ||
         expression.kind == Form::cast || is_acting ||
         std::ranges::any_of(expression.operands, has_call);
}

}  // namespace

// ---- Sequences ----

void StatementWalker::walk(const std::vector<Statement>& list) {
  const CodeWriter::Scope scope(writer_);
  for (const Statement& next : list) {
    if (walk_.is_main_over) return;
    const std::set<std::string> before = writer_.raised();
    may_throw(next);
    writer_.guard_rest(before);
    const std::set<std::string> between = writer_.raised();
    const std::size_t written = writer_.written();
    walk_.acting_calls = 0;
    one(next);
    if (writer_.written() != written) may_throw(next);
    if (walk_.acting_calls > 1 && writer_.tries() > 0) {
      writer_.hole(next.place, "several calls in one statement of a try", false);
    }
    writer_.guard_rest(between);
  }
}

// In a try each statement that calls something may throw, in front of what it does or behind it.
void StatementWalker::may_throw(const Statement& next) {
  const bool makes = next.kind == Statement::Kind::declaration &&
                     !is_plain_type(class_of_type(walk_.variable(next.variable).type));
  const bool calls = makes || std::ranges::any_of(next.expressions, has_call);
  if (writer_.tries() == 0 || !calls) return;
  writer_.either(next.place, [&] { writer_.raise(writer_.throw_flag()); });
}

void StatementWalker::walk_body(const std::vector<Statement>& list) {
  const auto loops = std::exchange(loops_, {});
  walk(list);
  loops_ = loops;
}

void StatementWalker::one(const Statement& next) {
  switch (next.kind) {
    case Statement::Kind::expression:
      for (const Expression& expression : next.expressions) {
        walk_.expressions->evaluate(expression);
      }
      return;
    case Statement::Kind::declaration: return declare(next);
    case Statement::Kind::branch: return branch(next);
    case Statement::Kind::loop:
    case Statement::Kind::range:
    case Statement::Kind::repeat: return loop(next);
    case Statement::Kind::choice: return choice(next);
    case Statement::Kind::attempt: return attempt(next);
    case Statement::Kind::block: return block(next);
    case Statement::Kind::returns: return returns(next);
    case Statement::Kind::breaks:
    case Statement::Kind::continues: return jump(next);
    case Statement::Kind::throws:
      for (const Expression& expression : next.expressions) {
        walk_.expressions->evaluate(expression);
      }
      return writer_.raise(writer_.throw_flag());
    case Statement::Kind::opaque: return writer_.hole(next.place, next.text, true);
  }
}

// What main declares in a block goes with it, unless main spins for ever there.
void StatementWalker::block(const Statement& next) {
  const std::set<std::string> before = writer_.raised();
  for (const auto& list : next.blocks) walk(list);
  const bool is_main = writer_.node() == none && writer_.phase() == Phase::start;
  if (!is_main || writer_.raised() != before) return;
  for (const auto& list : next.blocks) {
    for (const Statement& inner : list) {
      if (inner.kind != Statement::Kind::declaration) continue;
      const auto kept = walk_.values.frame().values.find(inner.variable);
      const bool matters = kept != walk_.values.frame().values.end() && kept->second.matters();
      if (matters) writer_.hole(inner.place, "what goes with its block", true);
    }
  }
}

void StatementWalker::returns(const Statement& next) {
  Frame& frame = walk_.values.frame();
  if (!next.expressions.empty()) {
    const Value value = walk_.expressions->evaluate(next.expressions[0]);
    if (LockKeeper::is_guard(value.type))
      writer_.hole(next.place, "a lock that is handed on", true);
    if (!value.condition.empty()) writer_.set(frame.return_value, value.condition);
    frame.returns.push_back(value);
  }
  writer_.raise(frame.return_flag);
}

void StatementWalker::jump(const Statement& next) {
  const bool is_break = next.kind == Statement::Kind::breaks;
  const std::string flag = loops_.empty() ? ""
                           : is_break     ? loops_.back().first
                                          : loops_.back().second;
  if (flag.empty()) return writer_.hole(next.place, "a break of nothing", false);
  writer_.raise(flag);
}

// ---- Declarations ----

void StatementWalker::declare(const Statement& next) {
  const Variable& variable = walk_.variable(next.variable);
  if (variable.is_static) return declare_static(next, variable);
  const std::string type = class_of_type(variable.type);
  if (LockKeeper::is_guard(type)) {
    return walk_.rows->locks().declare_guard(next, type);
  }
  Value value = walk_.objects->first_value(variable, next.expressions, next.is_set, next.place);
  const bool is_followed =
      value.matters() || value.kind == Value::Kind::status || value.kind == Value::Kind::qos;
  if (!is_followed && type != "auto") value.type = type;
  // What main has in a variable stays while main does.
  const bool is_main = writer_.node() == none && writer_.phase() == Phase::start;
  if (is_main && walk_.calls->depth() == 1) walk_.values.keep(value, ValueStore::for_ever);
  walk_.values.declare(next.variable, std::move(value));
}

// It is made once, when somebody first comes there.
void StatementWalker::declare_static(const Statement& next, const Variable& variable) {
  if (walk_.values.has_global(next.variable)) return;
  const std::size_t written = writer_.written();
  Value value = walk_.objects->first_value(variable, next.expressions, next.is_set, next.place);
  if (writer_.written() != written) {
    writer_.hole(next.place, "a static variable whose first value communicates", true);
  }
  const bool is_kept = value.matters() || value.kind == Value::Kind::text;
  if (!is_kept) value = data_value(class_of_type(variable.type));
  walk_.values.declare_global(next.variable, std::move(value));
}

// ---- Branches ----

void StatementWalker::branch(const Statement& next) {
  const CodeWriter::Scope scope(writer_);
  Value condition;
  if (!next.expressions.empty()) {
    condition = walk_.expressions->evaluate(next.expressions[0]);
  }
  if (next.variable != none) walk_.values.declare(next.variable, condition);
  writer_.branch_on(
      ExpressionWalker::truth(condition), next.place, [&] { walk(next.blocks[0]); },
      [&] { walk(next.blocks[1]); });
}

// Any case is gone to, and falls into the next one.
void StatementWalker::choice(const Statement& next) {
  for (const Expression& expression : next.expressions) walk_.expressions->evaluate(expression);
  const std::string leave = writer_.fresh("b"), entered = writer_.fresh("e");
  loops_.emplace_back(leave, loops_.empty() ? "" : loops_.back().second);
  writer_.set(leave, "false");
  writer_.set(entered, "false");
  {
    const CodeWriter::Scope scope(writer_);
    const std::set<std::string> before = writer_.raised();
    for (std::size_t i = 0; i < next.blocks.size(); ++i) {
      const bool is_last = next.has_default && i + 1 == next.blocks.size();
      const auto enter = [&] { writer_.set(entered, "true"); };
      writer_.branch_on("!" + entered, next.place,
                        [&] { is_last ? enter() : writer_.either(next.place, enter); });
      writer_.branch_on(entered, next.place, [&] { walk(next.blocks[i]); });
      writer_.guard_rest(before);
    }
  }
  loops_.pop_back();
  writer_.lower(leave);
}

// What is thrown goes to any of the handlers; to none, unless the last one takes everything.
void StatementWalker::attempt(const Statement& next) {
  const std::string thrown = writer_.fresh("t");
  writer_.set(thrown, "false");
  const std::string outer = std::exchange(writer_.throw_flag(), thrown);
  ++writer_.tries();
  walk(next.blocks[0]);
  --writer_.tries();
  writer_.throw_flag() = outer;
  if (!writer_.raised().contains(thrown)) return;
  writer_.lower(thrown);
  const std::size_t handlers = next.blocks.size();
  const std::function<void(std::size_t)> handle = [&](std::size_t i) {
    if (i == handlers) return writer_.raise(writer_.throw_flag());
    if (i + 1 == handlers && next.has_default) return walk(next.blocks[i]);
    writer_.either(
        next.place, [&] { walk(next.blocks[i]); }, [&] { handle(i + 1); });
  };
  writer_.branch_on(thrown, next.place, [&] { handle(1); });
}

// ---- Loops ----

void StatementWalker::loop_variable(const Statement& next) {
  const Value container = walk_.expressions->evaluate(next.expressions[0]);
  if (container.matters()) {
    writer_.hole(next.place, "a loop over what is not known", true);
  }
  if (next.variable == none) return;
  const std::string type = class_of_type(walk_.variable(next.variable).type);
  const int listed = next.expressions[0].variable;
  const std::string of = listed == none ? container.type : walk_.variable(listed).type;
  const std::string inner = class_of_type(template_arguments(of));
  walk_.values.declare(next.variable, data_value(type != "auto"                    ? type
                                                 : is_message_type(container.type) ? "message"
                                                 : inner.empty()                   ? "?"
                                                                                   : inner));
}

Value StatementWalker::leave_unless(const Expression& condition, const Place& place) {
  Value value = walk_.expressions->evaluate(condition);
  writer_.branch_on(
      ExpressionWalker::truth(value), place, [] {}, [&] { writer_.append(leave_loop()); });
  return value;
}

void StatementWalker::write_body(const Statement& next, const std::string& again,
                                 const std::set<std::string>& before) {
  walk(next.blocks.back());
  writer_.lower(again);
  std::string out;
  for (const std::string& flag : writer_.raised()) {
    if (!before.contains(flag)) out += (out.empty() ? "" : " || ") + flag;
  }
  if (out.empty()) return;
  writer_.branch_on(out, next.place, [&] { writer_.append(leave_loop()); });
}

// loop { if (!condition) { break; } body; if (left) { break; } step }
//
// One that is sure to end may be the last time round from its beginning on, by a fair choice. So it
// does not go on for ever; but it may be empty each time, and be left early each time.
void StatementWalker::loop(const Statement& next) {
  const CodeWriter::Scope scope(writer_);
  const bool is_for = next.kind == Statement::Kind::loop;
  if (is_for) walk(next.blocks[0]);
  walk_.values.forget_what_is_set_in(next);
  if (next.kind == Statement::Kind::range) loop_variable(next);
  const bool is_finite = is_finite_loop(
      next, walk_.sources, [&](int variable) { return walk_.values.is_shared(variable); });
  const std::string leave = writer_.fresh("b"), again = writer_.fresh("c");
  const std::set<std::string> before = writer_.raised();
  Code code;
  code.kind = Code::Kind::loop;
  code.place = next.place;
  code.arms.resize(1);
  Value condition;
  loops_.emplace_back(leave, again);
  writer_.enter_condition();
  code.arms[0].code = writer_.aside([&] {
    const CodeWriter::Scope inner(writer_);
    writer_.set(leave, "false");
    writer_.set(again, "false");
    if (is_for && next.expressions[0].kind != Form::absent) {
      condition = leave_unless(next.expressions[0], next.place);
    }
    if (next.kind == Statement::Kind::range) {
      writer_.branch_on("", next.place, [&] { writer_.append(leave_loop()); });
    }
    const std::string last = is_finite ? writer_.choose_last(next.place) : "";
    write_body(next, again, before);
    if (is_finite) writer_.branch_on(last, next.place, [&] { writer_.append(leave_loop()); });
    if (is_for) walk_.expressions->evaluate(next.expressions[1]);
    if (next.kind == Statement::Kind::repeat) {
      condition = leave_unless(next.expressions[0], next.place);
    }
  });
  writer_.leave_condition();
  loops_.pop_back();
  const bool raises = writer_.raised() != before;
  writer_.lower(leave);
  finish_loop(next, std::move(code), condition, raises, is_finite);
}

// A loop that does nothing is left out if it is sure to end. `while (!there) { }` is a wait.
void StatementWalker::finish_loop(const Statement& next, Code code, const Value& condition,
                                  bool raises, bool is_finite) {
  std::vector<Code>& body = code.arms[0].code;
  const bool is_idle = !has_steps(body);
  if (is_idle && !raises && condition.presence.starts_with('!')) {
    return writer_.emit("wait " + condition.presence.substr(1) + " -> there;", next.place);
  }
  if (is_idle && !raises && is_finite) return;
  if (is_idle) {  // it may go round for ever: a choice is a step
    Code rest;
    rest.kind = Code::Kind::branch;
    rest.text = "*";
    rest.place = next.place;
    rest.arms.resize(1);
    Code skip;
    skip.text = "skip;";
    rest.arms[0].code.push_back(skip);
    body.push_back(std::move(rest));
  }
  writer_.append(std::move(code));
}

}  // namespace maide::extract
