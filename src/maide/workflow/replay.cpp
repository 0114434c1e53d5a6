#include "maide/workflow/replay.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <deque>
#include <set>
#include <utility>

#include "maide/base/error.hpp"
#include "maide/base/text.hpp"
#include "maide/check/explore/check_system.hpp"
#include "maide/check/explore/model_words.hpp"
#include "maide/check/trace/trace_file.hpp"
#include "maide/sul/ia_translation.hpp"

namespace maide {
namespace {

using Kind = ProgramEdge::Kind;
using Actions = std::vector<std::deque<std::string>>;  // outputs due, by actor

constexpr std::size_t runs_at_once = 16;  // between two looks at whether to stop

const ProgramEdge& edge_of(const System& system, const Step& step) {
  return system.programs[step.program].edges[step.edge];
}

std::span<const ModelUse> events_of(const System& system, const Step& step) {
  return system.programs[step.program].events_of(edge_of(system, step));
}

// A step of the trace as it is played.
struct Move {
  std::size_t step = 0, round = 0;
};

// A call that the model does not take while the programs are in a deadlock.
struct Probe {
  std::uint32_t model = 0;
  Symbol input = 0;
};

// What is played of one trace.
struct Plan {
  std::vector<GlobalState> states;  // along the trace
  std::vector<Move> moves;
  std::vector<Probe> probes;
  std::vector<Word> words;  // by instance, in its model's inputs; the probes last
};

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

// The calls that programs wait to make at the end and that the system is held to refuse. One that
// was never tried, or that waits for an output to be taken, is an assumption and no observation.
std::vector<Probe> find_probes(const System& system, const GlobalState& state,
                               const std::vector<std::unique_ptr<RealSystem>>& real) {
  std::vector<Probe> probes;
  for (const std::uint32_t index : deadlocked_programs(system, state)) {
    for (const ProgramEdge& edge : system.programs[index].edges_of(state.programs[index])) {
      if (edge.kind != Kind::give || !real[edge.model]) continue;
      const InterfaceAutomaton& automaton = system.models[edge.model].automaton;
      const StateId at = state.models[edge.model];
      if (!automaton.is_quiescent(at) || is_beyond_learned(automaton, at, edge.symbol)) continue;
      const bool is_known = std::any_of(probes.begin(), probes.end(), [&](const Probe& probe) {
        return probe.model == edge.model && probe.input == edge.symbol;
      });
      if (!is_known) probes.push_back({edge.model, edge.symbol});
    }
  }
  return probes;
}

Plan make_plan(const System& system, const Trace& trace, std::size_t loops,
               const std::vector<std::unique_ptr<RealSystem>>& real) {
  Plan plan;
  plan.states = replay(system, trace);
  plan.moves = unroll(trace, loops);
  plan.words.resize(system.models.size());
  for (const Move& move : plan.moves) {
    const Step& step = trace.steps[move.step];
    if (step.is_beyond) continue;
    for (const ModelUse& event : events_of(system, step)) {
      if (event.kind == Kind::give) plan.words[event.model].push_back(event.symbol);
    }
  }
  if (!trace.loop_start) plan.probes = find_probes(system, plan.states.back(), real);
  for (const Probe& probe : plan.probes) plan.words[probe.model].push_back(probe.input);
  return plan;
}

// Whether the automaton can emit all that is due, each actor's outputs in their order, and then has
// no output left.
bool emits(const InterfaceAutomaton& automaton, StateId state, const Actions& due) {
  const bool is_empty =
      std::all_of(due.begin(), due.end(), [](const auto& queue) { return queue.empty(); });
  if (is_empty) return automaton.is_quiescent(state);
  for (std::size_t actor = 0; actor < due.size(); ++actor) {
    if (due[actor].empty()) continue;
    const auto symbol = automaton.outputs().find(due[actor].front());
    if (!symbol) return false;
    for (const auto& transition : automaton.transitions(state)) {
      if (transition.action != Action{Action::Kind::output, *symbol}) continue;
      Actions rest = due;
      rest[actor].pop_front();
      if (emits(automaton, transition.target, rest)) return true;
    }
  }
  return false;
}

// The outputs that are due in a state, in the canonical order: "message,written", or "quiet".
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

// One real instance as it is seen along the trace.
struct InstanceView {
  const SulAnswer* answer = nullptr;
  std::size_t next = 0;  // step of the answer
  Actions due;           // outputs that it gave and no program took yet
};

// Walks along a plan with the answers of the real systems.
class Walk {
 public:
  Walk(const System& system, const Trace& trace, const Plan& plan,
       const std::vector<std::unique_ptr<RealSystem>>& real, const std::vector<SulAnswer>& answers)
      : system_(system), trace_(trace), plan_(plan), real_(real), calls_(system.programs.size()) {
    for (std::size_t model = 0; model < real.size(); ++model) {
      InstanceView& view = views_.emplace_back();
      if (!real[model]) continue;
      view.answer = &answers[model];
      view.due.resize(std::max<std::size_t>(real[model]->sul->info().actors.size(), 1));
    }
  }

