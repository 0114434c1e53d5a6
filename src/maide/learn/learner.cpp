#include "maide/learn/learner.hpp"

#include <utility>

#include "maide/automata/minimize.hpp"

namespace maide {

LearnResult run_learner(Learner& learner, EquivalenceOracle& teacher, const RunControl& control,
                        const HypothesisObserver& observer) {
  LearnResult result;
  learner.start(control);
  while (true) {
    ++result.equivalence_queries;
    if (observer) observer(learner.hypothesis(), result.equivalence_queries);
    const auto counterexample = teacher.find_counterexample(learner.hypothesis(), control);
    if (!counterexample) break;
    learner.refine(*counterexample, control);
  }
  result.model = breadth_first(learner.hypothesis());
  return result;
}

Mealy learn(Learner& learner, EquivalenceOracle& teacher) {
  return std::move(run_learner(learner, teacher).model);
}

}  // namespace maide
