#include "maide/sul/ia_expansion.hpp"

namespace maide {
namespace {

std::vector<std::string> split_outputs(const std::string& joined) {
  std::vector<std::string> outputs;
  if (joined == "quiet") return outputs;
  for (std::size_t begin = 0;;) {
    const std::size_t comma = joined.find(',', begin);
    outputs.push_back(joined.substr(begin, comma - begin));
    if (comma == std::string::npos) return outputs;
    begin = comma + 1;
  }
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
    const Action action{Action::Kind::output, rest[i].front()};
    rest[i].erase(rest[i].begin());
    if (rest[i].empty()) rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(i));
    automaton_.add_transition(source, action, due_state(rest, target));
  }
}

}  // namespace maide
