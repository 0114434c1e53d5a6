// Runs of a system with nodes that rclcpp's executors may do: orders of a trace's steps, and random
// ones.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "maide/base/run_control.hpp"
#include "maide/check/system/trace.hpp"
#include "maide/check/verdict/check_system.hpp"
#include "maide/ros2/executor_rules.hpp"

namespace maide {

// ---- schedules ----
//
// A step as executors come to do it: before it, threads pick these callbacks, one after the other.
struct ScheduledStep {
  std::size_t step = 0;  // of the trace
  std::vector<std::uint32_t> picks;
};

// The steps `moves` of the trace, in that order, so that executors pick what they start. Threads
// pick as late as they can. If there is no such schedule, they pick at the last moment.
std::vector<ScheduledStep> schedule(const System& system, const ExecutorRules& rules,
                                    const Trace& trace, std::span<const std::size_t> moves);

// The steps of the trace in an order in which executors can do them: each program does its own, and
// they lead to the same state, and to the same one where a loop begins. A loop may come to be
// several rounds, behind which executors have found and picked the same again. None if the search,
// which begins with the trace's own order and ends after 200,000 states or when it is told to stop,
// finds none.
std::optional<Trace> order_for_executors(const System& system, const ExecutorRules& rules,
                                         const Trace& trace, const RunControl& control);

// ---- random runs ----
//
// Draws runs that rclcpp's executors may do: a callback starts only if they pick it.
class NodeRuns {
 public:
  // Keeps a reference.
  explicit NodeRuns(const System& system);
  // Leaves the steps that are possible.
  void restrict(const GlobalState& at, std::vector<Step>& steps) const;
  void take(const GlobalState& at, const Step& step);
  const ExecutorRules::State& state() const { return state_; }

 private:
  const System& system_;
  ExecutorRules rules_;
  ExecutorRules::State state_;
  std::vector<std::pair<std::uint32_t, std::size_t>> runs_;  // by program: callback and run
};

// A run that rclcpp's executors may do and that violates the property: of the first ten that are
// found among 2,000 runs or 500,000 steps (16 that are judged once more count as one), the one in
// which programs take turns most seldom. Of programs and wires the one with the highest of random
// priorities steps, and loses it now and then, and where all goes round (Burckhardt, Kothari,
// Musuvathi & Nagarakatte, A randomized scheduler with probabilistic guarantees of finding bugs,
// ASPLOS 2010). So each sort of burst and of delay comes up. The same seed gives the same run. Only
// these programs step; none: all do.
std::optional<Trace> find_run_of_executors(const System& system, const Property& property,
                                           const std::vector<std::uint32_t>& programs,
                                           std::uint64_t seed, const RunControl& control);

// A counterexample may need an order of callbacks that executors do not take. Then one that they do
// take is shown in its place. If none is found, a doubt says so.
void prefer_runs_of_executors(const System& system, CheckReport& report, const RunControl& control);

}  // namespace maide
