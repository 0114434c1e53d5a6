#include "maide/sul/simulated_sul.hpp"

#include <algorithm>
#include <utility>

#include "maide/base/error.hpp"
#include "maide/sul/fatal_words.hpp"
#include "maide/sul/ia_translation.hpp"
#include "maide/sul/query_player.hpp"

namespace maide {
namespace {

// One instance of a plain Mealy machine.
class PlainInstance : public SteppedSystem {
 public:
  explicit PlainInstance(const Mealy& machine) : machine_(machine), state_(machine.initial()) {}
  bool is_busy(Symbol) override { return false; }
  Outcome take(Symbol input, SulStep& step) override {
    step.events.push_back({0, machine_.outputs().name(machine_.output(state_, input))});
    state_ = machine_.target(state_, input);
    return Outcome::quiescent;
  }

 private:
  const Mealy& machine_;
  StateId state_;
};

// One instance of an interface automaton; always in a quiescent state between steps.
class AutomatonInstance : public SteppedSystem {
 public:
  AutomatonInstance(const InterfaceAutomaton& automaton, const SulInfo& info)
      : automaton_(automaton), info_(info), state_(automaton.initial()) {}
  bool is_busy(Symbol) override { return false; }  // refusals are in the automaton
  Outcome take(Symbol input, SulStep& step) override {
    step.status = StepStatus::refused;
    if (automaton_.is_unexplored(state_, input)) step.status = StepStatus::unexplored;
    const Action action{Action::Kind::input, input};
    for (const auto& transition : automaton_.transitions(state_)) {
      if (transition.action != action) continue;
      step.status = transition.absorbed ? StepStatus::absorbed : StepStatus::taken;
      if (!transition.absorbed) state_ = transition.target;
    }
    while (const auto* due = find_first_due(automaton_, state_)) {
      const auto& output = info_.outputs[due->action.symbol];
      step.events.push_back({output.actor, output.name});
      state_ = due->target;
    }
    return Outcome::quiescent;
  }

 private:
  const InterfaceAutomaton& automaton_;
  const SulInfo& info_;
  StateId state_;
};

// Behind a crash or a hang there is no system: a model that goes on there is a model of nothing.
void check_ends(const InterfaceAutomaton& automaton) {
  for (StateId state = 0; state < automaton.size(); ++state) {
    for (const auto& transition : automaton.transitions(state)) {
      if (transition.action.is_input()) continue;
      const std::string& output = automaton.outputs().name(transition.action.symbol);
      if (!is_end_output(output) || automaton.transitions(transition.target).empty()) continue;
      throw UsageError("the interface automaton goes on behind output '" + output +
                       "', which stands for the end of the system");
    }
  }
}

std::uint32_t actor_of(const InterfaceAutomaton& automaton, const std::string& name,
                       std::vector<std::string> Actor::*list) {
  for (std::uint32_t i = 0; i < automaton.actors.size(); ++i) {
    const auto& names = automaton.actors[i].*list;
    if (std::find(names.begin(), names.end(), name) != names.end()) return i;
  }
  return 0;
}

}  // namespace

SimulatedSul::SimulatedSul(InterfaceAutomaton automaton, std::string name)
    : automaton_(std::move(automaton)), is_plain_(false) {
  check_ends(automaton_);
  to_mealy(automaton_, Translation::eager);  // throws if it cannot be played
  info_.name = std::move(name);
  for (const Actor& actor : automaton_.actors) info_.actors.push_back(actor.name);
  if (info_.actors.empty()) info_.actors.emplace_back("system");
  for (const std::string& output : automaton_.outputs().names()) {
    info_.outputs.push_back({output, actor_of(automaton_, output, &Actor::outputs)});
  }
  for (const std::string& input : automaton_.inputs().names()) {
    SulInput& declared =
        info_.inputs.emplace_back(SulInput{input, actor_of(automaton_, input, &Actor::inputs), {}});
    // The file says which returns are hidden; for all others something observed ends the call.
    const auto& hidden = automaton_.hidden_returns;
    const bool is_hidden = std::find(hidden.begin(), hidden.end(), input) != hidden.end();
    if (!is_hidden && !info_.outputs.empty()) declared.returns = {info_.outputs.front().name};
  }
  if (const auto bound = automaton_.origin.find("bound"); bound != automaton_.origin.end()) {
    info_.bound = bound->second;
  }
}

SimulatedSul::SimulatedSul(Mealy machine, std::string name)
    : machine_(std::move(machine)), is_plain_(true) {
  if (!machine_.is_complete()) throw UsageError("the Mealy machine is not complete (" + name + ")");
  info_.name = std::move(name);
  info_.has_actors = false;
  info_.speaks_av = false;
  info_.actors.emplace_back("system");
  for (const std::string& input : machine_.inputs().names()) info_.inputs.push_back({input, 0, {}});
  for (const std::string& output : machine_.outputs().names()) info_.outputs.push_back({output, 0});
}

SimulatedSul::~SimulatedSul() = default;

void SimulatedSul::add_purpose(const LearningPurpose& purpose) { purposes_.push_back(purpose); }

void SimulatedSul::run(std::span<const SulQuery> batch, const SulAnswerSink& sink,
                       const RunControl& control) {
  for (std::size_t i = 0; i < batch.size(); ++i) {
    if (control.should_stop()) control.check("the run");
    if (is_plain_) {
      PlainInstance instance(machine_);
      sink(i, play(instance, batch[i], info_, purposes_));
    } else {
      AutomatonInstance instance(automaton_, info_);
      sink(i, play(instance, batch[i], info_, purposes_));
    }
  }
}

void SimulatedSul::add_version(const std::string& what, const std::string& version) {
  info_.versions[what] = version;
}

Mealy SimulatedSul::reference(Translation translation) const {
  return is_plain_ ? machine_ : to_mealy(automaton_, translation);
}

}  // namespace maide
