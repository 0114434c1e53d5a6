// What runs callbacks, as a program: a loop that rests until one of them can start, and then does
// its code and its end.
#include <algorithm>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>

#include "maide/check/language/program_parser.hpp"
#include "maide/check/system/system.hpp"

namespace maide::program_syntax {
namespace {

constexpr std::size_t max_looked_at = 12;  // a look is a step for each set of what it may find
constexpr std::ptrdiff_t max_timers = 8;   // each set of them that is due is fair by itself

}  // namespace

void ProgramParser::parse_thread(const Thread& thread) {
  Block& block = work_.tree.statements;
  work_.scopes.push_back({{}, &block, false});
  declare_own();
  Statement starts;
  starts.kind = thread.goes_by_rounds ? Statement::Kind::rounds : Statement::Kind::select;
  starts.is_idle = true;
  starts.line = work_.position.line;
  starts.column = work_.position.column;
  if (thread.goes_by_rounds) {
    if (thread.callbacks.size() > max_looked_at) {
      throw ParseError("with 'order: rounds' an executor runs at most " +
                           std::to_string(max_looked_at) + " callbacks",
                       work_.position);
    }
    const auto timers = std::count_if(
        thread.callbacks.begin(), thread.callbacks.end(),
        [](const Callback& callback) { return callback.kind == Callback::Kind::timer; });
    if (timers > max_timers) {
      throw ParseError(
          "with 'order: rounds' an executor has at most " + std::to_string(max_timers) + " timers",
          work_.position);
    }
    starts.type.high = (Value{1} << thread.callbacks.size()) - 1;
    starts.target.op = Expression::Operator::local;
    starts.target.index = static_cast<std::uint32_t>(work_.tree.slots.size());
    starts.target.name = "look";
    work_.tree.slots.push_back({"look", starts.type, work_.position});
    work_.tree.initial.emplace_back(0);
  }
  for (const Callback& callback : thread.callbacks) {
    starts.select_arms.push_back(parse_start(callback));
    for (const ModelUse& use : callback.start) work_.names.insert(use.model);
  }
  Statement loop;
  loop.kind = Statement::Kind::loop;
  loop.line = starts.line;
  loop.column = starts.column;
  loop.body = std::make_unique<Block>();
  loop.body->statements.push_back(std::move(starts));
  block.statements.push_back(std::move(loop));
  work_.scopes.pop_back();
}

SelectArm ProgramParser::parse_start(const Callback& callback) {
  const Context* const around = work_.context;
  Context start = *around, inside = *around;
  start.starts = &callback;
  inside.callback = &callback;
  SelectArm arm;
  arm.starts = &callback;
  arm.line = callback.position.line;
  arm.column = callback.position.column;
  Scope indices;
  for (const auto& [name, index] : callback.indices) {
    indices.names[name] = {Binding::Kind::constant, index, {}, false, nullptr};
  }
  work_.scopes.push_back(std::move(indices));
  const auto open_procedure = [&] {
    auto procedure = open_block();
    procedure->is_procedure = procedure->is_callback = true;
    return procedure;
  };
  const auto finish = [&](const ScalarText* code, std::unique_ptr<Block> procedure) {
    work_.context = &inside;
    auto body = parse_code(code, std::move(procedure));
    work_.context = &start;
    return body;
  };
  work_.context = &start;
  work_.asked.clear();
  auto procedure = open_procedure();
  if (callback.kind != Callback::Kind::subscription) {
    if (callback.kind != Callback::Kind::timer) {
      arm.kind = SelectArm::Kind::service;
      work_.names.insert(callback.model);
    }
    arm.body = finish(callback.has_code ? &callback.code : nullptr, std::move(procedure));
  } else {
    Event pattern;
    ProgramParser(callback.takes, work_).parse_taken(arm, pattern);
    if (!callback.outcomes.empty()) {
      if (!pattern.is_any) {
        throw ParseError("'takes' names an output, and so does 'do'", callback.position);
      }
      work_.scopes.pop_back();
      for (const auto& [output, code] : callback.outcomes) {
        procedure = open_procedure();
        ProgramParser name(output, work_);
        const Token first = name.tokens_.peek();
        Arm taken = name.begin_arm(false);
        taken.output = name.parse_output(arm.model);
        name.expect_end();
        taken.body = finish(&code, std::move(procedure));
        name.add_arm(arm.arms, std::move(taken), first, "do");
      }
    } else if (arm.kind == SelectArm::Kind::input && (!pattern.is_any || has_outputs(arm))) {
      Arm taken;
      taken.output = std::move(pattern);
      taken.line = arm.line;
      taken.column = arm.column;
      taken.body = finish(&callback.code, std::move(procedure));
      arm.arms.push_back(std::move(taken));
    } else {
      arm.body = finish(&callback.code, std::move(procedure));
    }
  }
  work_.context = around;
  work_.scopes.pop_back();
  Statement end;
  end.kind = Statement::Kind::end_callback;
  end.line = callback.position.line;
  end.column = callback.position.column;
  end.callback = &callback;
  end.services.assign(work_.asked.begin(), work_.asked.end());
  arm.end = std::make_unique<Block>();
  arm.end->statements.push_back(std::move(end));
  return arm;
}

void ProgramParser::parse_taken(SelectArm& arm, Event& pattern) {
  arm.model = parse_model();
  const Token name = tokens_.peek(1);
  if (service_of(arm.model) != nullptr) {
    tokens_.fail("a callback takes from a service by 'serves:', or is its client's", name);
  }
  if (tokens_.accept("!")) {
    arm.kind = SelectArm::Kind::output;
    arm.event = parse_output(arm.model);
  } else {
    arm.kind = SelectArm::Kind::input;
    tokens_.expect(".", "after model '" + arm.model.name() + "'");
    arm.event = parse_input(arm.model);
    pattern.is_any = !tokens_.accept("->");
    pattern.line = arm.line;
    pattern.column = arm.column;
    if (!pattern.is_any) pattern = parse_output(arm.model);
  }
  if (arm.model.is_topic && is_of_writer(instance(arm.model).automaton, arm.event.name)) {
    tokens_.fail(
        "a callback takes what a reader gets, and '" + arm.event.name + "' is the writer's", name);
  }
  expect_end();
  if (!arm.model.is_topic) return;
  for_each_topic(arm.model, [&](const Topic& topic) {
    for (const Topic::Reader& reader : topic.readers) {
      if (reader.callback != arm.starts->whole_name()) continue;
      arm.model.leaf.index = reader.model;
      arm.model.is_topic = false;
    }
    if (arm.model.is_topic) {
      tokens_.fail("this callback is no reader of " + topic.name, name);
    }
  });
  arm.model.leaf.operands.clear();
  arm.model.leaf.dimensions.clear();
}

bool ProgramParser::has_outputs(const SelectArm& arm) const {
  const InterfaceAutomaton& automaton = instance(arm.model).automaton;
  const auto input = automaton.inputs().find(arm.event.name);
  for (Symbol output = 0; output < automaton.outputs().size(); ++output) {
    if (!input || is_of_same_actor(automaton, *input, output)) return true;
  }
  return false;
}

std::unique_ptr<Block> ProgramParser::parse_code(const ScalarText* code,
                                                 std::unique_ptr<Block> procedure) {
  if (code != nullptr) {
    ProgramParser parser(*code, work_);
    parser.parse_procedure(*procedure);
    if (procedure->statements.empty()) {
      parser.tokens_.fail("a callback has no statement; one that does nothing is written `skip;`",
                          parser.tokens_.peek());
    }
  }
  work_.scopes.pop_back();
  return procedure;
}

Tree parse_thread(const Thread& thread, const ScalarText& text, const Context& context) {
  Work work(context, text);
  ProgramParser(text, work).parse_thread(thread);
  work.tree.names.assign(work.names.begin(), work.names.end());
  return std::move(work.tree);
}

}  // namespace maide::program_syntax
