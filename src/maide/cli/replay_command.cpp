// `maide replay SYSTEM.yaml TRACE`: does the real middleware do what the counterexample says?
// `maide replay SYSTEM.yaml --random N`: does it do what the models say, in random runs?
#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "maide/base/file.hpp"
#include "maide/base/log.hpp"
#include "maide/base/text.hpp"
#include "maide/check/build/constant_settings.hpp"
#include "maide/check/build/system_file.hpp"
#include "maide/check/system/trace_file.hpp"
#include "maide/check/verdict/check_system.hpp"
#include "maide/cli/command.hpp"
#include "maide/cli/command_line.hpp"
#include "maide/join/at_rest.hpp"
#include "maide/join/learned_models.hpp"
#include "maide/join/real_system.hpp"
#include "maide/join/replay.hpp"
#include "maide/join/replay_plan.hpp"

namespace maide::cli {
namespace {

struct ReplayArguments {
  std::string system;
  std::string trace;
  std::size_t rounds = 1;
  std::size_t loops = 3;
  std::size_t random_runs = 0;
  std::size_t steps = 60;
  std::uint64_t seed = 1;
  std::vector<std::string> settings;   // "rmw=fastrtps"
  std::vector<std::string> constants;  // "n=5"
  std::string token_file;
  std::size_t jobs = 0;
};

// What came of all runs.
struct Tally {
  std::size_t runs = 0, followed = 0;
  std::size_t steps = 0;      // that were followed
  std::size_t deadlocks = 0;  // runs that were followed into one
  std::size_t others = 0;     // left for another answer that the model has, too
  std::vector<std::pair<std::string, std::size_t>> outcomes;  // by how often
  // The first run that was not followed, else the first: which, and how it went.
  std::size_t shown = 0;
  std::optional<ReplayedRun> example;

