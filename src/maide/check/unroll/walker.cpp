#include "maide/check/unroll/walker.hpp"

#include <algorithm>
#include <set>
#include <utility>

namespace maide::program_syntax {
namespace {

constexpr std::uint32_t for_ever = ~std::uint32_t{0};
constexpr std::size_t max_rounds = 1'000'000;  // of loops, without a step

template <typename Visit>
void for_each_block(const Statement& statement, const Visit& visit) {
  if (statement.body) visit(*statement.body);
  if (statement.otherwise) visit(*statement.otherwise);
  for (const Arm& arm : statement.arms) visit(*arm.body);
  for (const SelectArm& arm : statement.select_arms) {
    if (arm.body) visit(*arm.body);
    for (const Arm& output : arm.arms) visit(*output.body);
  }
}

bool is_loop(const Statement& statement) {
  using Kind = Statement::Kind;
  return statement.kind == Kind::loop || statement.kind == Kind::repeat ||
         statement.kind == Kind::repeat_while || statement.kind == Kind::repeat_for;
}

// The statement itself, without its blocks, is a step.
bool steps(const Statement& statement) {
  using Kind = Statement::Kind;
  switch (statement.kind) {
    case Kind::give:
    case Kind::wait:
    case Kind::arrival:
    case Kind::matched:
    case Kind::choice:
    case Kind::choose:
    case Kind::select:
    case Kind::rounds:
    case Kind::end_callback:
    case Kind::withdraw:
    case Kind::run:
    case Kind::join:
    case Kind::relock:
    case Kind::kill:
    case Kind::restart:
    case Kind::end_process:
    case Kind::spin:
    case Kind::refused_spin:
    case Kind::atomic: return true;
    case Kind::assign: return is_shared(statement.target) || reads_shared(*statement.expression);
    case Kind::when:
    case Kind::repeat_while: return reads_shared(*statement.expression);
    default: return false;
  }
}

// What control may do in a block, whatever the values of variables are.
struct Ways {
  bool step = false;  // take a step, or leave the loop
  bool end = true;    // come to the end of the block without
};

Ways ways_through(const Block& block);

Ways ways_through(const Statement& statement) {
  using Kind = Statement::Kind;
  const Kind kind = statement.kind;
  if (steps(statement) || kind == Kind::stop || kind == Kind::leave ||
      kind == Kind::leave_procedure || kind == Kind::leave_callback) {
    return {true, false};
  }
  if (kind == Kind::next_round) return {false, false};
  const bool is_known = statement.expression && statement.expression->is_constant();
  const bool is_zero = is_known && statement.expression->value == 0;
  if (kind == Kind::when) {
    const Ways then = is_zero ? Ways{false, false} : ways_through(*statement.body);
    Ways otherwise;
    if (is_known && !is_zero) {
      otherwise.end = false;
    } else if (statement.otherwise) {
      otherwise = ways_through(*statement.otherwise);
    }
    return {then.step || otherwise.step, then.end || otherwise.end};
  }
  Ways ways;
  if (kind == Kind::repeat && is_zero) return ways;
  for_each_block(statement,
                 [&](const Block& inner) { ways.step = ways.step || ways_through(inner).step; });
  return ways;
}

Ways ways_through(const Block& block) {
  Ways ways;
  for (const Statement& statement : block.statements) {
    if (!ways.end) break;
    const Ways next = ways_through(statement);
    ways = {ways.step || next.step, next.end};
  }
  return ways;
}

// Nothing but labels: one round of it is as good as many.
bool is_inert(const Block& block) {
  return std::all_of(block.statements.begin(), block.statements.end(), [](const Statement& s) {
    return s.kind == Statement::Kind::skip ||
           (s.kind == Statement::Kind::repeat && s.expression->is_constant() && is_inert(*s.body));
  });
}

}  // namespace

Walker::Walker(const Tree& tree, const Unrolled& program, ModelActions& actions, const Names& names,
               const RunControl& control)
    : Evaluator(program.number, actions, names), tree_(tree), control_(control) {
  program_.name = program.name;
  program_.position = program.position;
  program_.labels = tree.labels;
  program_.label_sets.emplace_back();
  program_.rounds.emplace_back();
  program_.fair_groups.emplace_back();
  program_.errors.emplace_back();
  program_.variables = tree.slots;
  program_.names = tree.names;
  value_ids_.emplace(Values(tree.slots.size()), 0);
  program_.valuations.emplace_back(tree.slots.size());
  frames_.emplace_back();
  frame_rounds_.push_back(0);
}

void Walker::begin() {
  check_loops(tree_.statements);
  settle(intern({&tree_.statements, 0, 1, 1, no_frame}), tree_.initial);
}

void Walker::check_loops(const Block& block) {
  for (const Statement& statement : block.statements) {
    using Kind = Statement::Kind;
    const bool is_endless = statement.kind == Kind::loop || (statement.kind == Kind::repeat_while &&
                                                             statement.expression->is_constant() &&
                                                             statement.expression->value != 0);
    if (is_endless && !ways_through(*statement.body).step) {
      throw ParseError(
          "this loop would go round for ever without a step: nothing in it gives "
          "an input, waits or chooses",
          at(statement.line, statement.column));
    }
    if (is_loop(statement)) loops_.emplace(statement.body.get(), &statement);
    for_each_block(statement, [&](const Block& inner) { check_loops(inner); });
  }
}

// ---- frames -------------------------------------------------------------------------------------

FrameId Walker::intern(const Frame& frame, FrameId before) {
  const auto [place, is_new] = frame_ids_.try_emplace(frame, static_cast<FrameId>(frames_.size()));
  if (is_new) {
    frames_.push_back(frame);
    frame_rounds_.push_back(before == no_frame ? make_round(frame) : frame_rounds_[before]);
  }
  return place->second;
}

std::uint32_t Walker::make_round(const Frame& first) {
  const std::uint32_t outer = frame_rounds_[first.parent];
  const auto loop = loops_.find(first.block);
  if (loop == loops_.end()) return outer;
  const Statement& statement = *loop->second;
  Program::Round round{outer, statement.line, statement.column, 0, 0};
  using Kind = Statement::Kind;
  if (statement.kind == Kind::repeat || statement.kind == Kind::repeat_for) {
    round.number = first.count - first.rounds + 1;
    round.count = first.count;
  }
  program_.rounds.push_back(round);
  return static_cast<std::uint32_t>(program_.rounds.size() - 1);
}

FrameId Walker::behind(FrameId id) {
  Frame frame = frames_[id];
  ++frame.index;
  return intern(frame, id);
}

FrameId Walker::before(FrameId id) const {
  Frame frame = frames_[id];
  --frame.index;
  return frame_ids_.at(frame);
}

const Statement& Walker::statement_at(FrameId id) const {
  return frames_[id].block->statements[frames_[id].index];
}

void Walker::end_variables(const Block& block, Values& values) const {
  if (&block == &tree_.statements) return;  // they stay when the program has ended
  for (const std::uint32_t slot : block.slots) values[slot].reset();
}

// ---- walking ------------------------------------------------------------------------------------

std::uint32_t Walker::intern_values(const Values& values) {
  const auto [place, is_new] =
      value_ids_.try_emplace(values, static_cast<std::uint32_t>(program_.valuations.size()));
  if (is_new) program_.valuations.push_back(values);
  return place->second;
}

ControlState Walker::settle(FrameId id, Values values) {
  try {
    return walk(id, values);
  } catch (const EvaluationError& error) {
    return error_state(error.text, error.line, error.column);
  }
}

ControlState Walker::walk(FrameId id, Values& values) {
  std::vector<std::uint32_t> labels;
  std::set<std::pair<FrameId, std::uint32_t>> passed;  // begins of rounds, with their values
  std::size_t rounds = 0;
  while (id != no_frame) {
    const Frame frame = frames_[id];
    if (frame.index == frame.block->statements.size()) {
      const auto loop = loops_.find(frame.block);
      const std::optional<Value> counted = counted_value(loop, values);
      end_variables(*frame.block, values);
      if (loop == loops_.end()) {
        id = frame.parent;
        continue;
      }
      const Statement& statement = *loop->second;
      if (statement.kind == Statement::Kind::repeat_while && steps(statement)) {
        id = before(frame.parent);  // where the condition is read, as on the first round
        break;
      }
      id = next_round(frame, statement, counted, values);
      if (++rounds == max_rounds) throw too_many_rounds(statement);
      const bool may_be_endless = statement.kind == Statement::Kind::loop ||
                                  statement.kind == Statement::Kind::repeat_while;
      if (may_be_endless && frames_[id].block == frame.block &&
          !passed.emplace(id, intern_values(values)).second) {
        throw EvaluationError{"control goes round without a step", statement.line,
                              statement.column};
      }
      continue;
    }
    const Statement& statement = frame.block->statements[frame.index];
    labels.insert(labels.end(), statement.labels.begin(), statement.labels.end());
    if (statement.kind == Statement::Kind::stop) {
      while (id != no_frame) id = leave(id, values);
      break;
    }
    if (steps(statement)) {
      check_arrival(statement, values);
      break;
    }
    id = pass(id, statement, values);
  }
  const bool awaits = id != no_frame && statement_at(id).kind == Statement::Kind::wait;
  return control_state({id, awaits ? Phase::awaits : Phase::before,
                        intern_labels(std::move(labels)), intern_values(values), 0, 0});
}

std::optional<std::vector<Value>> Walker::choices_of(const Statement& statement,
                                                     const Values& values) const {
  std::vector<Value> choices;
  if (!statement.expression) {  // those of its type
    const std::uint64_t count = statement.type.count();
    if (count > max_outcomes) return std::nullopt;
    for (std::uint64_t i = 0; i < count; ++i) choices.push_back(statement.type.at(i));
    return choices;
  }
  const Value low = evaluate(*statement.expression, values);
  const Value high = evaluate(statement.upper, values);
  if (distance(low, high) >= max_outcomes) return std::nullopt;
  for (Value value = low; value <= high; ++value) choices.push_back(value);
  return choices;
}

ParseError Walker::too_many_rounds(const Statement& statement) const {
  return ParseError(
      "this loop goes round more than " + std::to_string(max_rounds) + " times without a step",
      at(statement.line, statement.column));
}

std::optional<Value> Walker::counted_value(Loops::const_iterator loop, const Values& values) const {
  if (loop == loops_.end() || loop->second->kind != Statement::Kind::repeat_for) {
    return std::nullopt;
  }
  return values[loop->second->target.index];
}

FrameId Walker::next_round(const Frame& frame, const Statement& loop, std::optional<Value> counted,
                           Values& values) {
  const Frame again{frame.block, 0, frame.rounds, frame.count, frame.parent};
  switch (loop.kind) {
    case Statement::Kind::loop: return intern(again);
    case Statement::Kind::repeat_while:
      return evaluate(*loop.expression, values) != 0 ? intern(again) : frame.parent;
    default: break;
  }
  if (frame.rounds == 1) return frame.parent;
  if (counted) values[loop.target.index] = *counted + 1;
  return intern({frame.block, 0, frame.rounds - 1, frame.count, frame.parent});
}

FrameId Walker::pass(FrameId id, const Statement& statement, Values& values) {
  using Kind = Statement::Kind;
  switch (statement.kind) {
    case Kind::loop: return intern({statement.body.get(), 0, for_ever, for_ever, behind(id)});
    case Kind::repeat: return enter_repeat(id, statement, values);
    case Kind::repeat_for: return enter_for(id, statement, values);
    case Kind::repeat_while:
      if (evaluate(*statement.expression, values) == 0) return behind(id);
      return enter(*statement.body, behind(id));
    case Kind::when:
      return enter(branch(statement, evaluate(*statement.expression, values)), behind(id));
    case Kind::inner: return enter(*statement.body, behind(id));
    case Kind::assign:
      assign(statement, evaluate(*statement.expression, values), values);
      return behind(id);
    case Kind::leave:
    case Kind::next_round: {
      while (!loops_.contains(frames_[id].block)) id = leave(id, values);
      if (statement.kind == Kind::leave) return leave(id, values);
      Frame end = frames_[id];
      end.index = static_cast<std::uint32_t>(end.block->statements.size());
      return intern(end, id);
    }
    case Kind::leave_procedure:
      while (!frames_[id].block->is_procedure) id = leave(id, values);
      return leave(id, values);
    case Kind::leave_callback:
      while (!frames_[id].block->is_callback) id = leave(id, values);
      return leave(id, values);
    default: return behind(id);
  }
}

FrameId Walker::leave(FrameId id, Values& values) const {
  end_variables(*frames_[id].block, values);
  return frames_[id].parent;
}

void Walker::assign(const Statement& statement, Value value, Values& values) const {
  if (statement.slots == 0) return set(statement.target, statement.type, value, values);
  check_range(statement.target, statement.type, value);
  for (std::uint32_t i = 0; i < statement.slots; ++i) values[statement.target.index + i] = value;
}

FrameId Walker::enter_repeat(FrameId id, const Statement& statement, const Values& values) {
  const Value count = evaluate(*statement.expression, values);
  if (count < 0 || count > static_cast<Value>(max_control_states)) {
    throw EvaluationError{"'repeat' goes from 0 to " + std::to_string(max_control_states) +
                              ", and this is " + std::to_string(count),
                          statement.line, statement.column};
  }
  if (count == 0) return behind(id);
  const auto rounds = is_inert(*statement.body) ? 1 : static_cast<std::uint32_t>(count);
  return intern({statement.body.get(), 0, rounds, rounds, behind(id)});
}

FrameId Walker::enter_for(FrameId id, const Statement& statement, Values& values) {
  const Value low = evaluate(*statement.expression, values);
  const Value high = evaluate(statement.upper, values);
  if (low > high) return behind(id);
  if (distance(low, high) >= max_control_states) {
    throw EvaluationError{
        "'for' goes round more than " + std::to_string(max_control_states) + " times",
        statement.line, statement.column};
  }
  const auto rounds = static_cast<std::uint32_t>(high - low + 1);
  values[statement.target.index] = low;
  return intern({statement.body.get(), 0, rounds, rounds, behind(id)});
}

void Walker::check_arrival(const Statement& statement, const Values& values) const {
  using Kind = Statement::Kind;
  switch (statement.kind) {
    case Kind::give: {
      check_end(statement.model, statement.input, values);
      input_of(model_of(statement.model, values), statement.input, values);
      break;
    }
    case Kind::wait:
      model_of(statement.model, values);
      check_end(statement.model, statement.arms.front().output, values);
      break;
    case Kind::arrival: check_end(statement.model, true, statement.input, values); break;
    case Kind::assign:
      element(statement.target, values);
      if (!reads_shared(*statement.expression)) evaluate(*statement.expression, values);
      break;
    case Kind::choose:
      element(statement.target, values);
      if (statement.expression &&
          evaluate(*statement.expression, values) > evaluate(statement.upper, values)) {
        throw EvaluationError{"'any' has nothing to choose from", statement.line, statement.column};
      }
      break;
    case Kind::select:
    case Kind::rounds:
    case Kind::spin:
      for (const SelectArm& arm : statement.select_arms) {
        if (arm.guard && (reads_shared(*arm.guard) || evaluate(*arm.guard, values) == 0)) continue;
        check_arm(arm, values);
      }
      break;
    default: break;
  }
}

void Walker::check_arm(const SelectArm& arm, const Values& values) const {
  if (arm.kind == SelectArm::Kind::arrival) {
    element(arm.model.leaf, values);
    return check_end(arm.model, true, arm.event, values);
  }
  if (arm.kind != SelectArm::Kind::input && arm.kind != SelectArm::Kind::output) return;
  const std::uint32_t model = model_of(arm.model, values);
  check_end(arm.model, arm.event, values);
  if (arm.kind == SelectArm::Kind::input) input_of(model, arm.event, values);
}

std::uint32_t Walker::intern_labels(std::vector<std::uint32_t> labels) {
  if (labels.empty()) return 0;
  std::sort(labels.begin(), labels.end());
  labels.erase(std::unique(labels.begin(), labels.end()), labels.end());
  auto& sets = program_.label_sets;
  const auto [place, is_new] =
      label_set_ids_.try_emplace(labels, static_cast<std::uint32_t>(sets.size()));
  if (is_new) sets.push_back(std::move(labels));
  return place->second;
}

ControlState Walker::control_state(const Place& place) {
  const auto [entry, is_new] =
      control_states_.try_emplace(place, static_cast<ControlState>(places_.size()));
  if (is_new) {
    if (places_.size() == max_control_states) throw too_large(place);
    places_.push_back(place);
  }
  return entry->second;
}

ControlState Walker::error_state(const std::string& text, int line, int column) {
  const auto [place, is_new] = error_ids_.try_emplace(
      {line, column, text}, static_cast<std::uint32_t>(program_.errors.size()));
  if (is_new) program_.errors.push_back({text, at(line, column)});
  return control_state({no_frame, Phase::error, 0, 0, place->second, 0});
}

ControlState Walker::with_value(const Place& place, const Statement& statement, Value value,
                                Values values) {
  if (is_shared(statement.target)) {
    return control_state({place.frame, Phase::writes, 0, place.valuation, 0, value});
  }
  try {
    assign(statement, value, values);
  } catch (const EvaluationError& error) {
    return error_state(error.text, error.line, error.column);
  }
  return settle(behind(place.frame), std::move(values));
}

Error Walker::too_large(const Place& place) const {
  SourcePosition where = program_.position;
  if (place.frame != no_frame) {
    where.line = statement_at(place.frame).line;
    where.column = statement_at(place.frame).column;
  }
  return Error(ExitStatus::inconclusive, "program " + program_.name + " has more than " +
                                             std::to_string(max_control_states) +
                                             " control states (" + to_string(where) + ")");
}

ControlState Walker::behind_condition(const Place& place, const Statement& statement, Value value,
                                      const Values& values) {
  const FrameId next = behind(place.frame);
  if (statement.kind == Statement::Kind::when) {
    return settle(enter(branch(statement, value), next), values);
  }
  return settle(value == 0 ? next : enter(*statement.body, next), values);
}

ControlState Walker::behind_input(const Place& place, const Statement& statement,
                                  const Values& values) {
  if (statement.arms.empty()) return settle(behind(place.frame), values);
  return control_state({place.frame, Phase::awaits, 0, place.valuation, 0, 0});
}

ControlState Walker::take(const Event& pattern, const Block& body, FrameId next,
                          const std::string& output, const Values& values) {
  try {
    return settle(enter(body, next), bind(pattern, output, values));
  } catch (const EvaluationError& error) {
    return error_state(error.text, error.line, error.column);
  }
}

}  // namespace maide::program_syntax
