// The model of a whole topic, put together from a model of each reader: one automaton that does
// what the engine does with a topic (docs/systems.md). Comparing it with a model that was learned
// with all ends at once shows whether a middleware's topic is made of its readers.
//
//   write, write2   go to the models of all readers, or to one that takes it
//   read2           goes to the second reader's
//   written2        is due when all models have it due, and goes to whoever wrote
//
// As a learned model, the result takes no input while an output is due.
#pragma once

#include <algorithm>
#include <cstddef>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "maide/automata/interface_automaton.hpp"
#include "maide/base/error.hpp"
#include "maide/base/run_control.hpp"
#include "maide/check/rules/model_ends.hpp"
#include "maide/check/system/system.hpp"
#include "maide/wire/wrapper/full_setup.hpp"

namespace maide::test {

struct TopicShape {
  std::size_t writers = 1;
  bool delivers_one = false;  // a write goes to one of the models that take it
};

// A state of each reader's model, and who wrote last, until what it gets back was taken.
struct TopicState {
  std::vector<StateId> models;
  std::size_t owner = 0;
  auto operator<=>(const TopicState&) const = default;
};

class Composition {
 public:
  Composition(std::span<const InterfaceAutomaton> readers, const TopicShape& shape)
      : shape_(shape) {
    for (const InterfaceAutomaton& reader : readers) {
      models_.push_back(with_ends(reader, {.collects = true, .ends = {}}));
      for (const std::string& name : reader.outputs().names()) {
        tells_writer_ = tells_writer_ || is_of_writer(reader, name);
      }
    }
    std::vector<std::string> inputs;
    for (std::size_t reader = 0; reader < models_.size(); ++reader) {
      const InterfaceAutomaton& model = models_[reader].automaton;
      for (const std::string& name : model.inputs().names()) {
        const bool writes = is_of_writer(model, name);
        if (writes && reader > 0) continue;
        for (std::size_t end = 0; end < (writes ? shape.writers : 1); ++end) {
          inputs.push_back(symbol_name(name, writes ? end : reader));
        }
      }
    }
    result_ = InterfaceAutomaton(Alphabet(std::span<const std::string>(inputs)), Alphabet(), 0);
    name_actors();
  }

  InterfaceAutomaton run(const RunControl& control) {
    TopicState initial;
    for (const EndedModel& model : models_) {
      initial.models.push_back(model.automaton.initial());
    }
    state_of(initial);
    for (StateId state = 0; state < met_.size(); ++state) {
      control.check("putting the readers' models together");
      expand(state, TopicState(met_[state]));
    }
    return std::move(result_);
  }

 private:
  void name_actors() {
    for (const char* role : {"writer", "reader"}) {
      const bool writes = std::string_view(role) == "writer";
      for (std::size_t end = 0; end < (writes ? shape_.writers : models_.size()); ++end) {
        Actor actor{symbol_name(role, end), {}, {}};
        const InterfaceAutomaton& model = models_[writes ? 0 : end].automaton;
        for (const std::string& name : model.inputs().names()) {
          if (is_of_writer(model, name) == writes) actor.inputs.push_back(symbol_name(name, end));
        }
        for (const std::string& name : model.outputs().names()) {
          if (is_of_writer(model, name) == writes) actor.outputs.push_back(symbol_name(name, end));
        }
        result_.actors.push_back(std::move(actor));
      }
    }
  }

  StateId state_of(TopicState state) {
    const auto [place, is_new] = states_.try_emplace(state, static_cast<StateId>(met_.size()));
    if (is_new) {
      result_.add_state();
      met_.push_back(std::move(state));
    }
    return place->second;
  }

  void add(StateId from, Action action, TopicState target) {
    result_.add_transition(from, action, state_of(std::move(target)));
  }

  std::optional<Symbol> collected(const TopicState& state, std::size_t reader) const {
    return models_[reader].collected[state.models[reader]];
  }

  void expand(StateId number, const TopicState& state) {
    const bool has_output = add_outputs(number, state);
    if (!has_output) add_inputs(number, state);
  }

  bool add_outputs(StateId number, const TopicState& state) {
    bool is_due = false;
    for (std::size_t reader = 0; reader < models_.size(); ++reader) {
      const InterfaceAutomaton& model = models_[reader].automaton;
      for (const auto& transition : model.transitions(state.models[reader])) {
        if (transition.action.is_input()) continue;
        TopicState next = state;
        next.models[reader] = transition.target;
        add_output(number, symbol_name(model.outputs().name(transition.action.symbol), reader),
                   next);
        is_due = true;
      }
    }
    return add_written(number, state) || is_due;
  }

  void add_output(StateId number, const std::string& name, TopicState next) {
    const Symbol symbol = result_.intern_output(name);
    add(number, {Action::Kind::output, symbol}, std::move(next));
  }

