// What is asked of real systems in a replay (replay.hpp): which system stands behind which models,
// and the word that each gets. A topic is one system with all its ends; its models are its
// readers'.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "maide/check/system/trace.hpp"
#include "maide/join/real_system.hpp"

namespace maide {

using RealSystems = std::vector<std::unique_ptr<RealSystem>>;

// A model and the real system that is asked for it.
struct Seat {
  std::uint32_t host = 0;                // the model at which that system stands
  const TopicInstance* topic = nullptr;  // that the model is a reader's of
  std::size_t reader = 0;                // which
  const ReplayedNodes* nodes = nullptr;  // whose connection it is
};

// Keeps references.
class Stage {
 public:
  Stage(const System& system, const RealSystems& real);

  const Seat& seat(std::uint32_t model) const { return seats_[model]; }
  const RealSystem* real(std::uint32_t model) const { return real_[seats_[model].host].get(); }
  // The models that the system at `host` stands for.
  std::vector<std::uint32_t> models_of(std::uint32_t host) const;
  // An input or output of a topic's writers, which all readers' models have.
  bool is_of_writers(const ModelUse& event) const;
  // Which of a topic's writers the program is.
  static std::size_t writer_of(const TopicInstance& topic, std::uint32_t program);
  // The system's input for an input that the program gives to the model. Throws UsageError.
  Symbol input_of(std::uint32_t program, const ModelUse& event) const;
  // The model at which the system stands that plays nodes; none: nobody does.
  std::optional<std::uint32_t> host_of_nodes() const { return host_of_nodes_; }
  // What of a step concerns real systems but the one of nodes: of a topic's writer one event, for
  // all readers' models.
  std::vector<ModelUse> real_events(const Step& step) const;

 private:
  const System& system_;
  const RealSystems& real_;
  std::vector<Seat> seats_;  // by model
  std::optional<std::uint32_t> host_of_nodes_;
};

// A step of the trace as it is played.
struct Move {
  std::size_t step = 0, round = 0;
};

// A call with which a program that is in a deadlock cannot go on.
struct Probe {
  std::uint32_t program = 0, model = 0;
  Symbol input = 0;                // of the model
  std::vector<StateId> reachable;  // where the model may be then; none: it does not take the call
};

// The outputs that are due in a state, in the canonical order: "message,written", or "quiet".
std::string describe_due(const InterfaceAutomaton& automaton, StateId state);

// What is played of one trace.
struct Plan {
  std::vector<Move> moves;
  std::vector<Step> steps;          // by move
  std::vector<GlobalState> states;  // before each move, and behind the last
  std::vector<Probe> probes;
  std::vector<Word> words;     // by host, in its system's inputs; the probes last
  ReplayedNodes::Calls nodes;  // by move; what is at their host, which has no probes
};

// The loop of a lasso is played `loops` times. Throws UsageError for a run with steps of nobody: no
// real system can be asked for them. O(steps of the trace x loops).
Plan make_plan(const System& system, const Stage& stage, const Trace& trace, std::size_t loops);

// ---- What no real system is asked ----

// What a run leaves open because no real system can answer it, in words: calls that were never
// tried and that `when_unexplored` decides, and an output that no program takes.
std::vector<std::string> find_assumptions(const System& system, const Trace& trace);

// The models that runs meet, in their steps or by what a program waits for in the end, and that
// stand for no real system. Maide holds shared variables, mutexes and semaphores itself: they
// belong to the programs. A queue that is written by hand stands for a connection that nobody asks.
struct Unplayed {
  bool is_all = false;              // they meet no other models, so there is nothing real to ask
  std::vector<std::string> models;  // a line for those of a kind; of queues alone unless `is_all`
};
// `nodes`: what is played with nodes is real. O(steps x programs x edges).
Unplayed find_unplayed(const System& system, std::span<const Trace> traces,
                       const ReplayedNodes* nodes = nullptr);

// Callbacks of nodes are run in the traces, or waited for in the end.
bool meet_nodes(const System& system, std::span<const Trace> traces);

// Whether the programs are in a deadlock at the end of the trace.
bool ends_in_deadlock(const System& system, const Trace& trace);

}  // namespace maide
