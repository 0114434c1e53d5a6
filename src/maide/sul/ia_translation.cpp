#include "maide/sul/ia_translation.hpp"

#include <algorithm>
#include <deque>
#include <map>
#include <utility>

#include "maide/automata/minimize.hpp"
#include "maide/base/error.hpp"
#include "maide/base/invariant.hpp"
#include "maide/base/text.hpp"
#include "maide/sul/fatal_words.hpp"

namespace maide {
namespace {

std::vector<std::string> split_outputs(const std::string& joined) {
  if (joined == "quiet") return {};
  const std::vector<std::string_view> outputs = split(joined, ',');
  return {outputs.begin(), outputs.end()};
}

StepStatus status_of(const std::string& output) {
  if (output == "refused") return StepStatus::refused;
  if (output == "unexplored") return StepStatus::unexplored;
  if (output == "absorbed") return StepStatus::absorbed;
  return StepStatus::taken;
}

}  // namespace

MacroStep read_eager_step(const std::string& output, StateId target) {
  MacroStep step{status_of(output), {}, target};
  if (step.status == StepStatus::taken) step.outputs = split_outputs(output);
  return step;
}

IaExpander::IaExpander(const Alphabet& inputs, std::size_t states, std::span<const Actor> actors)
    : automaton_(inputs, Alphabet(), states) {
  for (std::size_t actor = 0; actor < actors.size(); ++actor) {
    for (const std::string& output : actors[actor].outputs) {
      actor_of_.emplace(output, actor + 1);
      automaton_.intern_output(output);
    }
  }
}

void IaExpander::add_step(StateId state, Symbol input, const MacroStep& step) {
  const Action action{Action::Kind::input, input};
  switch (step.status) {
    case StepStatus::unexplored: automaton_.mark_unexplored(state, input); break;
    case StepStatus::absorbed: automaton_.add_transition(state, action, state, true); break;
    case StepStatus::taken:
      automaton_.add_transition(state, action, due_state(by_actor(step.outputs), step.target));
      break;
    default: break;
  }
  while (!unfinished_.empty()) {
    const auto [due, target, source] = std::move(unfinished_.back());
    unfinished_.pop_back();
    take_each_first(due, target, source);
  }
}

IaExpander::Due IaExpander::by_actor(const std::vector<std::string>& outputs) {
  std::map<std::size_t, std::vector<Symbol>> due;
  for (const std::string& output : outputs) {
    const auto actor = actor_of_.find(output);
    due[actor == actor_of_.end() ? 0 : actor->second].push_back(automaton_.intern_output(output));
  }
  Due result;
  for (auto& [actor, sequence] : due) result.push_back(std::move(sequence));
  return result;
}

// The state in which `due` is owed on the way to `target`; a new one is finished later.
StateId IaExpander::due_state(const Due& due, StateId target) {
  if (due.empty()) return target;
  const auto [place, is_new] = due_states_.emplace(std::pair(due, target), 0);
  if (is_new) {
    place->second = automaton_.add_state();
    unfinished_.push_back({due, target, place->second});
  }
  return place->second;
}

// The transitions of a state in which `due` is owed: any actor's first output may be taken.
void IaExpander::take_each_first(const Due& due, StateId target, StateId source) {
  for (std::size_t i = 0; i < due.size(); ++i) {
    Due rest = due;
    MAIDE_CHECK(!rest[i].empty());  // an actor that owes nothing is not listed
    const Action action{Action::Kind::output, rest[i].front()};
    rest[i].erase(rest[i].begin());
    if (rest[i].empty()) rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(i));
    automaton_.add_transition(source, action, due_state(rest, target));
  }
}

namespace {

// Reads a machine of either translation as steps from quiescence to quiescence.
class MacroMachine {
 public:
  MacroMachine(const Mealy& machine, Translation translation)
      : machine_(machine), translation_(translation) {
    inputs_ = machine.inputs().names();
    if (translation == Translation::av) {
      if (inputs_.empty() || inputs_.back() != delta_input) {
        throw UsageError("a machine of the av translation has 'Delta' as its last input");
      }
      inputs_.pop_back();
    }
  }

