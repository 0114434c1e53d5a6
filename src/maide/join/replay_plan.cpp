#include "maide/join/replay_plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <string>
#include <utility>

#include "maide/base/error.hpp"
#include "maide/check/rules/model_ends.hpp"
#include "maide/check/rules/model_words.hpp"
#include "maide/check/system/components.hpp"
#include "maide/check/system/trace_file.hpp"
#include "maide/check/verdict/check_system.hpp"
#include "maide/sul/ia_translation.hpp"
#include "maide/wire/wrapper/full_setup.hpp"

namespace maide {

using Kind = ModelUse::Kind;

namespace {

Symbol input_named(const RealSystem& real, const std::string& name) {
  const auto& inputs = real.sul->info().inputs;
  const auto place = std::ranges::find(inputs, name, &SulInput::name);
  if (place == inputs.end()) {
    throw UsageError(fmt::format("the system {} has no input '{}'", real.description, name));
  }
  return static_cast<Symbol>(place - inputs.begin());
}

}  // namespace

Stage::Stage(const System& system, const RealSystems& real) : system_(system), real_(real) {
  for (std::uint32_t model = 0; model < real.size(); ++model) seats_.push_back({model});
  for (const TopicInstance& topic : system.topics) {
    for (std::size_t reader = 0; reader < topic.readers.size(); ++reader) {
      seats_[topic.readers[reader].model] = {topic.readers.front().model, &topic, reader};
    }
  }
  for (std::uint32_t host = 0; host < real.size(); ++host) {
    if (real[host] == nullptr || !real[host]->nodes) continue;
    host_of_nodes_ = host;
    for (const std::uint32_t model : real[host]->nodes->models()) {
      seats_[model] = {host, nullptr, 0, real[host]->nodes.get()};
    }
  }
}

std::vector<std::uint32_t> Stage::models_of(std::uint32_t host) const {
  if (seats_[host].nodes != nullptr) return seats_[host].nodes->models();
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
      (event.kind == Kind::give ? automaton.inputs() : automaton.outputs()).name(event.index));
}

std::size_t Stage::writer_of(const TopicInstance& topic, std::uint32_t program) {
  const auto place = std::ranges::find(topic.writers, program);
  return static_cast<std::size_t>(place - topic.writers.begin());
}

Symbol Stage::input_of(std::uint32_t program, const ModelUse& event) const {
  const Seat& seat = seats_[event.model];
  const RealSystem& real = *real_[seat.host];
  if (seat.topic == nullptr) return real.inputs[event.index];
  const std::size_t end = is_of_writers(event) ? writer_of(*seat.topic, program) : seat.reader;
  return input_named(
      real, symbol_name(system_.models[event.model].automaton.inputs().name(event.index), end));
}

