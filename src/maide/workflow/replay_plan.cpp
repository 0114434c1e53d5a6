#include "maide/workflow/replay_plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <string>
#include <utility>

#include "maide/base/error.hpp"
#include "maide/check/explore/check_system.hpp"
#include "maide/check/language/model_ends.hpp"
#include "maide/wire/wrapper/full_setup.hpp"

namespace maide {

using Kind = ModelUse::Kind;

Stage::Stage(const System& system, const RealSystems& real) : system_(system), real_(real) {
  for (std::uint32_t model = 0; model < real.size(); ++model) seats_.push_back({model});
  for (const TopicInstance& topic : system.topics) {
    for (std::size_t reader = 0; reader < topic.readers.size(); ++reader) {
      seats_[topic.readers[reader].model] = {topic.readers.front().model, &topic, reader};
    }
  }
}

std::vector<std::uint32_t> Stage::models_of(std::uint32_t host) const {
  if (seats_[host].topic == nullptr) return {host};
  std::vector<std::uint32_t> models;
  for (const auto& reader : seats_[host].topic->readers) models.push_back(reader.model);
  return models;
}

bool Stage::is_of_writers(const ModelUse& event) const {
  if (seats_[event.model].topic == nullptr) return false;
  const InterfaceAutomaton& automaton = system_.models[event.model].automaton;
  return is_of_writer(
      automaton,
      (event.kind == Kind::give ? automaton.inputs() : automaton.outputs()).name(event.symbol));
}

std::size_t Stage::writer_of(const TopicInstance& topic, std::uint32_t program) {
  const auto place = std::find(topic.writers.begin(), topic.writers.end(), program);
  return static_cast<std::size_t>(place - topic.writers.begin());
}

Symbol Stage::input_of(std::uint32_t program, const ModelUse& event) const {
  const Seat& seat = seats_[event.model];
  const RealSystem& real = *real_[seat.host];
  if (seat.topic == nullptr) return real.inputs[event.symbol];
  const std::size_t end = is_of_writers(event) ? writer_of(*seat.topic, program) : seat.reader;
  const std::string name =
      symbol_name(system_.models[event.model].automaton.inputs().name(event.symbol), end);
  const auto& inputs = real.sul->info().inputs;
  const auto place = std::find_if(inputs.begin(), inputs.end(),
                                  [&](const SulInput& input) { return input.name == name; });
  if (place == inputs.end()) {
    throw UsageError(fmt::format("the system {} of topic {} has no input '{}'", real.description,
                                 seat.topic->name, name));
  }
  return static_cast<Symbol>(place - inputs.begin());
}

std::vector<ModelUse> Stage::real_events(const Step& step) const {
  std::vector<ModelUse> events;
  std::set<const TopicInstance*> written;
  if (step.is_beyond) return events;
  for (const ModelUse& event : events_of(system_, step)) {
    if (real(event.model) == nullptr) continue;
    if (is_of_writers(event) && !written.insert(seat(event.model).topic).second) {
      continue;
    }
    events.push_back(event);
  }
  return events;
}

namespace {

std::vector<Move> unroll(const Trace& trace, std::size_t loops) {
  std::vector<Move> moves;
  for (std::size_t step = 0; step < trace.steps.size(); ++step) moves.push_back({step, 0});
  if (!trace.loop_start) return moves;
  for (std::size_t round = 1; round < loops; ++round) {
    for (std::size_t step = *trace.loop_start; step < trace.steps.size(); ++step) {
      moves.push_back({step, round});
    }
  }
  return moves;
}

// The calls that programs wait to make at the end, each as the model answers it: what is refused,
// and what a `select` would take if its output came. A call that was never tried, or that waits for
// an output to be taken, is an assumption and no observation.
class ProbeFinder {
 public:
  ProbeFinder(const System& system, const Stage& stage, const GlobalState& state)
      : system_(system), stage_(stage), state_(state), at_(state.models) {}

  std::vector<Probe> find() {
    for (const std::uint32_t program : deadlocked_programs(system_, state_)) {
      for (const ProgramEdge& edge : system_.programs[program].edges_of(state_.programs[program])) {
        for (const ModelUse& event : system_.programs[program].events_of(edge)) {
          if (event.kind == Kind::give && stage_.real(event.model) != nullptr) add(program, event);
        }
      }
    }
    return std::move(probes_);
  }

 private:
  void add(std::uint32_t program, const ModelUse& event) {
    const std::uint32_t host = stage_.seat(event.model).host;
    const InterfaceAutomaton& automaton = system_.models[event.model].automaton;
    const StateId at = at_[event.model];
    const bool is_open = std::find(left_.begin(), left_.end(), host) == left_.end();
    for (const std::uint32_t model : stage_.models_of(host)) {
      if (!is_open || !system_.models[model].automaton.is_quiescent(at_[model])) return;
    }
    if (is_beyond_learned(automaton, at, event.symbol)) return;
    if (!asked_.insert({host, stage_.input_of(program, event)}).second) return;
    Probe probe{program, event.model, event.symbol, {}};
    // A write that one reader's model takes may wait for another's: that says nothing of this one.
    if (stage_.is_of_writers(event) && takes(event)) return;
    for (const auto& transition : automaton.transitions(at)) {
      if (transition.action != Action{Action::Kind::input, event.symbol}) continue;
      probe.reachable.push_back(transition.target);
    }
    if (!probe.reachable.empty()) {
      at_[event.model] = probe.reachable.front();
      if (probe.reachable.size() > 1) left_.push_back(host);  // where it is then is not known
    }
    probes_.push_back(std::move(probe));
  }

  bool takes(const ModelUse& event) const {
    const InterfaceAutomaton& automaton = system_.models[event.model].automaton;
    return automaton.successor(at_[event.model], {Action::Kind::input, event.symbol}) !=
           Mealy::no_state;
  }

  const System& system_;
  const Stage& stage_;
  const GlobalState& state_;
  std::vector<StateId> at_;          // by model, behind the probes
  std::vector<std::uint32_t> left_;  // hosts that are not asked any more
  std::set<std::pair<std::uint32_t, Symbol>> asked_;
  std::vector<Probe> probes_;
};

}  // namespace

Plan make_plan(const System& system, const Stage& stage, const Trace& trace, std::size_t loops) {
  Plan plan;
  plan.states = replay(system, trace);
  plan.moves = unroll(trace, loops);
  plan.words.resize(system.models.size());
  const auto add = [&](std::uint32_t program, const ModelUse& event) {
    plan.words[stage.seat(event.model).host].push_back(stage.input_of(program, event));
  };
  for (const Move& move : plan.moves) {
    const Step& step = trace.steps[move.step];
    for (const ModelUse& event : stage.real_events(step)) {
      if (event.kind == Kind::give) add(step.program, event);
    }
  }
  if (!trace.loop_start) plan.probes = ProbeFinder(system, stage, plan.states.back()).find();
  for (const Probe& probe : plan.probes) {
    add(probe.program, {Kind::give, probe.model, probe.input});
  }
  return plan;
}

}  // namespace maide
