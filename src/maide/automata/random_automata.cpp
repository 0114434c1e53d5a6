#include "maide/automata/random_automata.hpp"

#include <string>
#include <utility>
#include <vector>

#include "maide/base/error.hpp"

namespace maide {

namespace {

Alphabet numbered(const char* prefix, std::size_t size) {
  Alphabet alphabet;
  for (std::size_t number = 0; number < size; ++number) {
    alphabet.intern(prefix + std::to_string(number));
  }
  return alphabet;
}

// Free places for edges, `width` in each state that is reachable so far. A random tree takes one
// for each new state; there is always one left, for n states have n x width places and n-1 edges.
class FreePlaces {
 public:
  explicit FreePlaces(std::size_t width) : width_(width) {}
  void add_state(StateId state) {
    for (std::size_t action = 0; action < width_; ++action) places_.emplace_back(state, action);
  }
  std::pair<StateId, std::size_t> take(Random& random) {
    std::swap(places_[random.below(places_.size())], places_.back());
    const auto place = places_.back();
    places_.pop_back();
    return place;
  }
  const std::vector<std::pair<StateId, std::size_t>>& rest() const { return places_; }

 private:
  std::size_t width_;
  std::vector<std::pair<StateId, std::size_t>> places_;
};

}  // namespace

Mealy random_mealy(const RandomMealyOptions& options, Random& random) {
  if (options.states == 0 || options.outputs == 0 || (options.states > 1 && options.inputs == 0)) {
    throw UsageError("a random Mealy machine needs states, inputs and outputs");
  }
  Mealy machine(numbered("i", options.inputs), numbered("o", options.outputs), options.states);
  const auto connect = [&](std::pair<StateId, std::size_t> place, StateId target) {
    machine.set_transition(place.first, static_cast<Symbol>(place.second),
                           static_cast<Symbol>(random.below(options.outputs)), target);
  };
  FreePlaces places(options.inputs);
  places.add_state(0);
  for (StateId state = 1; state < options.states; ++state) {
    connect(places.take(random), state);
    places.add_state(state);
  }
  for (const auto& place : places.rest()) {
    connect(place, static_cast<StateId>(random.below(options.states)));
  }
  return machine;
}

Mealy mutate(const Mealy& machine, std::size_t changes, Random& random) {
  const std::size_t inputs = machine.inputs().size();
  if (machine.size() == 0 || inputs == 0) throw UsageError("there is no transition to mutate");
  Mealy result = machine;
  const auto any_state = [&] { return static_cast<StateId>(random.below(result.size())); };
  const auto any_input = [&] { return static_cast<Symbol>(random.below(inputs)); };
  const auto change_one = [&](StateId state) {
    const Symbol input = any_input();
    if (random.chance(0.5)) {
      const auto output = static_cast<Symbol>(random.below(result.outputs().size()));
      result.set_transition(state, input, output, result.target(state, input));
    } else {
      result.set_transition(state, input, result.output(state, input), any_state());
    }
  };
  for (std::size_t change = 0; change < changes; ++change) {
    const StateId state = any_state();
    if (random.below(3) != 0) {
      change_one(state);
      continue;
    }
    const Symbol input = any_input();
    const StateId copied = result.target(state, input);
    const StateId copy = result.add_state();
    for (Symbol i = 0; i < inputs; ++i) {
      result.set_transition(copy, i, result.output(copied, i), result.target(copied, i));
    }
    result.set_transition(state, input, result.output(state, input), copy);
    change_one(copy);
  }
  return result;
}

InterfaceAutomaton random_interface_automaton(const RandomInterfaceAutomatonOptions& options,
                                              Random& random) {
  const std::size_t actions = options.inputs + options.outputs;
  if (options.states == 0 || actions == 0) {
    throw UsageError("a random interface automaton needs states and actions");
  }
  InterfaceAutomaton automaton(numbered("i", options.inputs), numbered("o", options.outputs),
                               options.states);
  const auto action = [&](std::size_t number) {
    return number < options.inputs
               ? Action{Action::Kind::input, static_cast<Symbol>(number)}
               : Action{Action::Kind::output, static_cast<Symbol>(number - options.inputs)};
  };
  const auto any_state = [&] { return static_cast<StateId>(random.below(options.states)); };
  FreePlaces places(actions);
  places.add_state(0);
  for (StateId state = 1; state < options.states; ++state) {
    const auto [from, number] = places.take(random);
    automaton.add_transition(from, action(number), state);
    if (!options.deterministic && random.chance(0.3)) {
      automaton.add_transition(from, action(number), any_state());
    }
    places.add_state(state);
  }
  for (const auto& [state, number] : places.rest()) {
    const Action free = action(number);
    if (random.chance(options.density)) {
      automaton.add_transition(state, free, any_state());
      if (!options.deterministic && random.chance(0.3)) {
        automaton.add_transition(state, free, any_state());
      }
    } else if (free.is_input() && random.chance(options.unexplored)) {
      automaton.mark_unexplored(state, free.symbol);
    } else if (free.is_input() && random.chance(options.absorbed)) {
      automaton.add_transition(state, free, state, true);
    }
  }
  return automaton;
}

}  // namespace maide
