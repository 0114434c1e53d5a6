#include "maide/automata/interface_automaton.hpp"

#include <algorithm>
#include <utility>

#include "maide/base/invariant.hpp"

namespace maide {

InterfaceAutomaton::InterfaceAutomaton(Alphabet inputs, Alphabet outputs, std::size_t states)
    : inputs_(std::move(inputs)), outputs_(std::move(outputs)), states_(states) {}

std::string InterfaceAutomaton::name(Action action) const {
  return action.is_input() ? "?" + inputs_.name(action.symbol) : "!" + outputs_.name(action.symbol);
}

std::size_t InterfaceAutomaton::transition_count() const {
  std::size_t count = 0;
  for (const State& state : states_) count += state.transitions.size();
  return count;
}

StateId InterfaceAutomaton::add_state() {
  states_.emplace_back();
  return static_cast<StateId>(states_.size() - 1);
}

void InterfaceAutomaton::add_transition(StateId from, Action action, StateId to, bool absorbed) {
  MAIDE_CHECK(from < states_.size() && to < states_.size());
  MAIDE_CHECK(action.symbol < (action.is_input() ? inputs_ : outputs_).size());
  const Transition transition{action, to, absorbed};
  auto& list = states_[from].transitions;
  const auto place = std::ranges::lower_bound(list, transition);
  if (place == list.end() || *place != transition) list.insert(place, transition);
}

void InterfaceAutomaton::mark_unexplored(StateId state, Symbol input) {
  MAIDE_CHECK(state < states_.size() && input < inputs_.size());
  auto& list = states_[state].unexplored;
  const auto place = std::ranges::lower_bound(list, input);
  if (place == list.end() || *place != input) list.insert(place, input);
}

bool InterfaceAutomaton::is_unexplored(StateId state, Symbol input) const {
  const auto& list = states_[state].unexplored;
  return std::ranges::binary_search(list, input);
}

StateId InterfaceAutomaton::successor(StateId state, Action action) const {
  const auto& list = states_[state].transitions;
  const auto place = std::lower_bound(
      list.begin(), list.end(), action,
      [](const Transition& transition, Action wanted) { return transition.action < wanted; });
  return place != list.end() && place->action == action ? place->target : Mealy::no_state;
}

bool InterfaceAutomaton::is_quiescent(StateId state) const {
  const auto& list = states_[state].transitions;  // sorted: outputs come last
  return list.empty() || list.back().action.is_input();
}

bool InterfaceAutomaton::is_input_enabled(StateId state) const {
  std::size_t enabled = 0;
  const Transition* last = nullptr;
  for (const Transition& transition : states_[state].transitions) {
    if (!transition.action.is_input()) break;
    if (transition.absorbed) return false;
    if (last == nullptr || last->action != transition.action) ++enabled;
    last = &transition;
  }
  return enabled == inputs_.size();
}

bool InterfaceAutomaton::is_input_enabled() const {
  for (StateId state = 0; state < states_.size(); ++state) {
    if (!is_input_enabled(state)) return false;
  }
  return true;
}

bool InterfaceAutomaton::is_deterministic() const {
  return std::ranges::all_of(states_, [](const State& state) {
    return std::ranges::adjacent_find(state.transitions,
                                      [](const Transition& left, const Transition& right) {
                                        return left.action == right.action;
                                      }) == state.transitions.end();
  });
}

bool InterfaceAutomaton::operator==(const InterfaceAutomaton& other) const {
  return inputs_ == other.inputs_ && outputs_ == other.outputs_ && initial_ == other.initial_ &&
         states_ == other.states_ && actors == other.actors &&
         hidden_returns == other.hidden_returns && origin == other.origin;
}

}  // namespace maide
