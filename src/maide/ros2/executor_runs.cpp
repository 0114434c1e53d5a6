#include "maide/ros2/executor_runs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <string>
#include <tuple>
#include <utility>

#include "maide/base/random.hpp"
#include "maide/check/rules/model_words.hpp"

namespace maide {

// ---- schedules ----------------------------------------------------------------------------------

namespace {

// Who takes turns: programs, and each wire. What arrives over one keeps its order.
std::size_t turns(const System& system) {
  return system.programs.size() + std::max<std::size_t>(system.nobodys_groups.size(), 1);
}
std::size_t turn_of(const System& system, const Step& step) {
  if (step.actor != nobody) return step.actor;
  return system.programs.size() + system.nobodys_actions[step.action].what.fair;
}

// A depth-first search for an order of the steps and for when threads pick. Each queue keeps its
// order. What comes first in the trace is tried first, and threads pick as late as they can.
class Scheduler {
 public:
  using Queue = std::vector<std::size_t>;  // steps of the trace

  Scheduler(const System& system, const ExecutorRules& rules, const Trace& trace,
            const RunControl& control)
      : system_(system), rules_(rules), trace_(trace), control_(control) {
    end_.at = initial_state(system);
    end_.rules = rules.initial();
    end_.runs.resize(actor_count(system));
  }

  // Goes on behind the last call. `goal`: the state in which it must end. False if there is no way.
  bool run(std::vector<Queue> queues, const GlobalState* goal) {
    queues_ = std::move(queues);
    visited_.clear();
    end_.progress.assign(queues_.size(), 0);
    std::vector<Place> path;
    path.push_back(std::move(end_));
    if (!enter(path.back())) return false;
    while (!path.empty()) {
      if (is_done(path.back()) && (goal == nullptr || path.back().at == *goal)) {
        for (Place& place : path) {
          if (place.step) steps_.push_back(std::move(*place.step));
        }
        end_ = std::move(path.back());
        end_.step.reset();
        return true;
      }
      std::optional<Place> next = next_of(path.back());
      if (!next) {
        path.pop_back();
      } else if (enter(*next)) {
        path.push_back(std::move(*next));
      }
    }
    return false;
  }

  const std::vector<ScheduledStep>& steps() const { return steps_; }
  const ExecutorRules::State& rules_at_end() const { return end_.rules; }

 private:
  // A way to go on: with a queue's next step or, where that is none, with a pick.
  struct Way {
    std::optional<std::size_t> queue;
    std::uint32_t executor = 0;
  };
  struct Place {
    std::vector<std::size_t> progress;  // by queue
    GlobalState at;
    ExecutorRules::State rules;
    std::vector<std::uint32_t> picks;                         // since the last step
    std::vector<std::pair<std::uint32_t, std::size_t>> runs;  // by actor: callback and run
    std::optional<ScheduledStep> step;                        // that led here
    std::vector<Way> ways;
    std::size_t tried = 0;  // of them
  };
  static constexpr std::size_t most_visited = 200'000;

  std::size_t step_of(const Place& place, std::size_t queue) const {
    return queues_[queue][place.progress[queue]];
  }

  bool is_done(const Place& place) const {
    for (std::size_t queue = 0; queue < queues_.size(); ++queue) {
      if (place.progress[queue] < queues_[queue].size()) return false;
    }
    return true;
  }

  // False if the search was there, or has to end.
  bool enter(Place& place) {
    if (visited_.size() == most_visited || control_.should_stop()) return false;
    if (!visited_.emplace(place.progress, place.at.models, place.rules).second) return false;
    if (is_done(place)) return true;
    for (std::size_t queue = 0; queue < queues_.size(); ++queue) {
      if (place.progress[queue] < queues_[queue].size()) place.ways.push_back({queue, 0});
    }
    std::ranges::sort(place.ways, [&](const Way& a, const Way& b) {
      return step_of(place, *a.queue) < step_of(place, *b.queue);
    });
    // Some thread may have picked before.
    for (std::uint32_t executor = 0; executor < system_.executors.size(); ++executor) {
      place.ways.push_back({std::nullopt, executor});
    }
    return true;
  }

  std::optional<Place> next_of(Place& place) const {
    while (place.tried < place.ways.size()) {
      const Way way = place.ways[place.tried++];
      std::optional<Place> next =
          way.queue ? behind_step(place, *way.queue) : behind_pick(place, way.executor, {});
      if (next) return next;
    }
    return std::nullopt;
  }

