#include "maide/join/replay.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <deque>
#include <set>
#include <utility>

#include "maide/base/error.hpp"
#include "maide/base/text.hpp"
#include "maide/check/rules/model_ends.hpp"
#include "maide/check/rules/model_words.hpp"
#include "maide/check/system/trace_file.hpp"
#include "maide/check/verdict/check_system.hpp"
#include "maide/join/replay_plan.hpp"
#include "maide/sul/ia_translation.hpp"
#include "maide/wire/wrapper/full_setup.hpp"

namespace maide {
namespace {

using Kind = ProgramEdge::Kind;
using Actions = std::vector<std::deque<std::string>>;  // outputs due, by actor

constexpr std::size_t runs_at_once = 16;  // between two looks at whether to stop

// Whether the automaton can emit all that is due, each actor's outputs in their order, and then has
// no output left.
bool emits(const InterfaceAutomaton& automaton, StateId state, const Actions& due) {
  const bool is_empty = std::ranges::all_of(due, [](const auto& queue) { return queue.empty(); });
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

// One real system as it is seen along the trace.
struct HostView {
  const SulAnswer* answer = nullptr;
  std::size_t next = 0;  // step of the answer
  // What it gave to a topic's writers and none took yet, in the names of one writer; by writer.
  Actions written;
};

// Walks along a plan with the answers of the real systems.
class Walk {
 public:
  Walk(const System& system, const Trace& trace, const Plan& plan, const Stage& stage,
       const std::vector<SulAnswer>& answers)
      : system_(system),
        trace_(trace),
        plan_(plan),
        stage_(stage),
        views_(answers.size()),
        due_(answers.size()),
        calls_(system.programs.size()) {
    for (std::uint32_t model = 0; model < answers.size(); ++model) {
      const RealSystem* real = stage.real(model);
      if (real == nullptr) continue;
      views_[model].answer = &answers[model];
      due_[model].resize(std::max<std::size_t>(real->sul->info().actors.size(), 1));
      const Seat& seat = stage.seat(model);
      if (seat.nodes != nullptr) due_[model].resize(ends_beside_nodes(model));
      if (seat.topic != nullptr) views_[seat.host].written.resize(seat.topic->writers.size());
    }
  }

  ReplayedRun run() {
    for (std::size_t place = 0; place < plan_.moves.size(); ++place) {
      move_ = plan_.moves[place];
      place_ = place;
      take(plan_.steps[place]);
      if (run_.deviation) return std::move(run_);
      ++run_.steps;
    }
    move_ = {trace_.steps.size(), 0};
    if (!play_calls(plan_.nodes.end, Deviation::Kind::deadlock)) return std::move(run_);
    std::vector<StateId> at = plan_.states.back().models;
    for (const Probe& probe : plan_.probes) {
      test_end(probe, at);
      if (run_.deviation) break;
    }
    return std::move(run_);
  }

 private:
  // A service's server and clients; a topic has one end here.
  std::size_t ends_beside_nodes(std::uint32_t model) const {
    for (const ServiceInstance& service : system_.services) {
      if (service.model == model) return service.clients.size() + 1;
    }
    return 1;
  }

  void see(std::string what) {
    if (move_.round == 0) run_.seen.push_back(std::move(what));
  }

  void deviate(Deviation::Kind kind, std::uint32_t model, std::string expected, std::string seen) {
    if (move_.round == 0 && move_.step < trace_.steps.size()) run_.seen.push_back(seen);
    const TopicInstance* topic = stage_.seat(model).topic;
    const bool is_of_topic =
        topic != nullptr && (topic->readers.size() > 1 || topic->writers.size() > 1);
    run_.deviation =
        Deviation{kind,           move_.step,          move_.round,
                  model,          std::move(expected), std::move(seen),
                  word_of(model), is_of_topic,         stage_.seat(model).nodes != nullptr};
  }

  // The inputs that the model got so far, those of the present move and of probes up to the one
  // that was asked last included.
  std::vector<std::string> word_of(std::uint32_t model) const {
    std::vector<std::string> word;
    const Alphabet& inputs = system_.models[model].automaton.inputs();
    for (const Move& move : plan_.moves) {
      if (move.round > move_.round || (move.round == move_.round && move.step > move_.step)) break;
      const Step& step = trace_.steps[move.step];
      for (const ModelUse& event : events_of(system_, step)) {
        if (event.kind != Kind::give || event.model != model || step.is_beyond) continue;
        word.push_back(inputs.name(event.index));
      }
    }
    for (std::size_t probe = 0; probe < probed_; ++probe) {
      if (plan_.probes[probe].model != model) continue;
      word.push_back(inputs.name(plan_.probes[probe].input));
    }
    return word;
  }

  void take(const Step& step) {
    if (is_held_up(step.actor)) return;
    // A `quiet` shows nothing: what is not due in the model is not due here, for give()
    // has looked.
    std::string seen;
    for (const ModelUse& event : stage_.real_events(step)) {
      const auto text = event.kind == Kind::give ? give(step, event) : take_output(step, event);
      if (!text) return;
      seen += (seen.empty() || text->empty() ? "" : "; ") + *text;
    }
    if (stage_.host_of_nodes()) {
      const auto text = take_with_nodes(step);
      if (!text) return;
      seen += (seen.empty() || text->empty() ? "" : "; ") + *text;
    }
    see(seen);
  }

  // ---- nodes ------------------------------------------------------------------------------------

  // Makes the calls, and what programs get is due to them. Executors and callbacks must answer what
  // is planned. What was seen, in words; none if it deviates.
  std::optional<std::string> play_calls(const std::vector<ReplayedNodes::Call>& calls,
                                        Deviation::Kind kind = Deviation::Kind::output) {
    std::string text;
    if (calls.empty()) return text;
    const std::uint32_t host = *stage_.host_of_nodes();
    const ReplayedNodes& nodes = *stage_.seat(host).nodes;
    const auto in_words = [&](const std::vector<std::string>& events) {
      std::vector<std::string> words;
      for (const std::string& event : events) words.push_back(nodes.describe(event));
      return words.empty() ? "quiet" : join(words);
    };
    for (const ReplayedNodes::Call& call : calls) {
      const SulStep* step = next_answer(host);
      std::vector<std::string> seen, all;
      for (const Event& event : step == nullptr ? std::vector<Event>{} : step->events) {
        all.push_back(event.output);
        const auto output = nodes.output_of(event.output);
        if (output && kind != Deviation::Kind::deadlock) {
          due_[output->model][output->end].push_back(output->name);
        } else {
          seen.push_back(event.output);
        }
      }
      const bool is_taken = step != nullptr && step->status == StepStatus::taken;
      // Threads of executors may tell of what they do in any order.
      std::ranges::sort(seen);
      std::ranges::sort(all);
      if (!is_taken || seen != call.expected) {
        deviate(kind, host, in_words(call.expected), is_taken ? in_words(all) : describe(step));
        return std::nullopt;
      }
      if (!all.empty()) text += (text.empty() ? "" : "; ") + in_words(all);
    }
    return text.empty() ? "quiet" : text;
  }

  std::optional<std::string> take_with_nodes(const Step& step) {
    auto text = play_calls(plan_.nodes.moves[place_]);
    if (!text) return std::nullopt;
    const bool is_program = system_.programs[step.actor].nodes.empty();
    for (const ModelUse& event : events_of(system_, step)) {
      if (stage_.seat(event.model).nodes == nullptr || event.kind != Kind::take || !is_program) {
        continue;
      }
      if (!take_output(step, event)) return std::nullopt;
    }
    const std::uint32_t host = *stage_.host_of_nodes();
    for (const std::uint32_t model : stage_.models_of(host)) {
      const InterfaceAutomaton& automaton = system_.models[model].automaton;
      const StateId at = plan_.states[place_ + 1].models[model];
      if (emits(automaton, at, due_[model])) continue;
      deviate(Deviation::Kind::output, model, describe_due(automaton, at), *text);
      return std::nullopt;
    }
    return text;
  }

  // The program is still in a call whose return the model hides.
  bool is_held_up(std::uint32_t program) {
    const auto& call = calls_[program];
    if (!call) return false;
    const HostView& view = views_[stage_.seat(call->model).host];
    const auto& busy = view.answer->steps[view.next - 1].busy;
    const Symbol input = stage_.input_of(program, *call);
    const std::uint32_t actor = stage_.real(call->model)->sul->info().inputs[input].actor;
    if (std::ranges::find(busy, actor) == busy.end()) {
      calls_[program].reset();
      return false;
    }
    const std::string name = describe_call(*call);
    deviate(Deviation::Kind::pending_call, call->model, name + " has returned",
            name + " still blocks");
    return true;
  }

  std::string describe_call(const ModelUse& call) const {
    return system_.models[call.model].name + "." +
           system_.models[call.model].automaton.inputs().name(call.index);
  }

  // Where the model is when it has taken the input: before the outputs that the step takes with it.
  // A model that the step does not use stays where it was.
  StateId after_input(const Step& step, std::uint32_t model) const {
    const auto uses = uses_of(system_, step);
    const auto use = std::ranges::find(uses, model, &ModelUse::model);
    const StateId before = plan_.states[place_].models[model];
    if (use == uses.end()) return before;
    const StateId target = step.targets[static_cast<std::size_t>(use - uses.begin())];
    if (use->kind == Kind::give) return target;
    const InterfaceAutomaton& automaton = system_.models[model].automaton;
    const auto given_to = [&](const ModelUse& event) {
      return event.kind == Kind::give && event.model == model;
    };
    const auto events = events_of(system_, step);
    const auto input = std::ranges::find_if(events, given_to);
    if (input == events.end()) return target;
    for (const auto& given : automaton.transitions(before)) {
      if (given.action != Action{Action::Kind::input, input->index} || given.absorbed) continue;
      if (given.target == target) return target;
      for (const ModelUse& taken : events) {
        if (taken.kind != Kind::take || taken.model != model) continue;
        for (const auto& output : automaton.transitions(given.target)) {
          if (output.action == Action{Action::Kind::output, taken.index} &&
              output.target == target) {
            return given.target;
          }
        }
      }
    }
    return target;
  }

  // What was seen; none if it deviates.
  std::optional<std::string> give(const Step& step, const ModelUse& event) {
    const std::uint32_t host = stage_.seat(event.model).host;
    const SulStep* seen = next_answer(host);
    const std::string text = describe(seen);
    const bool is_taken = seen != nullptr && seen->status == StepStatus::taken;
    if (is_taken) note_events(host, *seen);
    std::vector<StateId> expected;
    const std::vector<std::uint32_t> models = stage_.models_of(host);
    for (const std::uint32_t model : models) expected.push_back(after_input(step, model));
    if (is_taken && is_as_expected(host, models, expected)) {
      remember_call(step.actor, event);
      return text;
    }
    const StateId before = plan_.states[place_].models[event.model];
    const InterfaceAutomaton& automaton = system_.models[event.model].automaton;
    const auto transitions = automaton.transitions(before);
    const bool is_another =
        is_taken && models.size() == 1 &&
        std::ranges::any_of(transitions, [&](const auto& transition) {
          return transition.action == Action{Action::Kind::input, event.index} &&
                 !transition.absorbed && is_as_expected(host, models, {transition.target});
        });
    deviate(is_another ? Deviation::Kind::other_answer : Deviation::Kind::output, event.model,
            describe_expected(models, expected), text);
    return std::nullopt;
  }

  static std::string describe(const SulStep* seen) {
    return seen == nullptr ? "nothing: the system has ended"
                           : mealy_output(*seen, Translation::eager);
  }

  const SulStep* next_answer(std::uint32_t host) {
    HostView& view = views_[host];
    const std::size_t at = view.next++;
    return at < view.answer->steps.size() ? &view.answer->steps[at] : nullptr;
  }

  // To each reader's model of a topic its own outputs, under the names that it has for them.
  void note_events(std::uint32_t host, const SulStep& seen) {
    for (const Event& event : seen.events) {
      const TopicInstance* topic = stage_.seat(host).topic;
      if (topic == nullptr || !note_of_topic(host, *topic, event)) {
        due_[host][event.actor].push_back(event.output);
      }
    }
  }

  bool note_of_topic(std::uint32_t host, const TopicInstance& topic, const Event& event) {
    for (std::size_t reader = 0; reader < topic.readers.size(); ++reader) {
      const std::uint32_t model = topic.readers[reader].model;
      const InterfaceAutomaton& automaton = system_.models[model].automaton;
      for (const std::string& name : automaton.outputs().names()) {
        if (is_of_writer(automaton, name)) {
          for (std::size_t writer = 0; reader == 0 && writer < topic.writers.size(); ++writer) {
            if (symbol_name(name, writer) != event.output) continue;
            views_[host].written[writer].push_back(name);
            return true;
          }
        } else if (symbol_name(name, reader) == event.output) {
          due_[model][event.actor].push_back(name);
          return true;
        }
      }
    }
    return false;
  }

  // Each model has due what the system gave; and a topic's writer what all readers' models say.
  bool is_as_expected(std::uint32_t host, const std::vector<std::uint32_t>& models,
                      const std::vector<StateId>& expected) const {
    for (std::size_t i = 0; i < models.size(); ++i) {
      if (!emits(system_.models[models[i]].automaton, expected[i], due_[models[i]])) return false;
    }
    std::vector<std::string> written;
    for (const auto& queue : views_[host].written) {
      written.insert(written.end(), queue.begin(), queue.end());
    }
    return stage_.seat(host).topic == nullptr || written == written_of(models, expected);
  }

  // What is due to a topic's writer in these states of the readers' models: at most one output.
  std::vector<std::string> written_of(const std::vector<std::uint32_t>& models,
                                      const std::vector<StateId>& states) const {
    const TopicInstance& topic = *stage_.seat(models.front()).topic;
    std::vector<std::string> collected;
    for (std::size_t i = 0; i < models.size(); ++i) {
      const auto symbol = topic.readers[i].collected[states[i]];
      if (symbol) collected.push_back(system_.models[models[i]].automaton.outputs().name(*symbol));
    }
    if (collected.size() < (topic.delivers_one ? 1 : models.size())) return {};
    const auto failed = std::ranges::find_if(
        collected, [](const auto& name) { return name.starts_with("failed"); });
    return {failed == collected.end() ? collected.front() : *failed};
  }

  std::string describe_expected(const std::vector<std::uint32_t>& models,
                                const std::vector<StateId>& expected) const {
    const TopicInstance* topic = stage_.seat(models.front()).topic;
    std::string text;
    if (topic != nullptr) text = join(written_of(models, expected), ",");
    for (std::size_t i = 0; i < models.size(); ++i) {
      const std::string due = describe_due(system_.models[models[i]].automaton, expected[i]);
      if (due == "quiet") continue;
      text += (text.empty() ? "" : ",") + due;
      if (i > 0) text += " of " + system_.models[models[i]].name;
    }
    return text.empty() ? "quiet" : text;
  }

  void remember_call(std::uint32_t program, const ModelUse& event) {
    const InterfaceAutomaton& automaton = system_.models[event.model].automaton;
    const auto& hidden = automaton.hidden_returns;
    const std::string& name = automaton.inputs().name(event.index);
    if (std::ranges::find(hidden, name) == hidden.end()) return;
    calls_[program] = event;
  }

  // The system has it due, unless it has the choice of its outputs and chose another.
  std::optional<std::string> take_output(const Step& step, const ModelUse& event) {
    const Seat& seat = stage_.seat(event.model);
    Actions& queues = stage_.is_of_writers(event) ? views_[seat.host].written : due_[event.model];
    const std::string& output = system_.models[event.model].automaton.outputs().name(event.index);
    std::string due;
    for (std::size_t i = 0; i < queues.size(); ++i) {
      if (queues[i].empty()) continue;
      const bool is_mine =
          !stage_.is_of_writers(event) || i == stage_.writer_of(*seat.topic, step.actor);
      if (is_mine && queues[i].front() == output) {
        queues[i].pop_front();
        return "";
      }
      due += (due.empty() ? "" : ",") + queues[i].front();
    }
    deviate(Deviation::Kind::other_answer, event.model, output, due.empty() ? "nothing due" : due);
    return std::nullopt;
  }

  // In the deadlock: the call does what its model says, which is not what its program waits for.
  void test_end(const Probe& probe, std::vector<StateId>& at) {
    ++probed_;
    const std::uint32_t host = stage_.seat(probe.model).host;
    const SulStep* seen = next_answer(host);
    const std::vector<std::uint32_t> models = stage_.models_of(host);
    std::vector<StateId> expected;
    for (const std::uint32_t model : models) expected.push_back(at[model]);
    if (probe.reachable.empty()) {
      if (seen == nullptr || seen->status == StepStatus::refused) return;
      return deviate(Deviation::Kind::deadlock, probe.model,
                     describe_call({Kind::give, probe.model, probe.input}) + " is not possible",
                     describe(seen));
    }
    const std::size_t place = stage_.seat(probe.model).reader;
    if (seen != nullptr && seen->status == StepStatus::taken) {
      note_events(host, *seen);
      for (const StateId state : probe.reachable) {
        expected[place] = at[probe.model] = state;
        if (is_as_expected(host, models, expected)) return;
      }
    }
    deviate(Deviation::Kind::deadlock, probe.model, describe_expected(models, expected),
            describe(seen));
  }

  const System& system_;
  const Trace& trace_;
  const Plan& plan_;
  const Stage& stage_;
  std::vector<HostView> views_;  // by host
  std::vector<Actions> due_;     // by model: outputs that its system gave and no program took yet
  std::vector<std::optional<ModelUse>> calls_;  // by program: its last, if its return is hidden
  std::size_t probed_ = 0;                      // probes that were asked
  Move move_;
  std::size_t place_ = 0;  // of the move, in the plan
  ReplayedRun run_;
};

// The words of some runs, on one instance: an answer for each.
std::vector<SulAnswer> play(const RealSystem& real, std::size_t host, std::span<const Plan> plans,
                            const RunControl& control) {
  std::vector<SulAnswer> answers(plans.size());
  std::vector<SulQuery> batch;
  std::vector<std::size_t> run_of;
  for (std::size_t run = 0; run < plans.size(); ++run) {
    const Word& word = plans[run].words[host];
    if (word.empty()) continue;
    batch.push_back({word, Translation::eager});
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

}  // namespace

void play_on_real_system(const System& system, const std::vector<std::unique_ptr<RealSystem>>& real,
                         std::span<const Trace> traces, const ReplayOptions& options,
                         const std::function<void(std::size_t, ReplayedRun)>& sink) {
  const Stage stage(system, real);
  for (std::size_t first = 0; first < traces.size(); first += runs_at_once) {
    options.control.check("replay");
    options.control.report({"replaying", 0, 0, 0, first, traces.size()});
    const std::size_t count = std::min(runs_at_once, traces.size() - first);
    std::vector<Plan> plans;
    for (std::size_t run = 0; run < count; ++run) {
      const Trace& trace = traces[first + run];
      const bool is_again = run > 0 && trace == traces[first + run - 1];
      plans.push_back(is_again ? plans.back() : make_plan(system, stage, trace, options.loops));
    }
    std::vector<std::vector<SulAnswer>> answers(count);  // by run, by instance
    for (std::size_t model = 0; model < real.size(); ++model) {
      auto its = real[model] ? play(*real[model], model, plans, options.control)
                             : std::vector<SulAnswer>(count);
      for (std::size_t run = 0; run < count; ++run) answers[run].push_back(std::move(its[run]));
    }
    for (std::size_t run = 0; run < count; ++run) {
      sink(first + run, Walk(system, traces[first + run], plans[run], stage, answers[run]).run());
    }
  }
}

}  // namespace maide