  ReplayedRun run() {
    for (const Move& move : plan_.moves) {
      move_ = move;
      take(trace_.steps[move.step]);
      if (run_.deviation) return std::move(run_);
      ++run_.steps;
    }
    move_ = {trace_.steps.size(), 0};
    for (const Probe& probe : plan_.probes) {
      test_end(probe);
      if (run_.deviation) break;
    }
    return std::move(run_);
  }

 private:
  void see(std::string what) {
    if (move_.round == 0) run_.seen.push_back(std::move(what));
  }

  void deviate(Deviation::Kind kind, std::uint32_t model, std::string expected, std::string seen) {
    if (move_.round == 0 && move_.step < trace_.steps.size()) run_.seen.push_back(seen);
    Deviation deviation{kind, move_.step, move_.round, model, std::move(expected), std::move(seen),
                        {}};
    const Word& word = plan_.words[model];
    const std::size_t length = std::min(views_[model].next, word.size());
    for (std::size_t i = 0; i < length; ++i) {
      deviation.word.push_back(system_.models[model].automaton.inputs().name(word[i]));
    }
    run_.deviation = std::move(deviation);
  }

  void take(const Step& step) {
    if (is_held_up(step.program)) return;
    // Of a `quiet` nothing is to be seen: what is not due in the model is not due here, for give()
    // has looked.
    std::string seen;
    for (const ModelUse& event : events_of(system_, step)) {
      if (step.is_beyond || !real_[event.model]) continue;
      const auto text = event.kind == Kind::give ? give(step, event) : take_output(event);
      if (!text) return;
      seen += (seen.empty() || text->empty() ? "" : "; ") + *text;
    }
    see(seen);
  }

  // The program is still in a call whose return the model hides.
  bool is_held_up(std::uint32_t program) {
    const auto& call = calls_[program];
    if (!call) return false;
    const InstanceView& view = views_[call->model];
    const auto& busy = view.answer->steps[view.next - 1].busy;
    const std::uint32_t actor = actor_of(call->model, call->input);
    if (std::find(busy.begin(), busy.end(), actor) == busy.end()) {
      calls_[program].reset();
      return false;
    }
    const std::string name = system_.models[call->model].name + "." +
                             system_.models[call->model].automaton.inputs().name(call->input);
    deviate(Deviation::Kind::pending_call, call->model, name + " has returned",
            name + " still blocks");
    return true;
  }

  std::uint32_t actor_of(std::uint32_t model, Symbol input) const {
    return real_[model]->sul->info().inputs[real_[model]->inputs[input]].actor;
  }

  // Where the model is when it has taken the input: before the outputs that the step takes with it.
  StateId after_input(const Step& step, const ModelUse& event) const {
    const auto uses = system_.programs[step.program].uses_of(edge_of(system_, step));
    const auto use = std::find_if(uses.begin(), uses.end(), [&](const ModelUse& candidate) {
      return candidate.model == event.model;
    });
    const StateId target = step.targets[static_cast<std::size_t>(use - uses.begin())];
    if (use->kind == Kind::give) return target;
    const InterfaceAutomaton& automaton = system_.models[event.model].automaton;
    for (const auto& given : automaton.transitions(plan_.states[move_.step].models[event.model])) {
      if (given.action != Action{Action::Kind::input, event.symbol} || given.absorbed) continue;
      if (given.target == target) return target;
      for (const ModelUse& taken : events_of(system_, step)) {
        if (taken.kind != Kind::take || taken.model != event.model) continue;
        for (const auto& output : automaton.transitions(given.target)) {
          if (output.action == Action{Action::Kind::output, taken.symbol} &&
              output.target == target) {
            return given.target;
          }
        }
      }
    }
    return target;
  }

