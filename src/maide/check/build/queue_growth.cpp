#include "maide/check/build/queue_growth.hpp"

#include <algorithm>
#include <deque>
#include <set>
#include <string>
#include <unordered_set>
#include <utility>
#include <vector>

#include "maide/base/hash.hpp"
#include "maide/check/system/components.hpp"

namespace maide {
namespace {

std::uint64_t hash_of(const GlobalState& state) {
  std::uint64_t sum = 0;
  for (const StateId model : state.models) sum = hash_mix(sum, model);
  for (const ControlState program : state.programs) sum = hash_mix(sum, program);
  return sum;
}

class Growth {
 public:
  Growth(System& system, ModelActions& actions, GrowingModels& models, const QueueLimits& limits,
         const RunControl& control)
      : system_(system), actions_(actions), models_(models), limits_(limits), control_(control) {}

  void run() {
    // Other components are asked for what nobody does in them, and stay where they begin.
    for (const auto& [model, growing] : models_) {
      reach(model, system_.models[model].automaton.initial());
    }
    for (const auto& [model, growing] : models_) {
      if (system_.models[model].source != ModelInstance::Source::wire) continue;
      // The order of a stream has no bound without its wires, and no input.
      if (system_.models[model].automaton.inputs().size() == 0) continue;
      if (follow_writer(model)) whole_.insert(model);
    }
    for (const auto& component : find_components(system_)) {
      std::set<std::uint32_t> small;  // perhaps
      for (const std::uint32_t program : component) {
        for (const std::uint32_t model : models_of(system_.programs[program])) {
          const auto growing = models_.find(model);
          if (growing == models_.end() || whole_.contains(model)) continue;
          if (!growing->second->is_large()) small.insert(model);
        }
      }
      const bool is_done = !small.empty() && search(component, limits_.searched_first);
      for (const std::uint32_t model : small) {
        if (is_done || make_whole(model)) whole_.insert(model);
      }
      if (!is_done) search(component, limits_.searched);
    }
    for (const auto& [model, growing] : models_) {
      ModelInstance& instance = system_.models[model];
      std::vector<bool>& reached = reached_[model];
      reached.resize(instance.automaton.size());
      if (!reached[instance.automaton.initial()]) reach(model, instance.automaton.initial());
      reached.resize(instance.automaton.size());
      std::vector<StateId> numbers;
      instance.automaton = growing->cut_down(instance.automaton, reached, numbers);
      actions_.renumber(model, numbers, reached);
      describe(instance, *growing);
      if (whole_.contains(model)) {
        instance.is_grown = false;
        continue;
      }
      instance.automaton.origin["bound"] =
          std::to_string(std::count(reached.begin(), reached.end(), true)) +
          " states that were met first";
    }
  }

 private:
  // Not of so many that nobody looks at them.
  void describe(ModelInstance& instance, const GrowingModel& growing) const {
    instance.state_texts.clear();
    instance.held.clear();
    instance.service_contents.clear();
    if (growing.is_large() || instance.automaton.size() > limits_.small_states) return;
    for (StateId state = 0; state < instance.automaton.size(); ++state) {
      instance.state_texts.push_back(growing.describe(state));
      if (const auto held = growing.held(state)) instance.held.push_back(*held);
      const auto contents = growing.service_contents(state);
      if (contents) instance.service_contents.push_back(*contents);
    }
  }

  // All states that a wire can come to by what its one writer does in the order of its text, the
  // models being left out, and by what others do with it at any time. False if they are too many,
  // or there are several writers: threads of one node.
  bool follow_writer(std::uint32_t wire) {
    // By program: the uses of the wire by its edges.
    std::map<std::uint32_t, std::map<std::uint32_t, std::uint32_t>> users;  // action by edge
    for (std::uint32_t number = 0; number < system_.programs.size(); ++number) {
      const Program& program = system_.programs[number];
      for (std::uint32_t edge = 0; edge < program.edges.size(); ++edge) {
        for (const ModelUse& use : program.uses_of(program.edges[edge])) {
          if (use.model == wire) users[number].emplace(edge, use.index);
        }
      }
    }
    if (users.size() != 1) return false;
    std::set<std::uint32_t> of_nobody;  // actions
    for (const NobodysAction& action : system_.nobodys_actions) {
      for (const ModelUse& use : action.what.uses) {
        if (use.model == wire) of_nobody.insert(use.index);
      }
    }
    const auto& [number, by_edge] = *users.begin();
    const Program& program = system_.programs[number];
    using Pair = std::pair<ControlState, StateId>;
    std::set<Pair> seen{{0, system_.models[wire].automaton.initial()}};
    std::vector<Pair> open(seen.begin(), seen.end());
    const auto meet = [&](ControlState control, StateId state) {
      if (seen.emplace(control, state).second) open.emplace_back(control, state);
    };
    while (!open.empty()) {
      const auto [control, state] = open.back();
      open.pop_back();
      if (seen.size() > limits_.met_states || !may_go_on() || !reach(wire, state) ||
          system_.models[wire].automaton.size() > limits_.small_states) {
        reached_.erase(wire);
        return false;
      }
      const auto steps_of = [this, wire,
                             held = state](std::uint32_t action) -> const std::vector<ModelStep>& {
        return system_.models[wire].actions[action].steps[held];
      };
      const Program::State& at = program.states[control];
      for (std::uint32_t edge = at.first_edge; edge < at.first_edge + at.edge_count; ++edge) {
        const auto use = by_edge.find(edge);
        if (use == by_edge.end()) {
          meet(program.edges[edge].target, state);
          continue;
        }
        for (const ModelStep& step : steps_of(use->second)) {
          meet(program.edges[edge].target, step.target);
        }
      }
      for (const std::uint32_t action : of_nobody) {
        for (const ModelStep& step : steps_of(action)) meet(control, step.target);
      }
    }
    return true;
  }

