#include "maide/check/system/steps.hpp"

#include <algorithm>
#include <limits>

#include "maide/base/invariant.hpp"

namespace maide {
namespace {

// A number made of digits, each below a bound of its own; the first one written is the first read.
class Digits {
 public:
  explicit Digits(std::uint64_t number = 0) : number_(number) {}

  void write(std::uint64_t digit, std::uint64_t bound) {
    MAIDE_CHECK(digit < bound && unit_ <= std::numeric_limits<std::uint64_t>::max() / bound);
    number_ += digit * unit_;
    unit_ *= bound;
  }
  std::uint64_t read(std::uint64_t bound) {
    const std::uint64_t digit = number_ % bound;
    number_ /= bound;
    return digit;
  }
  std::uint64_t number() const { return number_; }

 private:
  std::uint64_t number_, unit_ = 1;
};

}  // namespace

StepText describe_step(const System& system, const Step& step) {
  using Kind = ModelUse::Kind;
  const bool is_by_itself = doer_of(system, step) == nobody;
  StepText text{is_by_itself ? "" : actor_name(system, step.actor), place_of(system, step).line, "",
                ""};
  if (const CombinedStep* combined = combined_step_of(system, step)) {
    if (is_by_itself) {
      text.event = combined->text;
      return text;
    }
    const auto& events = combined->events;
    const bool is_of_one = std::ranges::all_of(
        events, [&](const ModelUse& event) { return event.model == events.front().model; });
    if (events.empty() || !is_of_one) {
      text.event = combined->text;
      return text;
    }
    const InterfaceAutomaton& automaton = system.models[events.front().model].automaton;
    text.model = system.models[events.front().model].name;
    for (const ModelUse& event : events) {
      text.event += event.kind == Kind::give ? "?" + automaton.inputs().name(event.index)
                                             : "!" + automaton.outputs().name(event.index);
    }
    return text;
  }
  const ProgramEdge& edge = edge_of(system, step);
  if (edge.kind == Kind::choice) {
    text.event = edge.index == 0 ? "if" : "else";
    return text;
  }
  const ModelInstance& instance = system.models[edge.model];
  if (edge.kind == Kind::act) {
    text.event = instance.actions[edge.index].name;
    return text;
  }
  text.model = instance.name;
  if (edge.kind == Kind::give) text.event = "?" + instance.automaton.inputs().name(edge.index);
  if (edge.kind == Kind::take) text.event = "!" + instance.automaton.outputs().name(edge.index);
  if (edge.kind == Kind::quiet) text.event = "quiet";
  return text;
}

bool is_wanted(const System& system, const Step& step, const WantedSteps& wanted) {
  if (wanted.actor && step.actor != *wanted.actor) return false;
  if (!wanted.event) return true;
  const auto events = events_of(system, step);
  return std::ranges::find(events, *wanted.event) != events.end();
}

std::size_t StepsByTheBook::most_actions() const {
  std::size_t most = system_->nobodys_actions.size();
  for (const Program& program : system_->programs) most = std::max(most, program.edges.size());
  return most;
}

std::uint64_t StepsByTheBook::code_of(const State& before, const Step& step) const {
  Digits code;
  code.write(actor_number(*system_, step.actor), actors());
  code.write(step.action, most_actions());
  code.write(step.is_beyond ? 1 : 0, 2);
  code.write(step.is_cut ? 1 : 0, 2);
  for (const ModelUse& use : uses_of(*system_, step)) {
    code.write(before.models[use.model], system_->models[use.model].automaton.size());
  }
  return code.number();
}

StepBefore StepsByTheBook::undo(const State& state, std::uint64_t code) const {
  Digits digits(code);
  StepBefore result{{}, state};
  const auto actor = static_cast<std::uint32_t>(digits.read(actors()));
  Step& step = result.step;
  step.actor = actor < system_->programs.size() ? actor : nobody;
  step.action = static_cast<std::uint32_t>(digits.read(most_actions()));
  step.is_beyond = digits.read(2) != 0;
  step.is_cut = digits.read(2) != 0;
  result.before.is_cut = false;
  if (step.actor != nobody) {
    result.before.programs[actor] = system_->programs[actor].source_of(step.action);
  }
  for (const ModelUse& use : uses_of(*system_, step)) {
    step.targets.push_back(state.models[use.model]);
    result.before.models[use.model] =
        static_cast<StateId>(digits.read(system_->models[use.model].automaton.size()));
  }
  MAIDE_CHECK(digits.number() == 0);
  return result;
}

}  // namespace maide
