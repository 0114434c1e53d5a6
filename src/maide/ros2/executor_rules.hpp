// The rules by which rclcpp's executors pick callbacks, for who plays a system's nodes on real ones
// (replayed_nodes.hpp) or looks for runs that real ones may do (executor_runs.hpp).
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
#include <vector>

#include "maide/check/system/trace.hpp"

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
  // A look may have found it, but it has nothing to take any more.
  bool is_gone(std::uint32_t callback, const GlobalState& at,
               std::span<const std::uint32_t> due) const;

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

}  // namespace maide
