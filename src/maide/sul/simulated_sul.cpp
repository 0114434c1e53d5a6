#include "maide/sul/simulated_sul.hpp"

#include <algorithm>
#include <cstdint>
#include <span>
#include <string>
#include <utility>

#include "maide/base/error.hpp"
#include "maide/sul/fatal_words.hpp"
#include "maide/sul/ia_translation.hpp"
#include "maide/sul/query_player.hpp"

namespace maide {
namespace {

// More outputs than this in one step are taken for outputs without end.
constexpr std::size_t most_outputs = 10'000;

// One instance of a plain Mealy machine.
class PlainInstance : public SteppedSystem {
 public:
  PlainInstance(const NondeterministicMealy& machine, Random& random)
      : machine_(machine), random_(random), state_(machine.initial()) {}
  bool is_busy(Symbol) override { return false; }
  Outcome take(Symbol input, SulStep& step) override {
    const auto choices = machine_.choices(state_, input);
    const auto& choice = choices[choices.size() == 1 ? 0 : random_.below(choices.size())];
    step.events.push_back({0, machine_.outputs().name(choice.output)});
    state_ = choice.target;
    return Outcome::quiescent;
  }

 private:
  const NondeterministicMealy& machine_;
  Random& random_;
  StateId state_;
};

// One instance of an interface automaton; always in a quiescent state between steps. `random` is
// null for a deterministic one.
class AutomatonInstance : public SteppedSystem {
 public:
  AutomatonInstance(const InterfaceAutomaton& automaton, const SulInfo& info, Random* random)
      : automaton_(automaton), info_(info), random_(random), state_(automaton.initial()) {}
  bool is_busy(Symbol) override { return false; }  // refusals are in the automaton
  Outcome take(Symbol input, SulStep& step) override {
    step.status = StepStatus::refused;
    if (automaton_.is_unexplored(state_, input)) step.status = StepStatus::unexplored;
    const Action action{Action::Kind::input, input};
    const auto is_wanted = [&](const Transition& other) { return other.action == action; };
    if (const Transition* transition = pick(is_wanted)) {
      step.status = transition->absorbed ? StepStatus::absorbed : StepStatus::taken;
      if (!transition->absorbed) state_ = transition->target;
    }
    while (const Transition* due = pick_due()) {
      const auto& output = info_.outputs[due->action.symbol];
      step.events.push_back({output.actor, output.name});
      state_ = due->target;
      if (step.events.size() > most_outputs) {
        throw UsageError("the interface automaton emits outputs without end (" + info_.name + ")");
      }
    }
    return Outcome::quiescent;
  }

 private:
  using Transition = InterfaceAutomaton::Transition;

  // Of the transitions of the state one that is wanted: the last, or any by chance.
  template <typename IsWanted>
  const Transition* pick(const IsWanted& is_wanted) {
    std::vector<const Transition*> wanted;
    for (const Transition& transition : automaton_.transitions(state_)) {
      if (is_wanted(transition)) wanted.push_back(&transition);
    }
    if (wanted.empty()) return nullptr;
    return random_ == nullptr ? wanted.back() : wanted[random_->below(wanted.size())];
  }
  // Outputs come in the canonical order; which of one actor's comes is chance.
  const Transition* pick_due() {
    const Transition* first = find_first_due(automaton_, state_);
    if (first == nullptr || random_ == nullptr) return first;
    const auto actor = info_.outputs[first->action.symbol].actor;
    return pick([&](const Transition& other) {
      return !other.action.is_input() && info_.outputs[other.action.symbol].actor == actor;
    });
  }

  const InterfaceAutomaton& automaton_;
  const SulInfo& info_;
  Random* random_;
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
    if (std::ranges::find(names, name) != names.end()) return i;
  }
  return 0;
}

}  // namespace

SimulatedSul::SimulatedSul(InterfaceAutomaton automaton, std::string name)
    : automaton_(std::move(automaton)), is_plain_(false) {
  check_ends(automaton_);
  is_deterministic_ = automaton_.is_deterministic();
  if (is_deterministic_) {
    to_mealy(automaton_, Translation::eager);  // throws if it cannot be played
  } else if (!automaton_.is_quiescent(automaton_.initial())) {
    throw UsageError("the interface automaton has an output due in its initial state");
  }
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
    const bool is_hidden = std::ranges::find(hidden, input) != hidden.end();
    if (!is_hidden && !info_.outputs.empty()) declared.returns = {info_.outputs.front().name};
  }
  if (const auto bound = automaton_.origin.find("bound"); bound != automaton_.origin.end()) {
    info_.bound = bound->second;
  }
}

SimulatedSul::SimulatedSul(const Mealy& machine, std::string name) : is_plain_(true) {
  if (!machine.is_complete()) throw UsageError("the Mealy machine is not complete (" + name + ")");
  machine_ = NondeterministicMealy(machine);
  info_.name = std::move(name);
  describe_plain(machine_.inputs(), machine_.outputs());
}

SimulatedSul::SimulatedSul(NondeterministicMealy machine, std::string name)
    : machine_(std::move(machine)), is_plain_(true) {
  machine_.complete_with("refused");
  is_deterministic_ = machine_.is_deterministic();
  info_.name = std::move(name);
  describe_plain(machine_.inputs(), machine_.outputs());
}

void SimulatedSul::describe_plain(const Alphabet& inputs, const Alphabet& outputs) {
  info_.has_actors = false;
  info_.speaks_av = false;
  info_.actors.emplace_back("system");
  for (const std::string& input : inputs.names()) info_.inputs.push_back({input, 0, {}});
  for (const std::string& output : outputs.names()) info_.outputs.push_back({output, 0});
}

SimulatedSul::~SimulatedSul() = default;

void SimulatedSul::add_purpose(const LearningPurpose& purpose) { purposes_.push_back(purpose); }

void SimulatedSul::run(std::span<const SulQuery> batch, const SulAnswerSink& sink,
                       const RunControl& control) {
  for (std::size_t i = 0; i < batch.size(); ++i) {
    if (control.should_stop()) control.check("the run");
    if (is_plain_) {
      PlainInstance instance(machine_, random_);
      sink(i, play(instance, batch[i], info_, purposes_));
    } else {
      AutomatonInstance instance(automaton_, info_, is_deterministic_ ? nullptr : &random_);
      sink(i, play(instance, batch[i], info_, purposes_));
    }
  }
}

void SimulatedSul::add_version(const std::string& what, const std::string& version) {
  info_.versions[what] = version;
}

Mealy SimulatedSul::reference(Translation translation) const {
  if (!is_deterministic_) throw UsageError("the model is nondeterministic (" + info_.name + ")");
  return is_plain_ ? *machine_.to_mealy() : to_mealy(automaton_, translation);
}

}  // namespace maide