  static Place copy_of(const Place& place) {
    return {place.progress, place.at, place.rules, place.picks, place.runs, {}, {}, 0};
  }

  // Behind the queue's next step; or behind the pick that it needs first.
  std::optional<Place> behind_step(const Place& place, std::size_t queue) const {
    const std::size_t number = step_of(place, queue);
    const auto step = step_like(system_, place.at, trace_.steps[number]);
    if (!step) return std::nullopt;
    Place next = copy_of(place);
    auto& run = next.runs[actor_number(system_, step->actor)];
    if (const auto callback = picked_for(system_, *step)) {
      const std::uint32_t executor = system_.callbacks[*callback].executor;
      const auto& picked = place.rules.picked[executor];
      if (std::ranges::find(picked, *callback) == picked.end()) {
        return behind_pick(place, executor, {*callback});
      }
      if (started_by(system_, *step)) {
        run = {*callback, rules_.start(next.rules, *callback)};
      } else {
        rules_.discard(next.rules, *callback);
      }
    } else if (const auto found = found_by(system_, *step); !found.empty()) {
      const std::uint32_t executor = system_.callbacks[found.front()].executor;
      const auto first = rules_.pick(next.rules, executor, place.at, found);
      if (!first) return std::nullopt;
      next.picks.push_back(*first);
    } else if (is_end_of_callback(system_, *step)) {
      rules_.end(next.rules, run.first, run.second);
    }
    ++next.progress[queue];
    next.step = ScheduledStep{number, std::exchange(next.picks, {})};
    next.at = apply(system_, place.at, *step);
    return next;
  }

  // One that is picked already is not there a second time: its message may be the only one.
  std::optional<Place> behind_pick(const Place& place, std::uint32_t executor,
                                   const std::vector<std::uint32_t>& due) const {
    Place next = copy_of(place);
    const auto callback = rules_.pick(next.rules, executor, place.at, due);
    const auto& before = place.rules.picked[executor];
    if (!callback || std::ranges::find(before, *callback) != before.end()) {
      return std::nullopt;
    }
    next.picks.push_back(*callback);
    return next;
  }

  const System& system_;
  const ExecutorRules& rules_;
  const Trace& trace_;
  const RunControl& control_;
  std::vector<Queue> queues_;
  std::vector<ScheduledStep> steps_;
  Place end_;  // where the last search ended
  std::set<std::tuple<std::vector<std::size_t>, std::vector<StateId>, ExecutorRules::State>>
      visited_;
};

}  // namespace

std::vector<ScheduledStep> schedule(const System& system, const ExecutorRules& rules,
                                    const Trace& trace, std::span<const std::size_t> moves) {
  const RunControl control;
  Scheduler scheduler(system, rules, trace, control);
  if (scheduler.run({{moves.begin(), moves.end()}}, nullptr)) return scheduler.steps();
  std::vector<ScheduledStep> steps;
  for (const std::size_t move : moves) {
    steps.push_back({move, {}});
    if (const auto callback = picked_for(system, trace.steps[move])) {
      steps.back().picks = {*callback};
    }
  }
  return steps;
}

namespace {
constexpr std::size_t most_rounds = 8;  // of a loop, until executors repeat what they do
}  // namespace

std::optional<Trace> order_for_executors(const System& system, const ExecutorRules& rules,
                                         const Trace& as_told, const RunControl& control) {
  const Trace trace = closed(system, as_told, replay(system, as_told)).value();
  const std::vector<GlobalState> states = replay(system, trace);
  const std::size_t first_of_loop = trace.loop_start.value_or(trace.steps.size());
  Scheduler scheduler(system, rules, trace, control);
  const auto run = [&](std::size_t from, std::size_t to) {
    std::vector<Scheduler::Queue> queues(turns(system));
    for (std::size_t step = from; step < to; ++step) {
      queues[turn_of(system, trace.steps[step])].push_back(step);
    }
    return scheduler.run(std::move(queues), &states[to]);
  };
  if (!run(0, first_of_loop)) return std::nullopt;
  Trace ordered;
  // Round after round, until the executors are where they were before one of them.
  std::map<ExecutorRules::State, std::size_t> begins;  // steps before that round
  while (trace.loop_start) {
    const auto [place, is_new] =
        begins.try_emplace(scheduler.rules_at_end(), scheduler.steps().size());
    if (!is_new) {
      ordered.loop_start = place->second;
      break;
    }
    if (begins.size() > most_rounds || !run(first_of_loop, trace.steps.size())) return std::nullopt;
  }
  GlobalState at = initial_state(system);
  for (const ScheduledStep& scheduled : scheduler.steps()) {
    const auto step = step_like(system, at, trace.steps[scheduled.step]);
    ordered.steps.push_back(step.value());
    at = apply(system, at, *step);
  }
  return ordered;
}

// ---- runs ---------------------------------------------------------------------------------------

NodeRuns::NodeRuns(const System& system)
    : system_(system), rules_(system), state_(rules_.initial()), runs_(system.programs.size()) {}

// A look is there for its own sake in `order: rounds`. What it found is what is picked from then
// on.
void NodeRuns::restrict(const GlobalState& at, std::vector<Step>& steps) const {
  std::erase_if(steps, [&](const Step& step) {
    const auto callback = picked_for(system_, step);
    if (!callback) return false;
    const std::uint32_t executor = system_.callbacks[*callback].executor;
    const auto& picked = state_.picked[executor];
    if (!picked.empty()) return std::ranges::find(picked, *callback) == picked.end();
    ExecutorRules::State next = state_;
    return rules_.pick(next, executor, at, {&*callback, 1}) != callback;
  });
}

void NodeRuns::take(const GlobalState& at, const Step& step) {
  if (const auto callback = picked_for(system_, step)) {
    const std::uint32_t executor = system_.callbacks[*callback].executor;
    if (state_.picked[executor].empty()) rules_.pick(state_, executor, at, {&*callback, 1});
    if (started_by(system_, step)) {
      runs_[step.actor] = {*callback, rules_.start(state_, *callback)};
    } else {
      rules_.discard(state_, *callback);
    }
  } else if (is_end_of_callback(system_, step)) {
    rules_.end(state_, runs_[step.actor].first, runs_[step.actor].second);
  } else if (const auto found = found_by(system_, step); !found.empty()) {
    rules_.pick(state_, system_.callbacks[found.front()].executor, at, found);
  }
}

namespace {

class PriorityRuns {
 public:
  PriorityRuns(const System& system, const Property& property,
               const std::vector<std::uint32_t>& programs, std::uint64_t seed)
      : system_(system),
        part_(system, programs, &property),
        property_(part_.property(property)),
        random_(seed) {}

