#include "maide/check/language/built_in_models.hpp"

#include <utility>

#include "maide/base/invariant.hpp"

namespace maide {
namespace {

Action input(Symbol symbol) { return {Action::Kind::input, symbol}; }
Action output(Symbol symbol) { return {Action::Kind::output, symbol}; }

}  // namespace

InterfaceAutomaton make_mutex() {
  InterfaceAutomaton mutex({"lock", "unlock"}, {}, 2);
  mutex.add_transition(0, input(0), 1);
  mutex.add_transition(1, input(1), 0);
  return mutex;
}

InterfaceAutomaton make_semaphore(std::uint32_t count) {
  InterfaceAutomaton semaphore({"acquire", "release"}, {}, std::size_t{count} + 1);
  for (StateId taken = 0; taken < count; ++taken) {
    semaphore.add_transition(taken, input(0), taken + 1);
    semaphore.add_transition(taken + 1, input(1), taken);
  }
  return semaphore;
}

double queue_states(const QueueSize& queue) {
  const double letters = queue.values.empty() ? 1 : static_cast<double>(queue.values.size());
  double words = 0, longest = 1;
  for (std::uint32_t length = 0; length <= queue.size; ++length, longest *= letters)
    words += longest;
  // Contents when nobody waits, contents behind a message that is due, a reader that waits.
  return words + (words - longest / letters) * letters + 1;
}

InterfaceAutomaton make_queue(const QueueSize& queue) {
  GrowingQueue states(queue);
  InterfaceAutomaton automaton = states.start();
  for (StateId state = 0; state < automaton.size(); ++state) states.expand(automaton, state);
  return automaton;
}

GrowingQueue::GrowingQueue(QueueSize queue) : queue_(std::move(queue)) {
  if (!queue_.values.empty()) letters_ = static_cast<Symbol>(queue_.values.size());
  states_.emplace(Kept{{}, idle}, 0);
  met_.push_back({{}, idle});
  is_expanded_.push_back(false);
}

InterfaceAutomaton GrowingQueue::start() const {
  std::vector<std::string> inputs, outputs;
  for (const std::string& value : queue_.values) {
    inputs.push_back("write" + value);
    outputs.push_back("message" + value);
  }
  if (queue_.values.empty()) {
    inputs = {"write"};
    outputs = {"message"};
  }
  inputs.emplace_back("read");
  InterfaceAutomaton automaton(Alphabet(std::span<const std::string>(inputs)),
                               Alphabet(std::span<const std::string>(outputs)), 1);
  automaton.actors = {{"writer", {inputs.begin(), inputs.end() - 1}, {}},
                      {"reader", {"read"}, outputs}};
  return automaton;
}

StateId GrowingQueue::state_of(InterfaceAutomaton& automaton, Kept kept) {
  const auto [place, is_new] = states_.try_emplace(kept, static_cast<StateId>(met_.size()));
  if (is_new) {
    automaton.add_state();
    met_.push_back(std::move(kept));
    is_expanded_.push_back(false);
  }
  return place->second;
}

void GrowingQueue::expand(InterfaceAutomaton& automaton, StateId state) {
  if (is_expanded_[state]) return;
  is_expanded_[state] = true;
  const Kept kept = met_[state];
  if (is_due(state)) {
    automaton.add_transition(state, output(kept.second), state_of(automaton, {kept.first, idle}));
    return;
  }
  for (Symbol letter = 0; letter < letters_; ++letter) {
    Kept next = kept;
    if (kept.second == waiting) {
      next.second = letter;
    } else if (kept.first.size() < queue_.size) {
      next.first.push_back(letter);
    } else if (queue_.drops_oldest) {
      next.first.erase(next.first.begin());
      next.first.push_back(letter);
    } else {
      continue;
    }
    automaton.add_transition(state, input(letter), state_of(automaton, std::move(next)));
  }
  if (kept.second == waiting) return;
  Kept next = kept;
  if (kept.first.empty()) {
    next.second = waiting;
  } else {
    next.second = kept.first.front();
    next.first.erase(next.first.begin());
  }
  automaton.add_transition(state, input(letters_), state_of(automaton, std::move(next)));
}

void GrowingQueue::expand_with_messages(InterfaceAutomaton& automaton, StateId state) {
  expand(automaton, state);
  for (std::size_t i = 0; i < automaton.transitions(state).size(); ++i) {
    const StateId target = automaton.transitions(state)[i].target;
    if (is_due(target)) expand(automaton, target);
  }
}

InterfaceAutomaton GrowingQueue::cut_down(const InterfaceAutomaton& automaton,
                                          const std::vector<bool>& reached) const {
  InterfaceAutomaton result = start();
  constexpr StateId none = ~StateId{0};
  std::vector<StateId> numbers(automaton.size(), none), kept{automaton.initial()};
  numbers[automaton.initial()] = 0;
  const auto keep = [&](StateId state) {
    if (numbers[state] != none) return;
    numbers[state] = result.add_state();
    kept.push_back(state);
  };
  for (StateId state = 0; state < automaton.size(); ++state) {
    if (!reached[state]) continue;
    MAIDE_CHECK(is_expanded_[state]);
    keep(state);
    for (const auto& transition : automaton.transitions(state)) {
      if (is_due(transition.target)) keep(transition.target);
    }
  }
  const StateId elsewhere = result.add_state();
  for (Symbol input = 0; input <= letters_; ++input) result.mark_unexplored(elsewhere, input);
  for (const StateId state : kept) {
    for (const auto& transition : automaton.transitions(state)) {
      const StateId target = numbers[transition.target];
      result.add_transition(numbers[state], transition.action, target == none ? elsewhere : target);
    }
  }
  result.origin[queue_.drops_oldest ? "depth" : "size"] = std::to_string(queue_.size);
  return result;
}

}  // namespace maide