  // What was seen; none if it deviates.
  std::optional<std::string> give(const Step& step, const ModelUse& edge) {
    InstanceView& view = views_[edge.model];
    const InterfaceAutomaton& automaton = system_.models[edge.model].automaton;
    const StateId expected = after_input(step, edge);
    const SulStep* seen = next_answer(view);
    const std::string text =
        seen == nullptr ? "nothing: the system has ended" : mealy_output(*seen, Translation::eager);
    const bool is_taken = seen != nullptr && seen->status == StepStatus::taken;
    if (is_taken) {
      for (const Event& event : seen->events) view.due[event.actor].push_back(event.output);
    }
    if (is_taken && emits(automaton, expected, view.due)) {
      remember_call(step.program, edge);
      return text;
    }
    const StateId before = plan_.states[move_.step].models[edge.model];
    const auto transitions = automaton.transitions(before);
    const bool is_another =
        is_taken &&
        std::any_of(transitions.begin(), transitions.end(), [&](const auto& transition) {
          return transition.action == Action{Action::Kind::input, edge.symbol} &&
                 !transition.absorbed && emits(automaton, transition.target, view.due);
        });
    deviate(is_another ? Deviation::Kind::other_answer : Deviation::Kind::output, edge.model,
            describe_due(automaton, expected), text);
    return std::nullopt;
  }

  const SulStep* next_answer(InstanceView& view) {
    const std::size_t at = view.next++;
    return at < view.answer->steps.size() ? &view.answer->steps[at] : nullptr;
  }

  void remember_call(std::uint32_t program, const ModelUse& edge) {
    const InterfaceAutomaton& automaton = system_.models[edge.model].automaton;
    const auto& hidden = automaton.hidden_returns;
    const std::string& name = automaton.inputs().name(edge.symbol);
    if (std::find(hidden.begin(), hidden.end(), name) == hidden.end()) return;
    calls_[program] = Probe{edge.model, edge.symbol};
  }

  // The system has it due, unless it has the choice of its outputs and chose another.
  std::optional<std::string> take_output(const ModelUse& edge) {
    InstanceView& view = views_[edge.model];
    const std::string& output = system_.models[edge.model].automaton.outputs().name(edge.symbol);
    std::string due;
    for (auto& queue : view.due) {
      if (queue.empty()) continue;
      if (queue.front() == output) {
        queue.pop_front();
        return "";
      }
      due += (due.empty() ? "" : ",") + queue.front();
    }
    deviate(Deviation::Kind::other_answer, edge.model, output, due.empty() ? "nothing due" : due);
    return std::nullopt;
  }

  // In the deadlock: the call must be refused, because its actor is still in an earlier one.
  void test_end(const Probe& probe) {
    const SulStep* seen = next_answer(views_[probe.model]);
    if (seen == nullptr || seen->status == StepStatus::refused) return;
    deviate(Deviation::Kind::deadlock, probe.model,
            fmt::format("{}.{} is not possible", system_.models[probe.model].name,
                        system_.models[probe.model].automaton.inputs().name(probe.input)),
            mealy_output(*seen, Translation::eager));
  }