  // Nothing if the run does not violate the property, leaves what was learned, or costs too much.
  std::optional<Trace> draw(const RunControl& control) {
    std::vector<std::int64_t> priority(turns(system_));
    std::iota(priority.begin(), priority.end(), 0);
    random_.shuffle(priority);
    std::int64_t lowest = 0;
    // One step in so many loses its priority: in 4 where a run is short, in 256 where it is long.
    const std::uint64_t changes = std::uint64_t{4} << random_.below(7);
    NodeRuns nodes(system_);
    GlobalState at = initial_state(system_);
    Trace trace;
    std::map<Place, std::size_t> seen;
    for (std::size_t moves = 0; moves < most_moves && !is_over(control); ++moves, ++moves_) {
      const auto [place, is_new] =
          seen.try_emplace(Place{at.models, at.programs, nodes.state()}, trace.steps.size());
      if (!is_new) {
        trace.loop_start = place->second;
        if (violates(trace)) return trace;
        // Round and round: whoever went there comes last from now on.
        for (std::size_t step = place->second; step < trace.steps.size(); ++step) {
          priority[turn_of(system_, trace.steps[step])] = --lowest;
        }
        trace.steps.resize(place->second);
        trace.loop_start.reset();
        seen.clear();
        continue;
      }
      std::vector<Step> steps = steps_of_part(at);
      nodes.restrict(at, steps);
      if (steps.empty()) return violates(trace) ? std::optional(trace) : std::nullopt;
      const Step step = choose(steps, priority);
      if (random_.below(changes) == 0) priority[turn_of(system_, step)] = --lowest;
      nodes.take(at, step);
      at = apply(system_, at, step);
      trace.steps.push_back(step);
    }
    return std::nullopt;
  }

  // All runs together did what they may.
  bool is_over(const RunControl& control) const {
    return moves_ >= most_moves_of_all || control.should_stop();
  }

