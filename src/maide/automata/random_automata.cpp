#include "maide/automata/random_automata.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "maide/automata/minimize.hpp"
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

namespace {

constexpr std::array<std::string_view, 8> class_names{"pairs", "triples", "counters", "login",
                                                      "sinks", "modes",   "layers",   "nothing"};
constexpr std::size_t most_repeats = 60;  // of an input that is counted

// A machine in the making: an input that is not set does nothing.
class Builder {
 public:
  Builder(std::size_t inputs, Random& random) : random_(random) {
    Alphabet names, outputs;
    for (std::size_t i = 0; i < inputs; ++i) names.intern("i" + std::to_string(i));
    for (const char* output : {"ok", "yes", "no", "end"}) outputs.intern(output);
    machine_ = Mealy(std::move(names), std::move(outputs), 0);
    add_state();
  }

  StateId add_state() {
    const StateId state = machine_.add_state();
    for (Symbol input = 0; input < machine_.inputs().size(); ++input) {
      machine_.set_transition(state, input, ok, state);
    }
    return state;
  }
  Symbol any_input() { return static_cast<Symbol>(random_.below(machine_.inputs().size())); }
  StateId any_state() { return static_cast<StateId>(random_.below(machine_.size())); }
  Symbol any_output() { return static_cast<Symbol>(random_.below(machine_.outputs().size())); }
  bool is_idle(StateId state, Symbol input) const {
    return machine_.target(state, input) == state && machine_.output(state, input) == ok;
  }
  std::size_t count_idle_inputs(StateId state) const {
    std::size_t count = 0;
    for (Symbol input = 0; input < machine_.inputs().size(); ++input) {
      count += is_idle(state, input) ? 1 : 0;
    }
    return count;
  }
  // One that does nothing in a state; there must be one.
  Symbol any_idle_input(StateId state) {
    Symbol input = any_input();
    while (!is_idle(state, input)) input = any_input();
    return input;
  }
  Symbol other_input(Symbol input) {
    Symbol other = any_input();
    while (other == input) other = any_input();
    return other;
  }
  void set(StateId from, Symbol input, Symbol output, StateId to) {
    machine_.set_transition(from, input, output, to);
  }

  // These inputs in a row lead from one state to another, through new ones; a wrong input leads
  // back, or is not read, as drawn for the whole lock.
  void lock(StateId from, std::size_t length, StateId to) {
    const bool forgives = random_.chance(0.3);
    StateId state = from;
    for (std::size_t i = 0; i < length; ++i) {
      const StateId next = i + 1 == length ? to : add_state();
      if (next != to && !forgives) {
        for (Symbol input = 0; input < machine_.inputs().size(); ++input) {
          set(next, input, ok, from);
        }
      }
      const Symbol key = free_input(state, from, forgives);
      set(state, key, ok, next);
      state = next;
    }
  }
  // An input that says in which state one is.
  void show(StateId state) {
    const Symbol input = any_input();
    const StateId target = machine_.target(state, input);
    set(state, input, static_cast<Symbol>(1 + random_.below(3)), target);
  }

  // A random machine with some states in place of `state` and new ones; returns one of them. Only
  // some inputs do something in each.
  StateId grow(StateId state, std::size_t states) {
    std::vector<StateId> all{state};
    for (std::size_t i = 1; i < states; ++i) {
      const StateId next = add_state();
      set(all[random_.below(all.size())], any_input(), any_output(), next);
      all.push_back(next);
    }
    for (const StateId from : all) {
      for (std::size_t i = 0; i < 2 + machine_.inputs().size() / 4; ++i) {
        const Symbol input = any_input();
        if (machine_.target(from, input) != from) continue;  // it keeps all reachable
        set(from, input, any_output(), all[random_.below(all.size())]);
      }
    }
    return all.back();
  }

  Mealy finish() const { return minimize(machine_); }
  std::size_t size() const { return machine_.size(); }

  static constexpr Symbol ok = 0, yes = 1, no = 2;

 private:
  // One that does nothing there yet, if there is one.
  Symbol free_input(StateId state, StateId first, bool forgives) {
    const auto is_free = [&](StateId target) {
      return target == state || (!forgives && target == first);
    };
    const auto row = machine_.row(state);
    const bool is_any_free = std::ranges::any_of(
        row, [&](const auto& transition) { return is_free(transition.target); });
    Symbol input = any_input();
    while (is_any_free && !is_free(row[input].target)) input = any_input();
    return input;
  }