  // What the writer gets back: `failed` if a model says so.
  bool add_written(StateId number, const TopicState& state) {
    std::vector<std::string> names;
    for (std::size_t reader = 0; reader < models_.size(); ++reader) {
      const auto symbol = collected(state, reader);
      if (symbol) names.push_back(models_[reader].automaton.outputs().name(*symbol));
    }
    if (names.size() < (shape_.delivers_one ? 1 : models_.size())) return false;
    const auto failed = std::find_if(names.begin(), names.end(), [](const std::string& name) {
      return name.starts_with("failed");
    });
    TopicState next = state;
    for (std::size_t reader = 0; reader < models_.size(); ++reader) {
      next.models[reader] = models_[reader].cleared[state.models[reader]];
    }
    next.owner = 0;
    const std::string& name = failed == names.end() ? names.front() : *failed;
    add_output(number, symbol_name(name, state.owner), std::move(next));
    return true;
  }

  void add_inputs(StateId number, const TopicState& state) {
    for (std::size_t reader = 0; reader < models_.size(); ++reader) {
      const InterfaceAutomaton& model = models_[reader].automaton;
      for (Symbol input = 0; input < model.inputs().size(); ++input) {
        const std::string& name = model.inputs().name(input);
        if (is_of_writer(model, name)) {
          if (reader == 0) add_write(number, state, name);
          continue;
        }
        const Symbol symbol = *result_.inputs().find(symbol_name(name, reader));
        if (is_untried(reader, state, input)) result_.mark_unexplored(number, symbol);
        for (const StateId target : targets(reader, state, input)) {
          TopicState next = state;
          next.models[reader] = target;
          add(number, {Action::Kind::input, symbol}, std::move(next));
        }
      }
    }
  }

  bool is_untried(std::size_t reader, const TopicState& state, Symbol input) const {
    return is_beyond_learned(models_[reader].automaton, state.models[reader], input);
  }

  std::vector<StateId> targets(std::size_t reader, const TopicState& state, Symbol input) const {
    std::vector<StateId> result;
    for (const auto& transition : models_[reader].automaton.transitions(state.models[reader])) {
      if (transition.absorbed || transition.action != Action{Action::Kind::input, input}) continue;
      result.push_back(transition.target);
    }
    return result;
  }

  void add_write(StateId number, const TopicState& state, const std::string& name) {
    for (std::size_t reader = 0; reader < models_.size(); ++reader) {
      if (collected(state, reader)) return;  // something of the last write is still due
    }
    std::vector<TopicState> reached;
    bool is_untried_somewhere = false;
    if (shape_.delivers_one) {
      for (std::size_t reader = 0; reader < models_.size(); ++reader) {
        const auto input = models_[reader].automaton.inputs().find(name);
        if (!input) continue;
        is_untried_somewhere = is_untried_somewhere || is_untried(reader, state, *input);
        for (const StateId target : targets(reader, state, *input)) {
          reached.push_back(state);
          reached.back().models[reader] = target;
        }
      }
    } else {
      reached = {state};
      for (std::size_t reader = 0; reader < models_.size(); ++reader) {
        const auto input = models_[reader].automaton.inputs().find(name);
        if (!input) return;
        const std::vector<StateId> next = targets(reader, state, *input);
        if (next.empty() && !is_untried(reader, state, *input)) return;  // it is refused
        is_untried_somewhere = is_untried_somewhere || is_untried(reader, state, *input);
        std::vector<TopicState> longer;
        for (const TopicState& before : reached) {
          for (const StateId target : next) {
            longer.push_back(before);
            longer.back().models[reader] = target;
          }
        }
        reached = std::move(longer);
      }
    }
    for (std::size_t writer = 0; writer < shape_.writers; ++writer) {
      const Symbol symbol = *result_.inputs().find(symbol_name(name, writer));
      if (is_untried_somewhere && reached.empty()) result_.mark_unexplored(number, symbol);
      for (TopicState next : reached) {
        next.owner = tells_writer_ ? writer : 0;
        add(number, {Action::Kind::input, symbol}, std::move(next));
      }
    }
  }

  const TopicShape shape_;
  std::vector<EndedModel> models_;  // by reader
  bool tells_writer_ = false;       // the writer gets something back
  InterfaceAutomaton result_;
  std::map<TopicState, StateId> states_;
  std::vector<TopicState> met_;
};

// Each reader's model is one of one writer and one reader, and names its actors, of which one is
// the "writer". Symbols of the second writer and of the second reader's model have a 2 behind their
// names. Throws UsageError, and Interrupted. O(product of the models' sizes x writers).
inline InterfaceAutomaton compose_topic(std::span<const InterfaceAutomaton> readers,
                                        const TopicShape& shape, const RunControl& control = {}) {
  if (readers.empty() || shape.writers == 0) throw UsageError("a topic has a writer and a reader");
  return Composition(readers, shape).run(control);
}

}  // namespace maide::test