 private:
  // None behind an error: its component stops there. None beyond what was learned.
  std::vector<Step> steps_of_part(const GlobalState& at) const {
    std::vector<Step> steps;
    for (const std::uint32_t program : part_.programs()) {
      if (system_.programs[program].states[at.programs[program]].error != 0) return {};
      for (const Step& step : enabled_steps(system_, at, program)) {
        if (!step.is_beyond) steps.push_back(step);
      }
    }
    if (system_.nobodys_actions.empty()) return steps;
    for (const Step& step : enabled_steps(system_, at, nobody)) {
      if (!step.is_beyond && part_.has(step)) steps.push_back(step);
    }
    return steps;
  }

  using Place = std::tuple<std::vector<StateId>, std::vector<ControlState>, ExecutorRules::State>;
  static constexpr std::size_t most_moves = 5'000;  // of a run
  static constexpr std::size_t most_moves_of_all = 500'000;
  static constexpr std::size_t judged_for_a_move = 16;  // steps: each costs less

  Step choose(const std::vector<Step>& steps, const std::vector<std::int64_t>& priority) {
    std::int64_t highest = priority[turn_of(system_, steps.front())];
    for (const Step& step : steps) {
      highest = std::max(highest, priority[turn_of(system_, step)]);
    }
    std::vector<Step> best;
    for (const Step& step : steps) {
      if (priority[turn_of(system_, step)] == highest) best.push_back(step);
    }
    return best[random_.below(best.size())];
  }

  bool violates(const Trace& trace) {
    moves_ += trace.steps.size() / judged_for_a_move;
    return find_flaw(part_.system(), property_, from_whole(part_, trace)).empty();
  }

  const System& system_;
  const SystemPart part_;
  const Property property_;  // of the part
  Random random_;
  std::size_t moves_ = 0;  // of all runs so far
};

}  // namespace

std::optional<Trace> find_run_of_executors(const System& system, const Property& property,
                                           const std::vector<std::uint32_t>& programs,
                                           std::uint64_t seed, const RunControl& control) {
  constexpr std::size_t most_runs = 2'000, most_found = 10;
  // How often another program takes its turn, and how long it is.
  const auto length_of = [](const Trace& trace) {
    std::size_t turns = 0;
    for (std::size_t step = 1; step < trace.steps.size(); ++step) {
      turns += trace.steps[step].actor != trace.steps[step - 1].actor ? 1 : 0;
    }
    return std::pair(turns, trace.steps.size());
  };
  PriorityRuns runs(system, property, programs, seed);
  std::optional<Trace> shortest;
  std::size_t found = 0;
  for (std::size_t run = 0; run < most_runs && found < most_found; ++run) {
    if (runs.is_over(control)) break;
    std::optional<Trace> trace = runs.draw(control);
    if (!trace) continue;
    ++found;
    if (!shortest || length_of(*trace) < length_of(*shortest)) shortest = std::move(trace);
  }
  return shortest;
}

namespace {

// Of an error, the reason names what is wrong where the run ends.
void replace_run(const System& system, PropertyResult& result, Trace run) {
  const auto error_at_end = [&] {
    const Shown shown = shown_part(system, result);
    return describe_error(shown.part.system(), replay(shown.part.system(), shown.trace).back());
  };
  const bool is_error = find_property(system, result.name).kind == Property::Kind::error;
  const std::string before = is_error ? error_at_end() : "";
  result.trace = std::move(run);
  if (is_error && result.reason.starts_with(before)) {
    result.reason.replace(0, before.size(), error_at_end());
  }
}

}  // namespace

void prefer_runs_of_executors(const System& system, CheckReport& report,
                              const RunControl& control) {
  if (system.callbacks.empty()) return;
  const ExecutorRules rules(system);
  for (PropertyResult& result : report.properties) {
    if (!result.trace) continue;
    if (find_same_run(report, result) != nullptr) continue;
    if (order_for_executors(system, rules, *result.trace, control)) continue;
    constexpr std::uint64_t seed = 1;
    auto run = find_run_of_executors(system, find_property(system, result.name), result.programs,
                                     seed, control);
    if (run) {
      replace_run(system, result, std::move(*run));
      continue;
    }
    const std::string open = "The file leaves their order open, so this run counts";
    report.assumptions.push_back(
        control.should_stop()
            ? fmt::format("{}: whether executors pick the callbacks as in this run was not found "
                          "out, for the search ended early. {}",
                          result.name, open)
            : fmt::format("{}: no run was found in which executors pick the callbacks as rclcpp "
                          "Humble's do. {}, but a replay will not follow it",
                          result.name, open));
    report.doubts.push_back(report.assumptions.back());
  }
}

}  // namespace maide