  const std::vector<std::string>& inputs() const { return inputs_; }

  MacroStep step(StateId state, Symbol input) const {
    const std::string& output = machine_.outputs().name(machine_.output(state, input));
    MacroStep result = read_eager_step(output, machine_.target(state, input));
    if (result.status != StepStatus::taken) {
      if (result.target != state) fail(state, input, "is refused and yet changes the state");
      return result;
    }
    if (translation_ == Translation::eager) return result;
    result.outputs.clear();
    if (output != "+") fail(state, input, "answers '" + output + "' where '+' is due");
    take_due_outputs(state, input, result);
    return result;
  }

 private:
  void take_due_outputs(StateId state, Symbol input, MacroStep& result) const {
    const auto delta = static_cast<Symbol>(inputs_.size());
    for (std::size_t i = 0; i <= machine_.size(); ++i) {
      const std::string& due = machine_.outputs().name(machine_.output(result.target, delta));
      const StateId next = machine_.target(result.target, delta);
      if (due == "delta") {
        if (next != result.target) fail(result.target, delta, "is quiescent and yet moves");
        return;
      }
      for (Symbol other = 0; other < delta; ++other) {
        const auto& answer = machine_.outputs().name(machine_.output(result.target, other));
        if (answer != "refused") fail(result.target, other, "is taken while an output is due");
      }
      result.outputs.push_back(due);
      result.target = next;
    }
    fail(state, input, "leads to outputs without end");
  }
  [[noreturn]] void fail(StateId state, Symbol input, const std::string& what) const {
    throw UsageError("state " + std::to_string(state) + ": input '" +
                     machine_.inputs().name(input) + "' " + what +
                     ": no machine of this translation");
  }

  const Mealy& machine_;
  Translation translation_;
  std::vector<std::string> inputs_;
};

// The answers of an interface automaton at a quiescent state, for to_mealy.
class QuiescentSteps {
 public:
  explicit QuiescentSteps(const InterfaceAutomaton& automaton) : automaton_(automaton) {
    if (!automaton.is_deterministic())
      throw UsageError("the interface automaton is not deterministic");
    if (!automaton.is_quiescent(automaton.initial())) {
      throw UsageError("the interface automaton has an output due in its initial state");
    }
  }

  MacroStep step(StateId state, Symbol input) const {
    MacroStep result{StepStatus::refused, {}, state};
    if (automaton_.is_unexplored(state, input)) {
      result.status = StepStatus::unexplored;
      return result;
    }
    const Action action{Action::Kind::input, input};
    for (const auto& transition : automaton_.transitions(state)) {
      if (transition.action != action) continue;
      result.status = transition.absorbed ? StepStatus::absorbed : StepStatus::taken;
      result.target = transition.target;
    }
    if (result.status == StepStatus::taken) flush(result);
    return result;
  }

 private:
  void flush(MacroStep& result) const {
    while (const auto* due = find_first_due(automaton_, result.target)) {
      result.outputs.push_back(automaton_.outputs().name(due->action.symbol));
      result.target = due->target;
      if (result.outputs.size() > automaton_.size()) {
        throw UsageError("the interface automaton emits outputs without end");
      }
    }
  }
  const InterfaceAutomaton& automaton_;
};

std::string joined(const std::vector<std::string>& outputs) {
  return outputs.empty() ? "quiet" : join(outputs, ",");
}

// Numbers pairs (outputs still due, quiescent state behind them) and fills a Mealy machine.
class MealyBuilder {
 public:
  MealyBuilder(const InterfaceAutomaton& automaton, Translation translation)
      : automaton_(automaton), steps_(automaton), translation_(translation) {
    std::vector<std::string> inputs = automaton.inputs().names();
    if (translation == Translation::av) inputs.emplace_back(delta_input);
    machine_ = Mealy(Alphabet(inputs), Alphabet(), 0);
  }