  Random& random_;
  Mealy machine_;
};

Mealy make_locks(Builder builder, std::size_t states, std::size_t length) {
  StateId level = 0;
  builder.show(level);
  while (builder.size() + length <= std::max(states, 1 + 2 * length)) {
    const StateId next = builder.add_state();
    builder.lock(level, length, next);
    builder.show(next);
    level = next;
  }
  return builder.finish();
}

// From a state on, where two inputs do nothing: a count, which other inputs leave or not, and what
// shows at its end.
StateId add_counter(Builder& builder, StateId from, std::size_t repeats, Random& random) {
  const Symbol counted = builder.any_idle_input(from);
  Symbol shows = builder.any_idle_input(from);
  while (shows == counted) shows = builder.any_idle_input(from);
  const bool resets = random.chance(0.5), stays = random.chance(0.5);
  std::vector<StateId> row{from};
  for (std::size_t i = 0; i < repeats; ++i) {
    const StateId next = builder.add_state();
    if (resets) {
      for (Symbol input = 0; input < shows; ++input) builder.set(next, input, Builder::ok, from);
      builder.set(next, shows, Builder::ok, from);
    }
    builder.set(row.back(), counted, Builder::ok, next);
    row.push_back(next);
  }
  // At the end the count stays full, or begins anew, so that it shows at one number only.
  builder.set(row.back(), counted, Builder::ok, stays ? row.back() : from);
  builder.set(row.back(), shows, Builder::yes, row.back());
  return row.back();
}

Mealy make_counters(Builder builder, std::size_t states, Random& random) {
  const std::size_t most = std::min(states, most_repeats);
  const std::size_t first = random.between(std::min<std::size_t>(5, most), most);
  const StateId full = add_counter(builder, 0, first, random);
  if (random.chance(0.3)) {
    const StateId from = random.chance(0.5) ? full : StateId{0};
    const std::size_t second = random.between(3, std::max<std::size_t>(most / 2, 4));
    if (builder.count_idle_inputs(from) >= 2) add_counter(builder, from, second, random);
  }
  return builder.finish();
}

Mealy make_login(Builder builder, std::size_t states) {
  builder.show(0);
  const StateId inside = builder.add_state();
  builder.lock(0, 3, inside);
  builder.grow(inside, states);
  return builder.finish();
}

// Each state of the way goes on by a few inputs; of the others, most end it.
Mealy make_sinks(Builder builder, std::size_t states, std::size_t inputs, Random& random) {
  std::vector<StateId> sinks{builder.add_state(), builder.add_state()};
  builder.set(sinks[1], builder.any_input(), Builder::no, sinks[1]);
  std::vector<StateId> way{0};
  while (way.size() + 2 < states) way.push_back(builder.add_state());
  for (std::size_t i = 0; i < way.size(); ++i) {
    for (Symbol input = 0; input < inputs; ++input) {
      if (random.chance(0.8)) builder.set(way[i], input, Builder::no, sinks[random.below(2)]);
    }
    for (std::size_t turn = 0; turn < 2; ++turn) {
      const StateId back = way[random.below(i + 1)];
      builder.set(way[i], builder.any_input(), builder.any_output(), back);
    }
    if (i + 1 < way.size()) builder.set(way[i], builder.any_input(), Builder::ok, way[i + 1]);
  }
  return builder.finish();
}

Mealy make_modes(Builder builder, std::size_t states, Random& random) {
  const Symbol turn = builder.any_input();
  std::vector<StateId> modes{0};
  while (modes.size() < states) {
    const StateId next = builder.add_state();
    builder.set(modes.back(), turn, Builder::ok, next);
    modes.push_back(next);
  }
  builder.set(modes.back(), turn, Builder::ok, modes[random.below(modes.size())]);
  for (const StateId mode : modes) {
    const Symbol rare = builder.other_input(turn);
    builder.set(mode, rare, builder.any_output(), modes[random.below(modes.size())]);
  }
  return builder.finish();
}

Mealy make_layers(Builder builder, std::size_t states) {
  StateId layer = 0;
  std::size_t left = states;
  while (left > 0) {
    const std::size_t size = std::min<std::size_t>(left, 10);
    const StateId last = builder.grow(layer, size);
    left -= size;
    if (left == 0) break;
    layer = builder.add_state();
    builder.lock(last, 1, layer);
  }
  return builder.finish();
}

}  // namespace

std::span<const std::string_view> hiding_names() { return class_names; }

Hiding find_hiding(std::string_view name) {
  const auto found = std::ranges::find(class_names, name);
  if (found == class_names.end()) {
    throw UsageError(
        fmt::format("nothing hides like '{}'; known are {}", name, fmt::join(class_names, ", ")));
  }
  return static_cast<Hiding>(found - class_names.begin());
}

Mealy hiding_mealy(Hiding hiding, std::size_t states, std::size_t inputs, Random& random) {
  if (states < 4 || inputs < 4) {
    throw UsageError("a machine that hides something needs four states and inputs");
  }
  Builder builder(inputs, random);
  switch (hiding) {
    case Hiding::pairs: return make_locks(std::move(builder), states, 2);
    case Hiding::triples: return make_locks(std::move(builder), states, 3);
    case Hiding::counters: return make_counters(std::move(builder), states, random);
    case Hiding::login: return make_login(std::move(builder), states);
    case Hiding::sinks: return make_sinks(std::move(builder), states, inputs, random);
    case Hiding::modes: return make_modes(std::move(builder), states, random);
    case Hiding::layers: return make_layers(std::move(builder), states);
    case Hiding::nothing: break;
  }
  return minimize(random_mealy({.states = states, .inputs = inputs, .outputs = 4}, random));
}

}  // namespace maide
