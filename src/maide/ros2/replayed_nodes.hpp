// The nodes of a system on running rclcpp nodes, for replay.hpp: the system `ros2 kind=nodes`
// (wrappers/ros2/held_graph.hpp). It stands for all topics and services at which a node has an end,
// with their programs, executors and callbacks.
//
// A callback is held at each of its calls until the run goes on. Which callback an executor picks
// is rclcpp's own decision. What is open is when a thread picks: the system's scheduler may let it
// do so as soon as something is there, or hold it up to the step at which its callback starts. A
// schedule (executor_runs.hpp) says when. If there is none, threads pick at the last moment, and
// what they pick is a deviation.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "maide/check/system/trace.hpp"
#include "maide/experiment/open_system.hpp"
#include "maide/ros2/executor_runs.hpp"

namespace maide {

class ReplayedNodes {
 public:
  // `topics`: of each topic the system that its models were learned from. Throws UsageError for
  // what cannot be played, with its place.
  ReplayedNodes(const System& system, const std::vector<SystemSpec>& topics);
  // Topics at which a node has an end.
  static bool has_node(const System& system, const TopicInstance& topic);
  // Nodes have ends there.
  static std::vector<std::uint32_t> find_models(const System& system);

  const std::vector<std::uint32_t>& models() const { return models_; }  // sorted
  bool contains(std::uint32_t model) const;
  const SystemSpec& spec() const { return spec_; }
  const ExecutorRules& rules() const { return rules_; }

  // What is asked in a step, and what the executors answer: "c0.1.start" and "c0.1.message".
  struct Call {
    std::string input;
    std::vector<std::string> expected;
  };
  struct Calls {
    std::vector<std::vector<Call>> moves;  // by step that is played
    std::vector<Call> end;                 // in a deadlock, what its programs wait for
  };
  // Of the steps `moves` of the trace, in that order; `last` is the state at its end.
  Calls plan(const Trace& trace, const GlobalState& last, std::span<const std::size_t> moves) const;

  // A program's output: the model, its name there, and whose it is.
  struct Output {
    std::uint32_t model = 0;
    std::size_t end = 0;
    std::string name;
  };
  std::optional<Output> output_of(const std::string& event) const;
  // An input or an event in words: "detector.on_image starts".
  std::string describe(const std::string& name) const;

 private:
  // Throws UsageError if something else runs over another one.
  void run_over(const std::string& rmw, const ModelInstance& model);
  class Describer;
  class Caller;
  // The call of a plain program ("n0."), or of a run of a callback ("c0.1.").
  std::string call_of(std::uint32_t program, const std::string& run, const ModelUse& use) const;

  const System& system_;
  ExecutorRules rules_;
  std::vector<std::uint32_t> models_;
  SystemSpec spec_;
  std::map<std::string, std::size_t> nodes_;     // by name; plain programs, too
  std::map<std::uint32_t, std::string> ends_;    // by model: "t0", "s1"
  std::map<std::string, Output> outputs_;        // of programs, by event
  std::map<std::string, std::string> meanings_;  // of parts of names: "t0" is "image"
};

}  // namespace maide