  Mealy build() {
    number({}, automaton_.initial());
    while (!work_.empty()) {
      const auto [due, state] = work_.front();
      work_.pop_front();
      fill(due, state, number(due, state));
    }
    MAIDE_CHECK(machine_.size() == numbers_.size() && machine_.is_complete());
    machine_.origin = automaton_.origin;
    machine_.actors = automaton_.actors;
    return minimize(machine_);
  }

 private:
  using Due = std::vector<std::string>;

  StateId number(const Due& due, StateId state) {
    const auto [place, is_new] = numbers_.emplace(std::pair(due, state), 0);
    if (is_new) {
      place->second = machine_.add_state();
      work_.emplace_back(due, state);
    }
    return place->second;
  }

  void fill(const Due& due, StateId state, StateId source) {
    const auto inputs = static_cast<Symbol>(automaton_.inputs().size());
    for (Symbol input = 0; input < inputs; ++input) {
      if (!due.empty()) {
        set(source, input, "refused", source);
        continue;
      }
      const MacroStep step = steps_.step(state, input);
      switch (step.status) {
        case StepStatus::unexplored: set(source, input, "unexplored", source); break;
        case StepStatus::absorbed: set(source, input, "absorbed", source); break;
        case StepStatus::taken:
          if (translation_ == Translation::eager) {
            set(source, input, joined(step.outputs), number({}, step.target));
          } else {
            set(source, input, "+", number(step.outputs, step.target));
          }
          break;
        default: set(source, input, "refused", source); break;
      }
    }
    if (translation_ != Translation::av) return;
    if (due.empty()) {
      set(source, inputs, "delta", source);
    } else {
      set(source, inputs, due.front(), number({due.begin() + 1, due.end()}, state));
    }
  }

  void set(StateId from, Symbol input, std::string_view output, StateId to) {
    machine_.set_transition(from, input, machine_.intern_output(output), to);
  }

  const InterfaceAutomaton& automaton_;
  QuiescentSteps steps_;
  Translation translation_;
  Mealy machine_;
  std::map<std::pair<Due, StateId>, StateId> numbers_;
  std::deque<std::pair<Due, StateId>> work_;
};

// The quiescent states that macro steps reach, the initial one first.
std::vector<StateId> quiescent_states(const Mealy& machine, const MacroMachine& steps) {
  std::vector<bool> seen(machine.size());
  std::vector<StateId> order{machine.initial()};
  seen[machine.initial()] = true;
  for (std::size_t i = 0; i < order.size(); ++i) {
    for (Symbol input = 0; input < steps.inputs().size(); ++input) {
      const StateId next = steps.step(order[i], input).target;
      if (!seen[next]) order.push_back(next);
      seen[next] = true;
    }
  }
  return order;
}

}  // namespace

InterfaceAutomaton to_interface_automaton(const Mealy& machine, Translation translation,
                                          std::span<const Actor> actors) {
  const MacroMachine steps(machine, translation);
  IaExpander expander(Alphabet(steps.inputs()), machine.size(), actors);
  for (const StateId state : quiescent_states(machine, steps)) {
    for (Symbol input = 0; input < steps.inputs().size(); ++input) {
      expander.add_step(state, input, steps.step(state, input));
    }
  }
  InterfaceAutomaton automaton = expander.take();
  automaton.set_initial(machine.initial());
  automaton.origin = machine.origin;
  automaton.actors.assign(actors.begin(), actors.end());
  return minimize(automaton);
}

