// Plays one query, step by step, on anything that can take one input at a time. It is the single
// place that knows what a step means: busy actors refuse, learning purposes bound, the canonical
// order of outputs, the queue and Delta of the av translation, the branches of a decision tree.
// Used by wrappers (behind the wire) and by simulated systems alike.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "maide/sul/learning_purpose.hpp"
#include "maide/sul/sul.hpp"

namespace maide {

// One instance of a system, freshly reset, that takes one input at a time.
class SteppedSystem {
 public:
  virtual ~SteppedSystem() = default;
  // The actor of this input is still in its last call.
  virtual bool is_busy(Symbol input) = 0;
  // What a step may end in besides its events.
  enum class Outcome : std::uint8_t { quiescent, crash, hang, aborted };
  // Gives the input, waits for quiescence, fills `step.events` (in any order between actors),
  // `step.busy`, `step.duration`, and, for simulated systems, `step.status`.
  virtual Outcome take(Symbol input, SulStep& step) = 0;
};

// Told of each step of a word that is over, before the next one begins.
using StepObserver = std::function<void(const SulStep& step)>;

// Plays `query` and returns its answer (reset_duration, attempts and reason are the caller's). A
// crash or a hang ends it there.
SulAnswer play(SteppedSystem& system, const SulQuery& query, const SulInfo& info,
               std::span<const LearningPurpose> purposes, const StepObserver& on_step = {});

}  // namespace maide