  void count(const std::string& outcome) {
    for (auto& [known, times] : outcomes) {
      if (known == outcome) return void(++times);
    }
    outcomes.emplace_back(outcome, 1);
  }
};

struct Replay {
  System system;
  std::shared_ptr<const ReplayedNodes> nodes;  // that are met; none: none are
  std::vector<std::unique_ptr<RealSystem>> real;
  std::vector<Trace> traces;
  std::string property;
  std::vector<std::string> assumptions;
  bool is_reordered = false;  // the trace's steps are in an order in which executors do them
};

std::string describe(const System& system, const Trace& trace, const Deviation& deviation) {
  std::string where = "at the end";
  if (deviation.step < trace.steps.size()) {
    const StepText step = describe_step(system, trace.steps[deviation.step]);
    where = fmt::format("step {}, {} line {} {}{}", deviation.step + 1, step.actor, step.line,
                        step.model, step.event);
  }
  if (deviation.round > 0) where += fmt::format(", round {} of the loop", deviation.round + 1);
  const char* remark =
      deviation.kind == Deviation::Kind::other_answer ? " (the model has that answer, too)" : "";
  return fmt::format("{}: expected {}, seen {}{}", where, deviation.expected, deviation.seen,
                     remark);
}

Tally play(const Replay& replay, const ReplayArguments& arguments, Context& context) {
  Tally tally;
  const bool is_random = arguments.random_runs > 0;
  const auto sink = [&](std::size_t index, ReplayedRun run) {
    const Trace& trace = replay.traces[index];
    const auto& deviation = run.deviation;
    ++tally.runs;
    tally.steps += run.steps;
    if (!deviation) {
      ++tally.followed;
      if (ends_in_deadlock(replay.system, trace)) ++tally.deadlocks;
      tally.count("followed");
    } else {
      if (deviation->kind == Deviation::Kind::other_answer) ++tally.others;
      tally.count(describe(replay.system, trace, *deviation));
    }
    if (!tally.example || (deviation && !tally.example->deviation)) {
      tally.shown = index;
      tally.example = std::move(run);
    }
  };
  try {
    play_on_real_system(replay.system, replay.real, replay.traces,
                        {is_random ? 1 : arguments.loops, context.control()}, sink);
  } catch (const Interrupted& stop) {
    if (tally.runs == 0) throw;
    context.complain(fmt::format("{}; {} of {} runs were played", stop.what(), tally.runs,
                                 replay.traces.size()));
  }
  std::ranges::stable_sort(tally.outcomes, [](const auto& left, const auto& right) {
    return left.second > right.second;
  });
  return tally;
}

// The answer in one word, and the exit status.
std::pair<std::string, ExitStatus> verdict_of(const Replay& replay, const Tally& tally,
                                              bool is_random) {
  // A random run that went on as the model allows refutes nothing.
  const std::size_t as_modelled = tally.followed + (is_random ? tally.others : 0);
  if (as_modelled == 0) return {"not followed", ExitStatus::violated};
  if (as_modelled < tally.runs) {
    return is_random ? std::pair{"not followed", ExitStatus::violated}
                     : std::pair{"followed at times", ExitStatus::inconclusive};
  }
  if (tally.runs < replay.traces.size()) return {"interrupted", ExitStatus::inconclusive};
  if (!replay.assumptions.empty()) {
    return {"followed as far as it can be asked", ExitStatus::inconclusive};
  }
  return {"followed", ExitStatus::ok};
}

// The steps of the example, each with what the system did.
std::string list_steps(const Replay& replay, const Tally& tally) {
  constexpr std::size_t most_shown = 200;
  const Trace& trace = replay.traces[tally.shown];
  std::size_t width = 0;
  for (const Program& program : replay.system.programs) {
    width = std::max(width, program.name.size());
  }
  std::string text;
  const std::size_t count = tally.example->seen.size();
  const std::size_t head = count > most_shown ? most_shown / 2 : count;
  const std::size_t tail = count > most_shown ? count - (most_shown - head) : count;
  for (std::size_t at = 0; at < count; ++at) {
    if (trace.loop_start == at) text += "  from here on, again and again:\n";
    if (at == head && tail > head) text += fmt::format("  ... {} steps ...\n", tail - head);
    if (at >= head && at < tail) continue;
    const StepText step = describe_step(replay.system, trace.steps[at]);
    const std::string& seen = tally.example->seen[at];
    std::string line = fmt::format("{:>5}  {:<{}}  line {:<4} {}", at + 1, step.actor, width,
                                   step.line, step.model + step.event);
    if (!seen.empty()) line = fmt::format("{:<{}}  {}", line, width + 39, seen);
    text += line + "\n";
  }
  return text;
}

std::string as_text(const Replay& replay, const Tally& tally, const std::string& verdict,
                    const ReplayArguments& arguments) {
  const bool is_random = arguments.random_runs > 0;
  std::string text;
  for (const auto& real : replay.real) {
    if (real) text += fmt::format("{}: {}\n", real->instance, real->description);
  }
  const bool is_shown = !is_random || tally.example->deviation;
  if (is_shown) {
    if (replay.is_reordered) {
      text += "the steps are in another order, in which rclcpp's executors do them:\n";
    }
    if (tally.runs > 1) text += fmt::format("run {}:\n", tally.shown + 1);
    text += list_steps(replay, tally);
  }
  for (const auto& [outcome, times] : tally.outcomes) {
    text += fmt::format("{} of {}: {}\n", times, tally.runs, outcome);
  }
  if (is_random) {
    text += fmt::format("{} steps were followed, {} runs ended in a deadlock\n", tally.steps,
                        tally.deadlocks);
  } else if (tally.deadlocks > 0) {
    text += replay.assumptions.empty() ? "the deadlock is real: " : "at its end ";
    text += "the system is at rest and owes nothing that a program waits for\n";
  }
  if (!replay.assumptions.empty()) text += "this rests on:\n";
  for (const std::string& assumption : replay.assumptions) text += "  - " + assumption + "\n";
  return text + "verdict: " + verdict + "\n";
}

Json as_json(const Replay& replay, const Tally& tally, const std::string& verdict,
             const ReplayArguments& arguments) {
  Json json{{"verdict", verdict},
            {"runs", tally.runs},
            {"followed", tally.followed},
            {"deadlocks", tally.deadlocks},
            {"steps_followed", tally.steps}};
  if (!replay.property.empty()) json["property"] = replay.property;
  if (arguments.random_runs > 0) json["seed"] = arguments.seed;
  json["systems"] = Json::object();
  for (const auto& real : replay.real) {
    if (real) json["systems"][real->instance] = real->description;
  }
  json["outcomes"] = Json::array();
  for (const auto& [outcome, times] : tally.outcomes) {
    json["outcomes"].push_back({{"outcome", outcome}, {"runs", times}});
  }
  json["assumptions"] = replay.assumptions;
  json["run"] = tally.shown + 1;
  json["steps"] = Json::array();
  const Trace& trace = replay.traces[tally.shown];
  for (std::size_t at = 0; at < tally.example->seen.size(); ++at) {
    Json step = step_to_json(describe_step(replay.system, trace.steps[at]));
    const std::string& seen = tally.example->seen[at];
    step["seen"] = seen.empty() ? Json() : Json(seen);
    json["steps"].push_back(std::move(step));
  }
  json["deviation"] = nullptr;
  if (const auto& deviation = tally.example->deviation) {
    json["deviation"] = {{"step", deviation->step + 1},
                         {"round", deviation->round + 1},
                         {"model", replay.system.models[deviation->model].name},
                         {"expected", deviation->expected},
                         {"seen", deviation->seen},
                         {"word", deviation->word}};
  }
  return json;
}

// A run of this system need not show in this system what it showed in its own.
void check_claim(const System& system, const std::string& property, const Trace& trace,
                 const std::string& file) {
  if (property.empty()) return;
  const Property claimed = find_property(system, property);
  const std::string flaw = find_flaw_in_parts(system, claimed, trace);
  if (flaw.empty()) return;
  throw UsageError(fmt::format("the trace does not show that '{}' is {} in {}: {} ({})", property,
                               claimed.is_possibility ? "possible" : "violated", system.file, flaw,
                               file));
}

// What no real system is asked for is an assumption, and if that is all, there is nothing to
// replay.
void note_unplayed(Replay& replay) {
  Unplayed unplayed = find_unplayed(replay.system, replay.traces, replay.nodes.get());
  if (unplayed.is_all) {
    throw UsageError(fmt::format(
        "there is nothing real to replay this on: {} ({})",
        unplayed.models.empty() ? "no step is one with a model" : join(unplayed.models, "; "),
        replay.system.file));
  }
  replay.assumptions.insert(replay.assumptions.begin(), unplayed.models.begin(),
                            unplayed.models.end());
}

// Callbacks start when executors pick them. So steps of programs that do not wait for one another
// may come in another order than in the file.
Trace in_order_of_executors(Replay& replay, const Trace& trace, const RunControl& control) {
  const auto ordered = order_for_executors(replay.system, replay.nodes->rules(), trace, control);
  control.check("replaying");
  if (!ordered) {
    log_note(
        "no order of the steps was found in which executors pick the callbacks as rclcpp's do; "
        "they are played as they stand");
    return trace;
  }
  if (*ordered == trace) return trace;
  if (!replay.property.empty()) {
    const Property property = find_property(replay.system, replay.property);
    if (!find_flaw_in_parts(replay.system, property, *ordered).empty()) return trace;
  }
  replay.is_reordered = true;
  return *ordered;
}

// `trace_text` is that of the trace, if there is one. `late`: the system with messages on their
// way; the replayed one is at rest. Returns why the trace cannot be played; "": it can.
std::string read_traces(Replay& replay, const System& late, const ReplayArguments& arguments,
                        const std::string& trace_text, const ModelRequests& requests,
                        const RunControl& control) {
  const auto find_played = [&] {
    if (meet_nodes(replay.system, replay.traces))
      replay.nodes = find_nodes(replay.system, requests);
    note_unplayed(replay);
  };
  if (arguments.random_runs > 0) {
    Random random(arguments.seed);
    for (std::size_t run = 0; run < arguments.random_runs; ++run) {
      replay.traces.push_back(
          draw_run(replay.system, arguments.steps, random, !replay.system.callbacks.empty()));
    }
    find_played();
    return "";
  }
  TraceFile file = parse_trace(trace_text, arguments.trace, late);
  replay.property = std::move(file.property);
  check_claim(late, replay.property, file.trace, arguments.trace);
  if (!late.nobodys_actions.empty()) {
    auto at_rest = find_run_at_rest(late, replay.property, file.trace, replay.system, control);
    if (!at_rest) return "not tried: needs " + describe_late_message(late, file.trace);
    if (at_rest->is_another) {
      log_note("the trace needs " + describe_late_message(late, file.trace) +
               "; what is played is another run, which violates the property without one");
    }
    file.trace = std::move(at_rest->trace);
  }
  replay.assumptions = find_assumptions(replay.system, file.trace);
  replay.traces = {file.trace};
  find_played();
  if (replay.nodes) file.trace = in_order_of_executors(replay, file.trace, control);
  replay.traces.assign(arguments.rounds, file.trace);
  return "";
}

ExitStatus run_replay(const ReplayArguments& arguments, Context& context) {
  const bool is_random = arguments.random_runs > 0;
  if (is_random != arguments.trace.empty()) {
    throw UsageError(is_random ? "give a trace or --random, not both"
                               : "give a trace (maide check SYSTEM --trace FILE), or --random N");
  }
  ModelRequests requests;
  const ModelSource models = record_requests(
      make_learning_source(
          {{}, [](const std::string& line) { log_note(line); }, context.control(), arguments.jobs}),
      requests);
  std::vector<ConstantSetting> constants = parse_settings(arguments.constants);
  std::string trace_text;
  if (!is_random) {
    trace_text = read_file(arguments.trace, context.control());
    // A trace is one of the system with which it was found.
    if (constants.empty()) {
      constants = settings_of_trace(parse_json(trace_text, arguments.trace), arguments.trace);
      if (!constants.empty()) log_note("as in the trace: --set " + to_string(constants));
    }
  }
  Replay replay;
  const System late = read_system(arguments.system, models, context.control(), constants);
  replay.system = late.nobodys_actions.empty()
                      ? late
                      : read_system(arguments.system, models, context.control(), constants,
                                    Deliveries::at_rest);
  const std::string untried =
      read_traces(replay, late, arguments, trace_text, requests, context.control());
  if (!untried.empty()) {
    context.print(untried + "\n");
    context.set_result({{"verdict", "not tried"}, {"reason", untried}});
    return ExitStatus::inconclusive;
  }
  // One run keeps one system busy.
  const std::size_t jobs = replay.traces.size() == 1 ? 1 : arguments.jobs;
  const auto settings = parse_system_spec("sim", arguments.settings).options;
  replay.real =
      open_real_systems(replay.system, requests,
                        {jobs, arguments.token_file, context.control(), replay.nodes, settings});
  const Tally tally = play(replay, arguments, context);
  const auto [verdict, status] = verdict_of(replay, tally, is_random);
  context.print(as_text(replay, tally, verdict, arguments));
  context.set_result(as_json(replay, tally, verdict, arguments));
  return status;
}

}  // namespace

RunFunction set_up_replay(CommandLine& line) {
  auto arguments = std::make_shared<ReplayArguments>();
  line.add("SYSTEM", arguments->system, "A system file (YAML): models, programs, properties")
      .required();
  line.add("TRACE", arguments->trace,
           "A counterexample of it. `maide check SYSTEM --trace FILE` writes one");
  line.add("--rounds", arguments->rounds, "How often the trace is played").between(1, 1'000'000);
  line.add("--loops", arguments->loops, "How often an endless trace's loop is played")
      .between(1, 1'000'000);
  line.add("--random", arguments->random_runs,
           "Play this many random runs in place of a trace. The programs run, and each step is "
           "compared with the models")
      .no_default()
      .value_name("N")
      .between(1, 1'000'000);
  line.add("--steps", arguments->steps, "Most steps of a random run").between(1, 1'000'000);
  line.add("--with", arguments->settings,
           "An option of the real systems, in place of the one with which they were learned: "
           "--with rmw=fastrtps. May be given more than once")
      .no_default()
      .one_each()
      .value_name("KEY=VALUE");
  add_set_option(line, arguments->constants);
  add_seed_option(line, arguments->seed);
  add_token_option(line, arguments->token_file);
  add_jobs_option(line, arguments->jobs);
  return [arguments](Context& context) { return run_replay(*arguments, context); };
}

}  // namespace maide::cli