InterfaceAutomaton to_interface_automaton(const NondeterministicMealy& machine,
                                          std::span<const Actor> actors) {
  IaExpander expander(machine.inputs(), machine.size(), actors);
  for (StateId state = 0; state < machine.size(); ++state) {
    for (Symbol input = 0; input < machine.inputs().size(); ++input) {
      const auto choices = machine.choices(state, input);
      if (choices.empty()) expander.add_step(state, input, {StepStatus::unexplored, {}, state});
      for (const auto& choice : choices) {
        const MacroStep step =
            read_eager_step(machine.outputs().name(choice.output), choice.target);
        if (step.status != StepStatus::taken && (choices.size() > 1 || step.target != state)) {
          throw UsageError("state " + std::to_string(state) + ": input '" +
                           machine.inputs().name(input) +
                           "' is at times taken and at times not, after the same events: what "
                           "decides that is not observed");
        }
        expander.add_step(state, input, step);
      }
    }
  }
  InterfaceAutomaton automaton = expander.take();
  automaton.set_initial(machine.initial());
  automaton.origin = machine.origin;
  automaton.actors.assign(actors.begin(), actors.end());
  return minimize(automaton);
}

Mealy to_mealy(const InterfaceAutomaton& automaton, Translation translation) {
  return MealyBuilder(automaton, translation).build();
}

const InterfaceAutomaton::Transition* find_first_due(const InterfaceAutomaton& automaton,
                                                     StateId state) {
  const auto rank = [&](const InterfaceAutomaton::Transition& transition) {
    const std::string& output = automaton.outputs().name(transition.action.symbol);
    for (std::size_t i = 0; i < automaton.actors.size(); ++i) {
      const auto& outputs = automaton.actors[i].outputs;
      if (std::ranges::find(outputs, output) != outputs.end()) return i + 1;
    }
    return std::size_t{0};  // of no actor: first, as in to_interface_automaton
  };
  const InterfaceAutomaton::Transition* first = nullptr;
  for (const auto& transition : automaton.transitions(state)) {
    if (transition.action.is_input()) continue;
    if (first == nullptr || rank(transition) < rank(*first)) first = &transition;
  }
  return first;
}

namespace {

// Every return of the input's call is among the outputs that are observed.
bool are_returns_observed(const SulInput& input, const SulInfo& info) {
  return !input.returns.empty() && std::ranges::all_of(input.returns, [&](const auto& name) {
    return std::ranges::any_of(info.outputs,
                               [&](const SulOutput& output) { return output.name == name; });
  });
}

}  // namespace

std::vector<std::string> find_hidden_returns(const Mealy& machine, Translation translation,
                                             const SulInfo& info) {
  const MacroMachine steps(machine, translation);
  const std::vector<StateId> states = quiescent_states(machine, steps);
  std::vector<std::string> hidden;
  for (Symbol input = 0; input < steps.inputs().size(); ++input) {
    if (are_returns_observed(info.inputs[input], info)) continue;
    const bool seen_busy = std::ranges::any_of(states, [&](StateId state) {
      const MacroStep step = steps.step(state, input);
      const bool is_end = !step.outputs.empty() && is_end_output(step.outputs.back());
      return step.status == StepStatus::taken && !is_end &&
             steps.step(step.target, input).status == StepStatus::refused;
    });
    if (seen_busy) hidden.push_back(info.inputs[input].name);
  }
  return hidden;
}

std::vector<std::string> find_hidden_returns(const NondeterministicMealy& machine,
                                             const SulInfo& info) {
  const auto has_status = [&](StateId state, Symbol input, StepStatus status, auto&& also) {
    const auto choices = machine.choices(state, input);
    return std::ranges::any_of(choices, [&](const auto& choice) {
      const MacroStep step = read_eager_step(machine.outputs().name(choice.output), choice.target);
      const bool is_end = !step.outputs.empty() && is_end_output(step.outputs.back());
      return step.status == status && !is_end && also(choice.target);
    });
  };
  std::vector<std::string> hidden;
  for (Symbol input = 0; input < machine.inputs().size(); ++input) {
    if (are_returns_observed(info.inputs[input], info)) continue;
    bool seen_busy = false;
    for (StateId state = 0; state < machine.size() && !seen_busy; ++state) {
      seen_busy = has_status(state, input, StepStatus::taken, [&](StateId next) {
        return has_status(next, input, StepStatus::refused, [](StateId) { return true; });
      });
    }
    if (seen_busy) hidden.push_back(info.inputs[input].name);
  }
  return hidden;
}

}  // namespace maide
