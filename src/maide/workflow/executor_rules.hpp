// The rules by which rclcpp's executors pick callbacks, for who plays a system's nodes on real ones
// (replayed_nodes.hpp) or draws runs that real ones may do.
//
// A thread without a callback picks the first of what the last look found and whose group is free:
// timers, subscriptions, services, clients. Of a kind, callbacks come group by group. If nothing is
// left, it looks again, at what is ready and whose group is free.
//
// A client is ready when any answer is in its queue. Where that counts, with `order: rounds`, a
// client that was picked may discard answers to others, and runs nothing.
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "maide/base/run_control.hpp"
#include "maide/check/explore/check_system.hpp"
#include "maide/check/trace/trace.hpp"

namespace maide {

class ExecutorRules {
 public:
  struct State {
    std::vector<std::vector<std::uint32_t>> found;   // by executor: callbacks, in their order
    std::vector<std::vector<std::uint32_t>> picked;  // by executor: that have not started, sorted
    std::vector<std::vector<bool>> running;          // by callback, by run
    auto operator<=>(const State&) const = default;
  };

  // Keeps a reference. O(callbacks x edges).
  explicit ExecutorRules(const System& system);

  State initial() const;
  // The executor's callbacks' groups, in the order in which it looks through them; by their first
  // callbacks. Each is a list of callbacks, in the order of the file.
  const std::vector<std::vector<std::uint32_t>>& groups() const { return groups_; }
  std::size_t runs_of(std::uint32_t callback) const;

  // Something is there for it; of a timer never.
  bool is_ready(std::uint32_t callback, const GlobalState& at) const;
  // What a thread of the executor picks, when these timers are due; `state` then has it picked.
  // None: no thread is idle, or nothing is there.
  std::optional<std::uint32_t> pick(State& state, std::uint32_t executor, const GlobalState& at,
                                    std::span<const std::uint32_t> due) const;
  // A picked callback starts; its run.
  std::size_t start(State& state, std::uint32_t callback) const;
  void end(State& state, std::uint32_t callback, std::size_t run) const;
  // A picked client discards answers to others.
  void discard(State& state, std::uint32_t callback) const;

 private:
  bool is_busy(const State& state, std::size_t group) const;

  const System& system_;
  std::vector<std::vector<std::uint32_t>> groups_;
  std::vector<std::size_t> group_of_;        // by callback
  std::vector<std::uint32_t> order_;         // all callbacks, as executors look
  std::vector<std::vector<ModelUse>> ways_;  // by callback: by one of them it starts
};

// Which callback a step starts, ends or, of an executor that goes by rounds, finds, or whose client
// discards answers to others; of a step of another kind nothing.
std::optional<std::uint32_t> started_by(const System& system, const Step& step);
std::optional<std::uint32_t> discarded_by(const System& system, const Step& step);
// The one or the other: the step comes when the callback was picked.
std::optional<std::uint32_t> picked_for(const System& system, const Step& step);
bool is_end_of_callback(const System& system, const Step& step);
// By the state behind the step; empty unless it is a look.
std::vector<std::uint32_t> found_by(const System& system, const Step& step);

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
// they lead to the same state, and to the same one where a loop begins. None if the search, which
// begins with the trace's own order and ends after 200,000 states or when it is told to stop, finds
// none.
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
// found among 2,000 runs or 500,000 steps, the one in which programs take turns most seldom. The
// program with the highest of random priorities steps, and loses it now and then, and where all
// goes round (Burckhardt, Kothari, Musuvathi & Nagarakatte, A randomized scheduler with
// probabilistic guarantees of finding bugs, ASPLOS 2010). So each sort of burst and of delay comes
// up. The same seed gives the same run. Only these programs step; none: all do.
std::optional<Trace> find_run_of_executors(const System& system, const Property& property,
                                           const std::vector<std::uint32_t>& programs,
                                           std::uint64_t seed, const RunControl& control);

// A counterexample may need an order of callbacks that executors do not take. Then one that they do
// take is shown in its place. If none is found, a doubt says so.
void prefer_runs_of_executors(const System& system, CheckReport& report, const RunControl& control);

}  // namespace maide