  const System& system_;
  const Trace& trace_;
  const Plan& plan_;
  const std::vector<std::unique_ptr<RealSystem>>& real_;
  std::vector<InstanceView> views_;
  std::vector<std::optional<Probe>> calls_;  // by program: its last call, if its return is hidden
  Move move_;
  ReplayedRun run_;
};

// The words of some runs, on one instance: an answer for each.
std::vector<SulAnswer> play(const RealSystem& real, std::size_t model, std::span<const Plan> plans,
                            const RunControl& control) {
  std::vector<SulAnswer> answers(plans.size());
  std::vector<SulQuery> batch;
  std::vector<std::size_t> run_of;
  for (std::size_t run = 0; run < plans.size(); ++run) {
    const Word& inputs = plans[run].words[model];
    if (inputs.empty()) continue;
    Word word;
    for (const Symbol input : inputs) word.push_back(real.inputs[input]);
    batch.push_back({std::move(word), Translation::eager});
    run_of.push_back(run);
  }
  real.sul->run(
      batch,
      [&](std::size_t index, SulAnswer answer) { answers[run_of[index]] = std::move(answer); },
      control);
  for (const SulAnswer& answer : answers) {
    if (answer.end == WordEnd::aborted) {
      throw WrapperError("the word was aborted", real.description);
    }
  }
  return answers;
}

// The models that the run meets, in its steps or by what a program of its components waits for in
// the end.
std::set<std::uint32_t> find_met(const System& system, const Trace& trace,
                                 const GlobalState& last) {
  std::set<std::uint32_t> met;
  const auto add = [&](const Program& program, const ProgramEdge& edge) {
    for (const ModelUse& use : program.uses_of(edge)) met.insert(use.model);
  };
  for (const Step& step : trace.steps) add(system.programs[step.program], edge_of(system, step));
  for (const auto& component : find_components(system)) {
    const bool is_met = std::any_of(trace.steps.begin(), trace.steps.end(), [&](const Step& step) {
      return std::find(component.begin(), component.end(), step.program) != component.end();
    });
    if (!is_met && !trace.steps.empty()) continue;
    for (const std::uint32_t index : component) {
      const Program& program = system.programs[index];
      for (const ProgramEdge& edge : program.edges_of(last.programs[index])) add(program, edge);
    }
  }
  return met;
}

// A program waits for a step with real systems that no probe tries.
bool is_untried(const System& system, const Program& program, const ProgramEdge& edge) {
  const auto uses = program.uses_of(edge);
  return edge.kind == Kind::joint && std::any_of(uses.begin(), uses.end(), [&](const auto& use) {
           return system.models[use.model].source == ModelInstance::Source::file;
         });
}

}  // namespace

Unplayed find_unplayed(const System& system, std::span<const Trace> traces) {
  using Source = ModelInstance::Source;
  std::set<std::uint32_t> met;
  for (const Trace& trace : traces)
    met.merge(find_met(system, trace, replay(system, trace).back()));
  const auto is = [&](std::uint32_t model, Source source) {
    return system.models[model].source == source;
  };
  Unplayed unplayed;
  unplayed.is_all = std::none_of(met.begin(), met.end(),
                                 [&](std::uint32_t model) { return is(model, Source::file); });
  if (!unplayed.is_all) {
    std::erase_if(met, [&](std::uint32_t model) { return is(model, Source::variable); });
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
      found.insert(fmt::format("{}'s {}{} at line {} was never tried there ({}), {}", text.program,
                               text.model, text.event, text.line, describe_bound(model),
                               is_cut ? "and is not played" : "and is taken to change nothing"));
    }
  }
  if (trace.loop_start) return {found.begin(), found.end()};
  for (const std::uint32_t index : deadlocked_programs(system, states.back())) {
    const Program& program = system.programs[index];
    for (const ProgramEdge& edge : program.edges_of(states.back().programs[index])) {
      if (is_untried(system, program, edge)) {
        found.insert(fmt::format("{} waits at line {} for {}, which is not tried", program.name,
                                 edge.line, describe_edge(system, program, edge)));
      }
      if (edge.kind != Kind::give) continue;
      const ModelInstance& model = system.models[edge.model];
      const StateId at = states.back().models[edge.model];
      const std::string call = describe_edge(system, program, edge);
      if (!model.automaton.is_quiescent(at)) {
        found.insert(
            fmt::format("{} waits with {} for somebody to take {}: so programs and models "
                        "meet, whatever the real call would do",
                        program.name, call, describe_due(model.automaton, at)));
      } else if (is_beyond_learned(model.automaton, at, edge.symbol)) {
        found.insert(fmt::format("{}'s {} at line {} was never tried there ({}), and waits",
                                 program.name, call, edge.line, describe_bound(model)));
      }
    }
  }
  return {found.begin(), found.end()};
}

bool ends_in_deadlock(const System& system, const Trace& trace) {
  return !trace.loop_start && !deadlocked_programs(system, replay(system, trace).back()).empty();
}

void play_on_real_system(const System& system, const std::vector<std::unique_ptr<RealSystem>>& real,
                         std::span<const Trace> traces, const ReplayOptions& options,
                         const std::function<void(std::size_t, ReplayedRun)>& sink) {
  for (std::size_t first = 0; first < traces.size(); first += runs_at_once) {
    options.control.check("replay");
    options.control.report({"replaying", 0, 0, 0, first, traces.size()});
    const std::size_t count = std::min(runs_at_once, traces.size() - first);
    std::vector<Plan> plans;
    for (std::size_t run = 0; run < count; ++run) {
      plans.push_back(make_plan(system, traces[first + run], options.loops, real));
    }
    std::vector<std::vector<SulAnswer>> answers(count);  // by run, by instance
    for (std::size_t model = 0; model < real.size(); ++model) {
      auto its = real[model] ? play(*real[model], model, plans, options.control)
                             : std::vector<SulAnswer>(count);
      for (std::size_t run = 0; run < count; ++run) answers[run].push_back(std::move(its[run]));
    }
    for (std::size_t run = 0; run < count; ++run) {
      sink(first + run, Walk(system, traces[first + run], plans[run], real, answers[run]).run());
    }
  }
}

}  // namespace maide
