#include "maide/check/build/code_resolver.hpp"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <set>
#include <tuple>
#include <utility>

#include "maide/base/text.hpp"
#include "maide/check/system/system.hpp"
#include "maide/check/text/tokens.hpp"

namespace maide::program_syntax {
namespace {

constexpr int max_nesting = 200;                 // of blocks and calls: the resolver recurses
constexpr std::size_t max_statements = 200'000;  // with procedures in their places
constexpr std::size_t max_looked_at = 12;  // a look is a step for each set of what it may find
constexpr std::ptrdiff_t max_timers = 8;   // each set of them that is due is fair by itself
constexpr Value max_counted = 100;         // callbacks of one spin

bool is_same(const Expression& one, const Expression& other) {
  return one.op == other.op && one.index == other.index && one.value == other.value &&
         std::equal(one.operands.begin(), one.operands.end(), other.operands.begin(),
                    other.operands.end(),
                    [](const Expression& a, const Expression& b) { return is_same(a, b); });
}

// The same output, whatever it carries, or the same values.
bool is_same(const Arm& one, const Arm& other) {
  if (one.is_quiet || other.is_quiet) return one.is_quiet == other.is_quiet;
  const Event &a = one.output, &b = other.output;
  return a.name == b.name &&
         std::equal(a.arguments.begin(), a.arguments.end(), b.arguments.begin(), b.arguments.end(),
                    [](const Event::Argument& x, const Event::Argument& y) {
                      if (x.binds || y.binds) return x.binds == y.binds;
                      return x.expression.is_constant() && y.expression.is_constant() &&
                             x.expression.value == y.expression.value;
                    });
}

}  // namespace

// ---- Blocks and statements ----------------------------------------------------------------------

void CodeResolver::resolve_program(const syntax::Code& code) {
  Block& block = work_.tree.statements;
  work_.scopes.push_back({{}, &block, false});
  names_.declare_own();
  choose_own(block);
  resolve_statements(code.block, block);
  work_.scopes.pop_back();
}

void CodeResolver::resolve_statements(const syntax::Block& from, Block& to) {
  for (const syntax::Statement& statement : from.statements) {
    to.statements.push_back(resolve_statement(statement));
  }
}

std::unique_ptr<Block> CodeResolver::open_block() {
  auto block = std::make_unique<Block>();
  work_.scopes.push_back({{}, block.get(), false});
  return block;
}

std::unique_ptr<Block> CodeResolver::close_block(std::unique_ptr<Block> open,
                                                 const syntax::Block& block) {
  resolve_statements(block, *open);
  work_.scopes.pop_back();
  return open;
}

std::unique_ptr<Block> CodeResolver::resolve_block(const syntax::Block& block) {
  return close_block(open_block(), block);
}

Statement CodeResolver::resolve_statement(const syntax::Statement& from) {
  Statement statement;
  for (const syntax::Name& label : from.labels) statement.labels.push_back(resolve_label(label));
  if (++work_.statements > max_statements) {
    names_.fail("with its procedures, this program has more than " +
                    std::to_string(max_statements) + " statements",
                from.place);
  }
  statement.origin = from.origin;
  statement.line = from.place.line;
  statement.column = from.place.column;
  statement.callback = work_.context->callback;
  statement.is_idle = from.is_idle;
  const bool is_thread =
      statement.callback != nullptr && statement.callback->kind == Callback::Kind::thread;
  if (from.is_idle && statement.callback != nullptr && !is_thread) {
    names_.fail("a callback does not rest: its thread waits for its end", from.place);
  }
  resolve_kind(from, statement);
  return statement;
}

std::uint32_t CodeResolver::resolve_label(const syntax::Name& name) {
  auto& labels = work_.tree.labels;
  const Callback* const callback = work_.context->callback;
  const std::string label =
      callback != nullptr ? callback->whole_name() + "@" + name.text : name.text;
  const auto [known, is_new] = work_.label_places.try_emplace(label, name.place);
  if (is_new) {
    labels.push_back(label);
    return static_cast<std::uint32_t>(labels.size() - 1);
  }
  // In another copy of a procedure it is the same label.
  if (known->second.line != name.place.line || known->second.column != name.place.column) {
    names_.fail("the label '" + name.text + "' stands before two statements", name.place);
  }
  return static_cast<std::uint32_t>(std::find(labels.begin(), labels.end(), label) -
                                    labels.begin());
}

void CodeResolver::resolve_kind(const syntax::Statement& from, Statement& to) {
  using From = syntax::Statement::Kind;
  using To = Statement::Kind;
  const bool is_in_callback = work_.context->callback != nullptr;
  switch (from.kind) {
    case From::loop:
      to.kind = To::loop;
      to.body = resolve_block(from.body);
      break;
    case From::repeat: resolve_repeat(from, to); break;
    case From::choice:
      to.kind = To::choice;
      to.is_fair = from.is_fair;
      to.is_one_sided = from.is_one_sided;
      to.body = resolve_block(from.body);
      to.otherwise = resolve_block(from.otherwise);
      break;
    case From::when:
      to.kind = To::when;
      to.expression = names_.expression(*from.expression, ValueKind::boolean, "a condition");
      to.body = resolve_block(from.body);
      to.otherwise = resolve_block(from.otherwise);
      break;
    case From::repeat_while:
      to.kind = To::repeat_while;
      to.expression = names_.expression(*from.expression, ValueKind::boolean, "a condition");
      to.body = resolve_block(from.body);
      break;
    case From::repeat_for: resolve_for(from, to); break;
    case From::skip: break;
    case From::stop: to.kind = is_in_callback ? To::leave_callback : To::stop; break;
    case From::give_back:
      to.kind = !work_.calls.empty() ? To::leave_procedure
                : is_in_callback     ? To::leave_callback
                                     : To::stop;
      break;
    case From::leave: to.kind = To::leave; break;
    case From::next_round: to.kind = To::next_round; break;
    case From::give:
    case From::give_arms:
      to.kind = To::give;
      to.model = events_.model(from.model);
      if (events_.is_condition(to.model) && from.event.name.text == "wait") {
        resolve_condition_wait(from, to);
        break;
      }
      if (!from.select_arms.empty()) {
        names_.fail("'timeout' stands behind the `wait` of a condition, or in a 'select'",
                    from.select_arms.front().place);
      }
      to.input = events_.input(to.model, from.event);
      for (const syntax::Arm& arm : from.arms) {
        if (from.kind == From::give) {
          to.arms.push_back(resolve_awaited(to.model, arm));
        } else {
          add_arm(to.arms, resolve_arm(to.model, arm), arm.output.name, "switch");
        }
      }
      break;
    case From::wait: resolve_wait(from, to); break;
    case From::declare: resolve_declaration(from, to); break;
    case From::assign:
      to.kind = To::assign;
      std::tie(to.target, to.type) = names_.target(from.target);
      to.expression = names_.value_for(*from.expression, to.type, from.target.name.text);
      break;
    case From::choose: resolve_choice_of_value(from, to); break;
    case From::call: resolve_call(from, to); break;
    case From::atomic:
      to.kind = To::atomic;
      if (from.expression) {
        to.expression = names_.expression(*from.expression, ValueKind::boolean, "a condition");
      }
      to.body = resolve_block(from.body);
      break;
    case From::select:
      to.kind = To::select;
      for (const syntax::SelectArm& arm : from.select_arms) {
        SelectArm resolved = resolve_select_arm(arm);
        check_distinct(to.select_arms, resolved);
        to.select_arms.push_back(std::move(resolved));
      }
      break;
    case From::offer:
    case From::withdraw: resolve_offer(from, to); break;
    case From::run:
    case From::join: resolve_run(from, to); break;
    case From::kill:
    case From::restart:
    case From::end: resolve_kill(from, to); break;
    case From::spin: resolve_spin(from, to); break;
    case From::unknown: {
      const Context& known = *work_.context;
      to.kind = To::give;
      to.model.leaf.op = Expression::Operator::shared;
      to.model.leaf.index = is_in_callback
                                ? known.names.unknown_callbacks.at(known.callback->whole_name())
                                : known.names.unknown_programs.at(known.program);
      to.input.name = "begin";
      work_.names.insert(to.model.leaf.index);
      break;
    }
  }
}

void CodeResolver::resolve_offer(const syntax::Statement& from, Statement& to) {
  const bool offers = from.kind == syntax::Statement::Kind::offer;
  const std::string verb = offers ? "offer" : "withdraw";
  to.model = events_.model(from.model);
  if (events_.service_of(to.model) == nullptr) {
    names_.fail("'" + verb + "' takes a service, and '" + from.model.name.text + "' is none",
                from.model.place);
  }
  if (!events_.is_server(to.model)) {
    names_.fail("'" + verb + "' stands in the code of the service's server", from.place);
  }
  to.target = names_.presence(from.model);
  if (to.target.is_constant()) {
    names_.fail("nobody offers '" + from.model.name.text +
                    "', so it is there from the begin: say `offer` where it comes to be",
                from.place);
  }
  to.kind = offers ? Statement::Kind::assign : Statement::Kind::withdraw;
  to.type.kind = ValueKind::boolean;
  to.type.high = 1;
  to.expression = make_constant(offers ? 1 : 0, ValueKind::boolean);
}

void CodeResolver::resolve_kill(const syntax::Statement& from, Statement& to) {
  using From = syntax::Statement::Kind;
  const Names& known = work_.context->names;
  if (from.kind == From::end) {
    to.kind = Statement::Kind::end_process;
    to.life = known.life_of_program.at(work_.context->program);
  } else {
    to.kind = from.kind == From::kill ? Statement::Kind::kill : Statement::Kind::restart;
    to.life = known.life_of_name.at(from.name.text);
    to.input.name = from.name.text;
  }
  work_.names.insert(known.lives[to.life].model);
}

void CodeResolver::resolve_run(const syntax::Statement& from, Statement& to) {
  const Callback* const callback = work_.context->callback;
  const bool runs = from.kind == syntax::Statement::Kind::run;
  if (callback == nullptr) {
    names_.fail(std::string(runs ? "'run'" : "'join'") +
                    " takes a thread of a node, and stands in the node's code",
                from.place);
  }
  const auto& threads = work_.context->names.threads;
  const auto thread = threads.find(callback->node + "." + from.name.text);
  if (thread == threads.end()) {
    std::vector<std::string> known;
    for (const auto& [name, model] : threads) {
      if (name.starts_with(callback->node + "."))
        known.push_back(name.substr(callback->node.size() + 1));
    }
    names_.fail("node " + callback->node + " has no thread '" + from.name.text + "'" +
                    (known.empty() ? "" : "; it has: " + known_instead(from.name.text, known)),
                from.name.place);
  }
  to.kind = runs ? Statement::Kind::run : Statement::Kind::join;
  to.copies = thread->second;
  work_.names.insert(to.copies);
}

// `wait lookup -> there;` is a `select` with one arm.
void CodeResolver::resolve_wait_for_server(const syntax::Statement& from, Statement& to) {
  to.kind = Statement::Kind::select;
  SelectArm& arm = to.select_arms.emplace_back();
  arm.callback = work_.context->callback;
  arm.line = from.place.line;
  arm.column = from.place.column;
  arm.guard = names_.presence(from.model);
  arm.body = std::make_unique<Block>();
}

std::uint32_t CodeResolver::count_of_matched(const syntax::Event& matched) const {
  if (!matched.has_arguments) return 1;
  const bool is_number = matched.arguments.size() == 1 && !matched.arguments.front().is_declared;
  const Value count =
      is_number ? names_.constant(matched.arguments.front().term, "how many are to match") : 0;
  if (count < 1 || count > Value{max_array_members}) {
    names_.fail("`matched` has a number of at least 1: how many others are met",
                matched.name.place);
  }
  return static_cast<std::uint32_t>(count);
}

void CodeResolver::resolve_wait(const syntax::Statement& from, Statement& to) {
  const syntax::Arm& awaited = from.arms.front();
  to.model = events_.sent_to(from.model);
  if (awaited.output.name.is("there") && events_.service_of(to.model) != nullptr) {
    return resolve_wait_for_server(from, to);
  }
  if (awaited.output.name.is("matched") && to.model.is_topic) {
    to.kind = Statement::Kind::matched;
    to.copies = count_of_matched(awaited.output);
    return;
  }
  if (events_.is_arrival(to.model, awaited.output)) {
    to.kind = Statement::Kind::arrival;
    to.input = events_.arrival(to.model, awaited.output);
    return;
  }
  to.kind = Statement::Kind::wait;
  to.model = events_.model(from.model);
  to.arms.push_back(resolve_awaited(to.model, awaited));
}

void CodeResolver::resolve_condition_wait(const syntax::Statement& from, Statement& to) {
  if (!from.arms.empty()) {
    names_.fail("the `wait` of a condition brings nothing: write `" + to.model.name() + ".wait;`",
                from.event.name.place);
  }
  to.input = events_.input(to.model, from.event);
  const auto begin = [&](Statement::Kind kind) {
    Statement made;
    made.kind = kind;
    made.line = to.line;
    made.column = to.column;
    made.callback = to.callback;
    made.model = to.model;
    return made;
  };
  Statement gives = begin(Statement::Kind::give), waits = begin(Statement::Kind::select);
  gives.input = to.input;
  waits.is_idle = std::exchange(to.is_idle, false);
  for (const auto kind : {SelectArm::Kind::wake, SelectArm::Kind::wake_causeless}) {
    SelectArm& arm = waits.select_arms.emplace_back();
    arm.kind = kind;
    arm.model = to.model;
    arm.callback = to.callback;
    arm.body = std::make_unique<Block>();
    arm.line = to.line;
    arm.column = to.column;
  }
  for (const syntax::SelectArm& late : from.select_arms) {
    SelectArm& arm = waits.select_arms.emplace_back(resolve_select_arm(late));
    auto& statements = arm.body->statements;
    statements.insert(statements.begin(), begin(Statement::Kind::relock));
  }
  to.kind = Statement::Kind::inner;
  to.body = std::make_unique<Block>();
  to.body->statements.push_back(std::move(gives));
  to.body->statements.push_back(std::move(waits));
}

void CodeResolver::resolve_repeat(const syntax::Statement& from, Statement& to) {
  to.kind = Statement::Kind::repeat;
  const syntax::Term& term = *from.expression;
  Expression count = names_.without_shared(names_.expression(term), term.begin, "'repeat'");
  require(count, ValueKind::integer, "the number of a 'repeat'", names_.position(term.begin));
  if (count.is_constant() && count.value > static_cast<Value>(max_control_states)) {
    names_.fail("'repeat' goes up to " + std::to_string(max_control_states), term.begin);
  }
  if (count.is_constant() && count.value < 0) {
    names_.fail("'repeat' goes from 0 on, and this is " + std::to_string(count.value), term.begin);
  }
  to.expression = std::move(count);
  to.body = resolve_block(from.body);
}

void CodeResolver::resolve_bounds(const syntax::Range& range, Statement& to,
                                  std::string_view what) {
  const TextPlace begin = range.low.begin;
  to.expression = names_.without_shared(names_.expression(range.low), begin, what);
  to.upper = names_.without_shared(names_.expression(range.high), begin, what);
  require(*to.expression, ValueKind::integer, what, names_.position(begin));
  require(to.upper, ValueKind::integer, what, names_.position(begin));
}

void CodeResolver::resolve_for(const syntax::Statement& from, Statement& to) {
  to.kind = Statement::Kind::repeat_for;
  names_.check_new(from.name);
  resolve_bounds(from.range, to, "a bound of a 'for'");
  to.type = names_.type_of(*to.expression);
  to.type.high = std::max(to.type.high, names_.type_of(to.upper).high);
  auto block = open_block();
  to.target = names_.declare(from.name, to.type, {}, true);
  to.body = close_block(std::move(block), from.body);
}

void CodeResolver::resolve_declaration(const syntax::Statement& from, Statement& to) {
  to.kind = Statement::Kind::assign;
  names_.check_new(from.name);
  const Dimensions dimensions = names_.dimensions(from.dimensions);
  to.type = names_.type(from.type);
  to.expression = from.expression ? names_.value_for(*from.expression, to.type, from.name.text)
                                  : make_constant(to.type.at(0), to.type.kind);
  to.target = names_.declare(from.name, to.type, dimensions);
  to.target.line = to.line;
  to.target.column = to.column;
  to.slots = static_cast<std::uint32_t>(member_count(dimensions));
  if (!from.is_any) return;
  Statement inner;
  inner.kind = Statement::Kind::inner;
  inner.line = to.line;
  inner.column = to.column;
  inner.origin = to.origin;
  inner.callback = to.callback;
  std::swap(inner.labels, to.labels);
  inner.body = std::make_unique<Block>();
  Statement declaration = std::move(to);
  std::vector<Statement> choices = choices_of(declaration);
  inner.body->statements.push_back(std::move(declaration));
  for (Statement& choice : choices) inner.body->statements.push_back(std::move(choice));
  to = std::move(inner);
}

std::vector<Statement> CodeResolver::choices_of(const Statement& declaration) const {
  std::vector<Statement> choices;
  for (std::uint32_t slot = 0; slot < declaration.slots; ++slot) {
    Statement& choice = choices.emplace_back();
    choice.kind = Statement::Kind::choose;
    choice.line = declaration.line;
    choice.column = declaration.column;
    choice.origin = declaration.origin;
    choice.callback = declaration.callback;
    choice.type = declaration.type;
    choice.target = declaration.target;
    choice.target.index += slot;
    choice.target.name += member_suffix(declaration.target.dimensions, slot);
    choice.target.dimensions.clear();
    choice.target.operands.clear();
  }
  return choices;
}

void CodeResolver::choose_own(Block& block) {
  for (const std::string& name : work_.context->own) {
    const VariableName& variable = work_.context->names.variables.at(name);
    if (!variable.is_any) continue;
    Statement declaration;
    declaration.line = variable.position.line;
    declaration.column = variable.position.column;
    declaration.type = variable.type;
    declaration.target = work_.own.at(name).expression;
    declaration.slots = static_cast<std::uint32_t>(member_count(variable.leaf.dimensions));
    for (Statement& choice : choices_of(declaration)) {
      block.statements.push_back(std::move(choice));
    }
  }
}

void CodeResolver::resolve_choice_of_value(const syntax::Statement& from, Statement& to) {
  to.kind = Statement::Kind::choose;
  to.is_fair = from.is_fair;
  std::tie(to.target, to.type) = names_.target(from.target);
  resolve_bounds(from.range, to, "a bound of 'any'");
  require(make_constant(0, to.type.kind), ValueKind::integer, "what 'any' chooses",
          names_.position(from.target.place));
  if (to.expression->is_constant() && to.upper.is_constant() &&
      to.expression->value > to.upper.value) {
    names_.fail("'any' goes from the least to the greatest", from.range.low.begin);
  }
}

// ---- Procedures ---------------------------------------------------------------------------------

void CodeResolver::resolve_call(const syntax::Statement& from, Statement& to) {
  to.kind = Statement::Kind::inner;
  const std::string& name = from.name.text;
  const auto& procedures = work_.context->names.procedures;
  const auto known = procedures.find(name);
  if (known == procedures.end()) {
    std::vector<std::string> names;
    for (const auto& [other, procedure] : procedures) names.push_back(other);
    names_.fail("unknown procedure '" + name + "'; there is: " + known_instead(name, names),
                from.name.place);
  }
  if (std::find(work_.calls.begin(), work_.calls.end(), name) != work_.calls.end()) {
    names_.fail("procedure '" + name + "' calls itself: " + join(work_.calls) + ", " + name,
                from.name.place);
  }
  if (++work_.nesting > max_nesting) {
    names_.fail("calls are nested too deeply", from.name.place);
  }
  const Procedure& procedure = known->second;
  Scope scope;
  scope.is_barrier = true;
  if (from.arguments.size() != procedure.parameters.size()) {
    fail_argument_count(procedure, from.name);
  }
  for (std::size_t i = 0; i < from.arguments.size(); ++i) {
    scope.names.emplace(procedure.parameters[i], resolve_call_argument(from.arguments[i]));
  }
  to.body = std::make_unique<Block>();
  to.body->is_procedure = true;
  scope.block = to.body.get();
  work_.scopes.push_back(std::move(scope));
  work_.calls.push_back(name);
  resolve_statements(procedure.code->block, *to.body);
  work_.calls.pop_back();
  work_.scopes.pop_back();
  --work_.nesting;
}

void CodeResolver::fail_argument_count(const Procedure& procedure, const syntax::Name& name) const {
  names_.fail("procedure '" + name.text + "' takes " + std::to_string(procedure.parameters.size()) +
                  (procedure.parameters.size() == 1 ? " argument: " : " arguments: ") + name.text +
                  "(" + join(procedure.parameters) + ")",
              name.place);
}

Binding CodeResolver::resolve_call_argument(const syntax::Term& term) const {
  const auto fail = [&] {
    names_.fail("an argument is a constant, a model or a variable", term.begin);
  };
  auto binding = term.is_name() ? names_.find(term.name.text) : std::nullopt;
  if (!binding || binding->kind == Binding::Kind::constant) {
    Expression value = names_.expression(term);
    if (!value.is_constant() && value.kind != ValueKind::unknown) fail();
    return {Binding::Kind::constant, std::move(value), {}, false, nullptr};
  }
  Expression& leaf = binding->expression;
  leaf.line = term.place.line;
  leaf.column = term.place.column;
  if (!term.has_indices) return *binding;  // an array may be given whole
  if (!leaf.operands.empty()) fail();
  leaf.operands = names_.indices(term, leaf.dimensions);
  return *binding;
}

// ---- Arms ---------------------------------------------------------------------------------------

Arm CodeResolver::resolve_awaited(const ModelReference& model, const syntax::Arm& from) {
  Arm arm;
  arm.line = from.place.line;
  arm.column = from.place.column;
  arm.output = events_.output(model, from.output);
  arm.body = std::make_unique<Block>();
  return arm;
}

Arm CodeResolver::resolve_arm(const ModelReference& model, const syntax::Arm& from) {
  Arm arm;
  arm.line = from.place.line;
  arm.column = from.place.column;
  arm.is_quiet = from.is_quiet;
  auto block = open_block();
  if (!arm.is_quiet) arm.output = events_.output(model, from.output);
  arm.body = close_block(std::move(block), from.body);
  return arm;
}

void CodeResolver::add_arm(std::vector<Arm>& arms, Arm arm, const syntax::Name& name,
                           std::string_view what) const {
  for (const Arm& other : arms) {
    if (!is_same(other, arm)) continue;
    const std::string output = arm.is_quiet     ? "'quiet'"
                               : name.is_quoted ? "\"" + name.text + "\""
                                                : "'" + name.text + "'";
    names_.fail("this '" + std::string(what) + "' has two arms for " + output,
                {arm.line, arm.column});
  }
  arms.push_back(std::move(arm));
}

SelectArm CodeResolver::resolve_select_arm(const syntax::SelectArm& from) {
  using From = syntax::SelectArm::Kind;
  using To = SelectArm::Kind;
  SelectArm arm;
  arm.callback = work_.context->callback;
  arm.line = from.place.line;
  arm.column = from.place.column;
  if (from.guard) {
    arm.guard = names_.expression(*from.guard, ValueKind::boolean, "a condition");
  }
  switch (from.kind) {
    case From::otherwise:
      arm.kind = To::otherwise;
      arm.body = resolve_block(from.body);
      break;
    case From::timeout:
      arm.kind = To::timeout;
      if (names_.constant(from.milliseconds, "a time-out") < 0) {
        names_.fail("a time-out is some milliseconds", from.milliseconds.begin);
      }
      arm.body = resolve_block(from.body);
      break;
    case From::guard: arm.body = resolve_block(from.body); break;
    case From::output: {
      arm.model = events_.sent_to(from.model);
      if (events_.is_arrival(arm.model, from.event)) {
        arm.kind = To::arrival;
        arm.event = events_.arrival(arm.model, from.event);
        arm.body = resolve_block(from.body);
        break;
      }
      arm.kind = To::output;
      arm.model = events_.model(from.model);
      auto block = open_block();
      arm.event = events_.output(arm.model, from.event);
      arm.body = close_block(std::move(block), from.body);
      break;
    }
    case From::input:
      arm.kind = To::input;
      arm.model = events_.model(from.model);
      if (events_.is_condition(arm.model)) {
        names_.fail("'" + from.event.name.text + "' of a condition is no arm: it stands alone",
                    from.event.name.place);
      }
      arm.event = events_.input(arm.model, from.event);
      if (!from.has_arms) arm.body = resolve_block(from.body);
      for (const syntax::Arm& output : from.arms) {
        add_arm(arm.arms, resolve_arm(arm.model, output), output.output.name, "on");
      }
      break;
  }
  return arm;
}

void CodeResolver::check_distinct(const std::vector<SelectArm>& arms, const SelectArm& arm) const {
  using Kind = SelectArm::Kind;
  for (const SelectArm& other : arms) {
    if (arm.kind != Kind::input || other.kind != Kind::input) continue;
    if (arm.model.is_topic != other.model.is_topic) continue;
    if (arm.event.name != other.event.name || !is_same(arm.model.leaf, other.model.leaf)) continue;
    if (arm.event.has_arguments || other.event.has_arguments) continue;
    names_.fail("this 'select' has two arms for " + arm.model.name() + "." + arm.event.name +
                    ": put what may come into the braces of one",
                {arm.line, arm.column});
  }
}

// ---- Callbacks ----------------------------------------------------------------------------------

void CodeResolver::resolve_thread(const Thread& thread) {
  Block& block = work_.tree.statements;
  work_.scopes.push_back({{}, &block, false});
  names_.declare_own();
  choose_own(block);
  work_.thread = &thread;
  for (const Callback& callback : thread.starts) resolve_node_start(callback, block);
  if (thread.main) {
    resolve_node_start(*thread.main, block);
  } else if (!thread.callbacks.empty()) {
    block.statements.push_back(
        make_spinning(thread.all(), work_.position.line, work_.position.column));
  }
  work_.scopes.pop_back();
}

Expression CodeResolver::add_slot(const std::string& name, const ValueType& type,
                                  const SourcePosition& position) {
  Expression slot;
  slot.op = Expression::Operator::local;
  slot.kind = type.kind;
  slot.index = static_cast<std::uint32_t>(work_.tree.slots.size());
  slot.name = name;
  work_.tree.slots.push_back({name, type, position});
  work_.tree.initial.emplace_back(0);
  return slot;
}

// ---- Spinning -----------------------------------------------------------------------------------

namespace {

// A look has a step for each set of what it may find.
void check_looks(const std::vector<const Callback*>& callbacks, const std::string& where,
                 const SourcePosition& position) {
  if (callbacks.size() > max_looked_at) {
    throw ParseError(
        where + " an executor runs at most " + std::to_string(max_looked_at) + " callbacks",
        position);
  }
  const auto timers = std::ranges::count(callbacks, Callback::Kind::timer, &Callback::kind);
  if (timers > max_timers) {
    throw ParseError(where + " an executor has at most " + std::to_string(max_timers) + " timers",
                     position);
  }
}

}  // namespace

Statement CodeResolver::make_spinning(const std::vector<const Callback*>& callbacks, int line,
                                      int column) {
  Statement starts;
  starts.kind = work_.thread->goes_by_rounds ? Statement::Kind::rounds : Statement::Kind::select;
  starts.is_idle = true;
  starts.line = line;
  starts.column = column;
  if (work_.thread->goes_by_rounds) {
    check_looks(callbacks, "with 'order: rounds'", work_.position);
    starts.type.high = (Value{1} << callbacks.size()) - 1;
    starts.target = add_slot("look", starts.type, work_.position);
  }
  for (const Callback* const callback : callbacks) {
    starts.select_arms.push_back(resolve_start(*callback));
    for (const ModelUse& use : callback->start) work_.names.insert(use.model);
  }
  Statement loop;
  loop.kind = Statement::Kind::loop;
  loop.line = line;
  loop.column = column;
  loop.body = std::make_unique<Block>();
  loop.body->statements.push_back(std::move(starts));
  return loop;
}

void CodeResolver::resolve_spin(const syntax::Statement& from, Statement& to) {
  const Callback* const callback = work_.context->callback;
  if (callback == nullptr) {
    names_.fail("'spin' stands in 'main' of an executor, or in the code of a node", from.place);
  }
  const bool is_main = callback->kind == Callback::Kind::main;
  if (names_a_count(from)) {
    syntax::Statement counted = from;
    counted.expression.emplace();
    counted.expression->kind = syntax::Term::Kind::name;
    counted.expression->name = std::exchange(counted.name, {});
    counted.expression->place = counted.expression->begin = from.name.place;
    return resolve_spin(counted, to);
  }
  if (!from.name.text.empty() && !(is_main && from.name.text == work_.thread->executor)) {
    names_.fail("'spin' runs the executor of its 'main', and in a 'start' its node alone; '" +
                    from.name.text + "' from elsewhere is not built",
                from.name.place);
  }
  if (!is_main && callback->kind != Callback::Kind::start) {
    to.kind = Statement::Kind::refused_spin;
    return;
  }
  if (!work_.thread->may_spin) {
    names_.fail("a 'start' that spins goes with one thread yet: for several it is not built",
                from.place);
  }
  std::vector<const Callback*> callbacks = work_.thread->all();
  if (!is_main) {
    std::erase_if(callbacks, [&](const Callback* each) { return each->node != callback->node; });
  }
  if (from.spin != syntax::Statement::Spin::ever) return resolve_spin_of(callbacks, from, to);
  std::vector<std::uint32_t> labels = std::move(to.labels);
  to = make_spinning(callbacks, to.line, to.column);
  to.labels = std::move(labels);
}

void CodeResolver::resolve_spin_of(const std::vector<const Callback*>& callbacks,
                                   const syntax::Statement& from, Statement& to) {
  using Spin = syntax::Statement::Spin;
  to.kind = Statement::Kind::spin;
  to.spin = from.spin;
  to.goes_by_rounds = work_.thread->goes_by_rounds;
  const bool looks = from.spin == Spin::some || from.spin == Spin::all;
  if (to.goes_by_rounds && !looks) {
    names_.fail("with 'order: rounds', 'spin once' and 'spin until' are not built", from.place);
  }
  if (from.spin == Spin::until) resolve_until(from, to);
  if (looks) {
    const SourcePosition position = names_.position(from.place);
    check_looks(callbacks, "with 'spin some' and 'spin all'", position);
    // Before the look 0, behind it 1 and twice what it found.
    to.type.high = (Value{2} << callbacks.size()) - 1;
    to.target = add_slot("look", to.type, position);
    to.upper = make_constant(0, ValueKind::integer);
    if (from.expression) {
      to.upper = make_constant(names_.constant(*from.expression, "how many callbacks 'spin' runs"),
                               ValueKind::integer);
      if (to.upper.value < 1 || to.upper.value > max_counted) {
        names_.fail("'spin' runs from 1 to " + std::to_string(max_counted) + " callbacks",
                    from.expression->begin);
      }
      ValueType count;
      count.high = to.upper.value;
      to.counter = add_slot("count", count, position).index;
    }
  }
  for (const Callback* const callback : callbacks) {
    if (looks && callback->goes_by_clock) {
      names_.fail("'spin some' and 'spin all' do not go with a clock yet: that is not built",
                  from.place);
    }
    to.select_arms.push_back(resolve_start(*callback));
    for (const ModelUse& use : callback->start) work_.names.insert(use.model);
  }
  for (const syntax::SelectArm& late : from.select_arms) {
    to.select_arms.push_back(resolve_select_arm(late));
  }
  // A label holds before the first step, and not when a callback has ended.
  if (to.labels.empty()) return;
  Statement first;
  first.kind = Statement::Kind::inner;
  first.labels = std::exchange(to.labels, {});
  first.line = to.line;
  first.column = to.column;
  first.callback = to.callback;
  first.body = std::make_unique<Block>();
  first.body->statements.push_back(std::move(to));
  to = std::move(first);
}

bool CodeResolver::names_a_count(const syntax::Statement& from) const {
  using Spin = syntax::Statement::Spin;
  const bool is_counted = from.spin == Spin::some || from.spin == Spin::all;
  if (!is_counted || from.expression || from.name.text.empty()) return false;
  const auto known = names_.find(from.name.text);
  return known && known->kind == Binding::Kind::constant;
}

void CodeResolver::resolve_until(const syntax::Statement& from, Statement& to) {
  to.model = events_.model(from.model);
  const syntax::Arm& arm = from.arms.front();
  if (events_.service_of(to.model) == nullptr || !arm.output.name.is("answer")) {
    names_.fail("'spin until' waits for the answer of a service", from.model.place);
  }
  to.arms.push_back(resolve_awaited(to.model, arm));
}

std::unique_ptr<Block> CodeResolver::open_procedure() {
  auto procedure = open_block();
  procedure->is_procedure = procedure->is_callback = true;
  return procedure;
}

void CodeResolver::resolve_node_start(const Callback& callback, Block& block) {
  SelectArm arm = resolve_start(callback);
  Statement code;
  code.kind = Statement::Kind::inner;
  code.line = callback.position.line;
  code.column = callback.position.column;
  code.callback = &callback;
  code.body = std::move(arm.body);
  block.statements.push_back(std::move(code));
  block.statements.push_back(std::move(arm.end->statements.front()));
  for (const ModelUse& use : callback.end) work_.names.insert(use.model);
}

SelectArm CodeResolver::resolve_start(const Callback& callback) {
  const Context* const around = work_.context;
  Context start = *around, inside = *around;
  start.starts = &callback;
  start.callback = nullptr;
  inside.starts = nullptr;
  inside.callback = &callback;
  SelectArm arm;
  arm.starts = &callback;
  arm.line = callback.position.line;
  arm.column = callback.position.column;
  // It may stand where other code spins, whose variables and calls are not its own.
  std::vector<std::string> calls = std::exchange(work_.calls, {});
  std::set<std::uint32_t> asked = std::exchange(work_.asked, {});
  Scope indices;
  indices.is_barrier = true;
  for (const auto& [name, index] : callback.indices) {
    indices.names[name] = {Binding::Kind::constant, index, {}, false, nullptr};
  }
  work_.scopes.push_back(std::move(indices));
  work_.context = &start;
  resolve_when(callback, arm);
  if (callback.kind != Callback::Kind::subscription) {
    if (callback.kind == Callback::Kind::service || callback.kind == Callback::Kind::client) {
      arm.kind = SelectArm::Kind::service;
      work_.names.insert(callback.model);
    }
    arm.body = resolve_code(callback.code.get(), inside, open_procedure());
  } else {
    resolve_subscription(callback, inside, arm);
  }
  work_.context = around;
  work_.scopes.pop_back();
  if (arm.came) note_that_it_came(*arm.came, *arm.body);
  Statement end;
  end.kind = Statement::Kind::end_callback;
  end.line = callback.position.line;
  end.column = callback.position.column;
  end.callback = &callback;
  end.services.assign(work_.asked.begin(), work_.asked.end());
  work_.calls = std::move(calls);
  work_.asked = std::move(asked);
  arm.end = std::make_unique<Block>();
  arm.end->statements.push_back(std::move(end));
  return arm;
}

void CodeResolver::resolve_when(const Callback& callback, SelectArm& arm) {
  if (callback.when) arm.guard = names_.expression(*callback.when, ValueKind::boolean, "'when'");
  if (callback.goes_by_clock) arm.due = names_.find(due_of(callback.whole_name()))->expression;
  if (!callback.comes_once) return;
  const auto [known, is_new] = work_.came.try_emplace(callback.number);
  if (is_new) {
    ValueType type;
    type.kind = ValueKind::boolean;
    type.high = 1;
    known->second = add_slot(callback.whole_name() + " came", type, callback.position);
  }
  const Expression came = known->second;
  Expression not_yet = make_unary(Expression::Operator::negation, came, callback.position);
  arm.guard = arm.guard ? make_binary(Expression::Operator::conjunction, std::move(not_yet),
                                      std::move(*arm.guard), callback.position)
                        : std::move(not_yet);
  arm.came = came;
}

// Before the callback's code; it is no step.
void CodeResolver::note_that_it_came(const Expression& came, Block& code) const {
  Statement note;
  note.kind = Statement::Kind::assign;
  note.target = came;
  note.type = work_.tree.slots[came.index].type;
  note.expression = make_constant(1, ValueKind::boolean);
  code.statements.insert(code.statements.begin(), std::move(note));
}

void CodeResolver::resolve_subscription(const Callback& callback, const Context& inside,
                                        SelectArm& arm) {
  auto procedure = open_procedure();
  Event pattern;
  resolve_taken(*callback.takes, arm, pattern);
  if (!callback.outcomes.empty()) {
    if (!pattern.is_any) {
      throw ParseError("'takes' names an output, and so does 'do'", callback.position);
    }
    work_.scopes.pop_back();
    for (const auto& [output, code] : callback.outcomes) {
      procedure = open_procedure();
      Arm taken;
      taken.line = output->name.place.line;
      taken.column = output->name.place.column;
      taken.output = events_.output(arm.model, *output);
      taken.body = resolve_code(code.get(), inside, std::move(procedure));
      add_arm(arm.arms, std::move(taken), output->name, "do");
    }
    return;
  }
  const bool takes_output =
      arm.kind == SelectArm::Kind::input && (!pattern.is_any || has_outputs(arm));
  auto body = resolve_code(callback.code.get(), inside, std::move(procedure));
  if (!takes_output) {
    arm.body = std::move(body);
    return;
  }
  Arm taken;
  taken.output = std::move(pattern);
  taken.line = arm.line;
  taken.column = arm.column;
  taken.body = std::move(body);
  arm.arms.push_back(std::move(taken));
}

void CodeResolver::resolve_taken(const syntax::Taken& taken, SelectArm& arm, Event& pattern) const {
  arm.model = events_.model(taken.model);
  if (events_.service_of(arm.model) != nullptr) {
    names_.fail("a callback takes from a service by 'serves:', or is its client's",
                taken.name_place);
  }
  if (taken.is_output) {
    arm.kind = SelectArm::Kind::output;
    arm.event = events_.output(arm.model, taken.event);
  } else {
    arm.kind = SelectArm::Kind::input;
    arm.event = events_.input(arm.model, taken.event);
    pattern.is_any = !taken.output;
    pattern.line = arm.line;
    pattern.column = arm.column;
    if (taken.output) pattern = events_.output(arm.model, *taken.output);
  }
  if (!arm.model.is_topic) return;
  if (work_.context->stage != Context::Stage::names &&
      is_of_writer(events_.instance(arm.model).automaton, arm.event.name)) {
    names_.fail("a callback takes what a reader gets, and '" + arm.event.name + "' is the writer's",
                taken.name_place);
  }
  events_.for_each_topic(arm.model, [&](const Topic& topic) {
    for (const Topic::Reader& reader : topic.readers) {
      if (reader.callback != arm.starts->whole_name()) continue;
      arm.model.leaf.index = reader.model;
      arm.model.is_topic = false;
    }
    if (arm.model.is_topic) {
      names_.fail("this callback is no reader of " + topic.name, taken.name_place);
    }
  });
  arm.model.leaf.operands.clear();
  arm.model.leaf.dimensions.clear();
}

bool CodeResolver::has_outputs(const SelectArm& arm) const {
  const InterfaceAutomaton& automaton = events_.instance(arm.model).automaton;
  const auto input = automaton.inputs().find(arm.event.name);
  for (Symbol output = 0; output < automaton.outputs().size(); ++output) {
    if (!input || is_of_same_actor(automaton, *input, output)) return true;
  }
  return false;
}

std::unique_ptr<Block> CodeResolver::resolve_code(const syntax::Code* code, const Context& inside,
                                                  std::unique_ptr<Block> procedure) {
  const Context* const start = std::exchange(work_.context, &inside);
  if (code != nullptr) resolve_statements(code->block, *procedure);
  work_.context = start;
  work_.scopes.pop_back();
  return procedure;
}

// ---- Whole programs -----------------------------------------------------------------------------

namespace {

template <typename Resolve>
Tree resolve(const Context& context, const SourcePosition& begin, const Resolve& resolve_with) {
  Work work(context, begin);
  CodeResolver resolver(work);
  resolve_with(resolver);
  work.tree.names.assign(work.names.begin(), work.names.end());
  return std::move(work.tree);
}

}  // namespace

Tree resolve_program(const syntax::Code& code, const Context& context) {
  return resolve(context, {code.file, code.begin.line, code.begin.column},
                 [&](CodeResolver& resolver) { resolver.resolve_program(code); });
}

Tree resolve_thread(const Thread& thread, const SourcePosition& begin, const Context& context) {
  return resolve(context, begin, [&](CodeResolver& resolver) { resolver.resolve_thread(thread); });
}

}  // namespace maide::program_syntax
