#include "maide/check/build/clock_code.hpp"

#include <string>
#include <utility>

namespace maide {
namespace {

syntax::Statement make_statement(syntax::Statement::Kind kind, TextPlace place) {
  syntax::Statement made;
  made.kind = kind;
  made.place = place;
  return made;
}

// "robot.tick.due" = true;
syntax::Statement make_due(const std::string& callback, TextPlace place) {
  syntax::Statement due = make_statement(syntax::Statement::Kind::assign, place);
  due.target.kind = syntax::Term::Kind::name;
  due.target.name = {due_of(callback), true, place};
  due.target.place = due.target.begin = place;
  due.expression.emplace();
  due.expression->kind = syntax::Term::Kind::boolean;
  due.expression->value = 1;
  return due;
}

}  // namespace

syntax::Code make_clock_code(const syntax::Term& clock,
                             const std::vector<program_syntax::Callback>& callbacks,
                             const SourcePosition& position) {
  using Kind = syntax::Statement::Kind;
  const TextPlace place{position.line, position.column};
  syntax::Statement select = make_statement(Kind::select, place);
  select.is_idle = true;
  syntax::SelectArm& tick = select.select_arms.emplace_back();
  tick.kind = syntax::SelectArm::Kind::input;
  tick.place = place;
  tick.model = clock;
  tick.event.name = {"read", true, place};
  tick.has_arms = true;
  syntax::Arm& message = tick.arms.emplace_back();
  message.place = place;
  message.output.name = {"message", true, place};
  for (const program_syntax::Callback& timer : callbacks) {
    if (!timer.goes_by_clock) continue;
    // What is fair is told apart by its place.
    const TextPlace of_timer{timer.position.line, timer.position.column};
    syntax::Statement choice = make_statement(Kind::choice, of_timer);
    choice.is_fair = choice.is_one_sided = true;
    choice.body.statements.push_back(make_due(timer.whole_name(), place));
    message.body.statements.push_back(std::move(choice));
  }
  syntax::Statement loop = make_statement(Kind::loop, place);
  loop.body.statements.push_back(std::move(select));
  syntax::Code code;
  code.file = position.file;
  code.begin = code.end = code.last = place;
  code.block.statements.push_back(std::move(loop));
  return code;
}

}  // namespace maide
