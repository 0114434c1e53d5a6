// What is asked of real systems in a replay (replay.hpp): which system stands behind which models,
// and the word that each gets. A topic is one system with all its ends; its models are its
// readers'.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "maide/check/trace/trace.hpp"
#include "maide/workflow/real_system.hpp"

namespace maide {

using RealSystems = std::vector<std::unique_ptr<RealSystem>>;

inline const ProgramEdge& edge_of(const System& system, const Step& step) {
  return system.programs[step.program].edges[step.edge];
}
inline std::span<const ModelUse> events_of(const System& system, const Step& step) {
  return system.programs[step.program].events_of(edge_of(system, step));
}

// A model and the real system that is asked for it.
struct Seat {
  std::uint32_t host = 0;                // the model at which that system stands
  const TopicInstance* topic = nullptr;  // that the model is a reader's of
  std::size_t reader = 0;                // which
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
  // What of a step concerns real systems: of a topic's writer one event, for all readers' models.
  std::vector<ModelUse> real_events(const Step& step) const;

 private:
  const System& system_;
  const RealSystems& real_;
  std::vector<Seat> seats_;  // by model
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

// What is played of one trace.
struct Plan {
  std::vector<GlobalState> states;  // along the trace
  std::vector<Move> moves;
  std::vector<Probe> probes;
  std::vector<Word> words;  // by host, in its system's inputs; the probes last
};

// The loop of a lasso is played `loops` times. O(steps of the trace x loops).
Plan make_plan(const System& system, const Stage& stage, const Trace& trace, std::size_t loops);

}  // namespace maide