  // All states that the model can come to by inputs and by what programs do with it. False if they
  // are too many.
  bool make_whole(std::uint32_t model) {
    InterfaceAutomaton& automaton = system_.models[model].automaton;
    for (StateId state = 0; state < automaton.size(); ++state) {
      if (automaton.size() > limits_.small_states || !may_go_on()) {
        reached_.erase(model);
        return false;
      }
      reach(model, state);
    }
    return true;
  }

  // Visits the states of the component, breadth-first. False if they are more than `most`, or its
  // models have too many.
  bool search(const std::vector<std::uint32_t>& programs, std::uint64_t most) {
    std::set<std::uint32_t> growing;
    for (const std::uint32_t program : programs) {
      for (const std::uint32_t model : models_of(system_.programs[program])) {
        if (models_.contains(model) && !whole_.contains(model)) growing.insert(model);
      }
    }
    if (growing.empty()) return true;
    std::deque<GlobalState> open{initial_state(system_)};
    std::unordered_set<std::uint64_t> seen{hash_of(open.front())};
    while (!open.empty() && seen.size() < most && may_go_on()) {
      const GlobalState state = std::move(open.front());
      open.pop_front();
      for (const std::uint32_t model : growing) {
        if (!reach(model, state.models[model])) return false;
      }
      const bool is_error = std::any_of(programs.begin(), programs.end(), [&](auto program) {
        return system_.programs[program].is_error(state.programs[program]);
      });
      if (is_error) continue;
      const auto take_steps_of = [&](std::uint32_t actor) {
        for (const Step& step : enabled_steps(system_, state, actor)) {
          if (step.is_cut) continue;
          GlobalState next = apply(system_, state, step);
          if (seen.insert(hash_of(next)).second) open.push_back(std::move(next));
        }
      };
      // What is nobody's in other components is not possible: their programs do not move.
      for (const std::uint32_t program : programs) take_steps_of(program);
      take_steps_of(nobody);
    }
    return open.empty();
  }

  // False when time is up. A clock is read for many states at once.
  bool may_go_on() {
    if (looked_at_++ % look_interval != 0 || !control_.should_stop()) return true;
    if (control_.stop.stop_requested()) control_.check("the search for states of queues");
    return false;
  }

  // A run comes to that state of the queue. False if it has too many.
  bool reach(std::uint32_t model, StateId state) {
    InterfaceAutomaton& automaton = system_.models[model].automaton;
    std::vector<bool>& reached = reached_[model];
    if (reached.size() < automaton.size()) reached.resize(automaton.size());
    if (reached[state]) return true;
    if (automaton.size() > limits_.met_states) return false;
    const std::size_t steps = automaton.size() * (system_.models[model].actions.size() + 1);
    if (!models_.at(model)->is_large() && steps > limits_.met_steps) return false;
    models_.at(model)->expand_with_messages(automaton, state);
    actions_.make_steps(model, state);
    reached[state] = true;
    return true;
  }

  static constexpr std::uint64_t look_interval = 256;  // states

  System& system_;
  ModelActions& actions_;
  GrowingModels& models_;
  const QueueLimits& limits_;
  const RunControl& control_;
  std::uint64_t looked_at_ = 0;  // states, of all components
  std::set<std::uint32_t> whole_;
  std::map<std::uint32_t, std::vector<bool>> reached_;  // by model, by state
};

}  // namespace

void grow_models(System& system, ModelActions& actions, GrowingModels& models,
                 const QueueLimits& limits, const RunControl& control) {
  Growth(system, actions, models, limits, control).run();
}

}  // namespace maide
