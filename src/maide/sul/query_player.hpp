// Plays one query, step by step, on anything that can take one input at a time. Wrappers (behind
// the wire) and simulated systems both use it. Only this code knows what a step means: busy actors
// refuse, learning purposes bound, outputs have a canonical order, the av translation has a queue
// and Delta, and decision trees branch.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "maide/sul/learning_purpose.hpp"
#include "maide/sul/sul.hpp"

namespace maide {

// A walk through a query along the answers: which input is due next. The one place that knows how a
// decision tree branches; for a word the answers do not matter.
class QueryCursor {
 public:
  // Keeps a reference to `query`.
  explicit QueryCursor(const SulQuery& query) : query_(query) {}

  // The input to be given now; nothing at the end of the query.
  std::optional<Symbol> input() const;
  // That input was answered by `step`. Not after the end.
  void advance(const SulStep& step);

 private:
  const SulQuery& query_;
  std::size_t place_ = 0;  // in the word, or the tree's node
};

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