std::vector<ModelUse> Stage::real_events(const Step& step) const {
  std::vector<ModelUse> events;
  std::set<const TopicInstance*> written;
  if (step.is_beyond) return events;
  for (const ModelUse& event : events_of(system_, step)) {
    if (real(event.model) == nullptr || seat(event.model).nodes != nullptr) continue;
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
          if (event.kind != Kind::give || stage_.real(event.model) == nullptr) continue;
          if (stage_.seat(event.model).nodes == nullptr) add(program, event);
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
    const bool is_open = std::ranges::find(left_, host) == left_.end();
    for (const std::uint32_t model : stage_.models_of(host)) {
      if (!is_open || !system_.models[model].automaton.is_quiescent(at_[model])) return;
    }
    if (is_beyond_learned(automaton, at, event.index)) return;
    if (!asked_.insert({host, stage_.input_of(program, event)}).second) return;
    Probe probe{program, event.model, event.index, {}};
    // A write that one reader's model takes may wait for another's: that says nothing of this one.
    if (stage_.is_of_writers(event) && takes(event)) return;
    for (const auto& transition : automaton.transitions(at)) {
      if (transition.action != Action{Action::Kind::input, event.index}) continue;
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
    return automaton.successor(at_[event.model], {Action::Kind::input, event.index}) !=
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

std::string describe_due(const InterfaceAutomaton& automaton, StateId state) {
  std::string text;
  for (std::size_t count = 0; count <= automaton.size(); ++count) {
    const auto* due = find_first_due(automaton, state);
    if (due == nullptr) break;
    text += (text.empty() ? "" : ",") + automaton.outputs().name(due->action.symbol);
    state = due->target;
  }
  return text.empty() ? "quiet" : text;
}

namespace {

void refuse_steps_of_nobody(const System& system, const Trace& trace) {
  const auto step = std::ranges::find(trace.steps, nobody, &Step::actor);
  if (step == trace.steps.end()) return;
  throw UsageError(fmt::format("step {}, {}, is nobody's: no real system can be asked for it",
                               step - trace.steps.begin() + 1, describe_action(system, *step)));
}

}  // namespace

Plan make_plan(const System& system, const Stage& stage, const Trace& trace, std::size_t loops) {
  Plan plan;
  refuse_steps_of_nobody(system, trace);
  plan.moves = unroll(trace, loops);
  plan.states.push_back(replay(system, trace).front());
  for (const Move& move : plan.moves) {
    // Where a queue fills in the loop, models are elsewhere in each round.
    plan.steps.push_back(step_like(system, plan.states.back(), trace.steps[move.step]).value());
    plan.states.push_back(apply(system, plan.states.back(), plan.steps.back()));
  }
  plan.words.resize(system.models.size());
  const auto add = [&](std::uint32_t program, const ModelUse& event) {
    plan.words[stage.seat(event.model).host].push_back(stage.input_of(program, event));
  };
  const auto add_call = [&](std::uint32_t host, const ReplayedNodes::Call& call) {
    plan.words[host].push_back(input_named(*stage.real(host), call.input));
  };
  for (const Step& step : plan.steps) {
    for (const ModelUse& event : stage.real_events(step)) {
      if (event.kind == Kind::give) add(step.actor, event);
    }
  }
  if (!trace.loop_start) plan.probes = ProbeFinder(system, stage, plan.states.back()).find();
  for (const Probe& probe : plan.probes) {
    add(probe.program, {Kind::give, probe.model, probe.input});
  }
  if (const auto host = stage.host_of_nodes()) {
    std::vector<std::size_t> steps;
    for (const Move& move : plan.moves) steps.push_back(move.step);
    plan.nodes = stage.seat(*host).nodes->plan(trace, plan.states.back(), steps);
    for (const auto& calls : plan.nodes.moves) {
      for (const auto& call : calls) add_call(*host, call);
    }
    for (const auto& call : plan.nodes.end) add_call(*host, call);
  }
  return plan;
}

// ---- what no real system is asked ----

namespace {

// The models that the run meets, in its steps or by what a program of its components waits for in
// the end.
std::set<std::uint32_t> find_met(const System& system, const Trace& trace,
                                 const GlobalState& last) {
  std::set<std::uint32_t> met;
  const auto add = [&](const Program& program, const ProgramEdge& edge) {
    for (const ModelUse& use : program.uses_of(edge)) met.insert(use.model);
  };
  for (const Step& step : trace.steps) {
    for (const ModelUse& use : uses_of(system, step)) met.insert(use.model);
  }
  for (const auto& component : find_components(system)) {
    const bool is_met = std::ranges::any_of(trace.steps, [&](const Step& step) {
      return std::ranges::find(component, step.actor) != component.end();
    });
    if (!is_met && !trace.steps.empty()) continue;
    for (const std::uint32_t index : component) {
      const Program& program = system.programs[index];
      for (const ProgramEdge& edge : program.edges_of(last.programs[index])) add(program, edge);
    }
  }
  return met;
}

bool is_real_in(const System& system, std::uint32_t model, const ReplayedNodes* nodes) {
  return is_real(system.models[model]) || (nodes != nullptr && nodes->contains(model));
}

// A mutex or a semaphore: it belongs to the programs, as a shared variable does.
bool is_lock(const ModelInstance& model) {
  return model.source == ModelInstance::Source::built_in && !model.automaton.inputs().find("read");
}

}  // namespace

bool meet_nodes(const System& system, std::span<const Trace> traces) {
  const std::vector<std::uint32_t> models = ReplayedNodes::find_models(system);
  return std::ranges::any_of(traces, [&](const Trace& trace) {
    const auto met = find_met(system, trace, replay(system, trace).back());
    return std::ranges::any_of(models, [&](std::uint32_t model) { return met.contains(model); });
  });
}

Unplayed find_unplayed(const System& system, std::span<const Trace> traces,
                       const ReplayedNodes* nodes) {
  using Source = ModelInstance::Source;
  std::set<std::uint32_t> met;
  for (const Trace& trace : traces)
    met.merge(find_met(system, trace, replay(system, trace).back()));
  const auto is = [&](std::uint32_t model, Source source) {
    return system.models[model].source == source;
  };
  Unplayed unplayed;
  unplayed.is_all = std::ranges::none_of(
      met, [&](std::uint32_t model) { return is_real_in(system, model, nodes); });
  if (!unplayed.is_all) {
    std::erase_if(met, [&](std::uint32_t model) {
      return is(model, Source::variable) || is_lock(system.models[model]) ||
             (nodes != nullptr && is(model, Source::executor)) || is_real_in(system, model, nodes);
    });
  }
  unplayed.models = describe_unreal(system, {met.begin(), met.end()});
  for (std::string& line : unplayed.models) line += ", and no real system is asked for that";
  return unplayed;
}

std::vector<std::string> find_assumptions(const System& system, const Trace& trace) {
  std::set<std::string> found;
  const std::vector<GlobalState> states = replay(system, trace);
  for (const Step& step : trace.steps) {
    if (!step.is_beyond) continue;
    const StepText text = describe_step(system, step);
    const auto at = static_cast<std::size_t>(&step - trace.steps.data());
    for (const ModelUse& use : uses_beyond(system, states[at], step)) {
      const ModelInstance& model = system.models[use.model];
      const bool is_cut = model.when_unexplored == WhenUnexplored::stop;
      found.insert(fmt::format("{}'s {}{} at line {} was never tried there ({}), {}", text.actor,
                               text.model, text.event, text.line, describe_bound(model),
                               is_cut ? "and is not played" : "and is taken to change nothing"));
    }
  }
  if (trace.loop_start) return {found.begin(), found.end()};
  for (const std::uint32_t index : deadlocked_programs(system, states.back())) {
    const Program& program = system.programs[index];
    for (const ProgramEdge& edge : program.edges_of(states.back().programs[index])) {
      for (const ModelUse& event : program.events_of(edge)) {
        const ModelInstance& model = system.models[event.model];
        if (event.kind != Kind::give || !is_real(model)) continue;
        const StateId at = states.back().models[event.model];
        const std::string call = describe_edge(system, program, edge);
        if (!model.automaton.is_quiescent(at)) {
          found.insert(
              fmt::format("{} waits with {} for somebody to take {}: so programs and models "
                          "meet, whatever the real call would do",
                          program.name, call, describe_due(model.automaton, at)));
        } else if (is_beyond_learned(model.automaton, at, event.index)) {
          found.insert(fmt::format("{}'s {} at line {} was never tried there ({}), and waits",
                                   program.name, call, edge.line, describe_bound(model)));
        }
      }
    }
  }
  return {found.begin(), found.end()};
}

bool ends_in_deadlock(const System& system, const Trace& trace) {
  return !trace.loop_start && !deadlocked_programs(system, replay(system, trace).back()).empty();
}

}  // namespace maide
