#include "maide/conformance/random_walk.hpp"

#include <fmt/format.h>

#include "maide/base/error.hpp"

namespace maide {

bool RandomWalkSuite::next(Word& word) {
  word.clear();
  while (steps_left_ > 0 && word.size() < max_length_) {
    word.push_back(static_cast<Symbol>(random_.below(inputs_)));
    --steps_left_;
    if (random_.chance(restart_probability_)) break;
  }
  return !word.empty();
}

RandomWalk::RandomWalk(OutputOracle& oracle, RandomWalkOptions options)
    : runner_(oracle, {options.max_tests, options.batch_size}),
      options_(options),
      random_(options.seed) {
  if (!(options.restart_probability >= 0 && options.restart_probability <= 1)) {
    throw UsageError(fmt::format("the restart probability {} is not between 0 and 1",
                                 options.restart_probability));
  }
  if (options.max_length == 0) throw UsageError("a random walk needs a length of at least 1");
}

std::optional<Word> RandomWalk::find_counterexample(const Mealy& hypothesis,
                                                    const RunControl& control) {
  RandomWalkSuite suite(hypothesis.inputs().size(), options_.restart_probability,
                        options_.max_length, options_.max_steps, random_.split());
  guarantee_ = "not tested to the end";
  strength_ = {};
  std::optional<Word> counterexample = runner_.run(suite, hypothesis, control);
  guarantee_ = counterexample
                   ? "refuted by a random walk"
                   : fmt::format("not refuted by a random walk of at most {} steps, {} restarts",
                                 options_.max_steps, runner_.last_tests());
  if (!counterexample) strength_.random = runner_.last_tests();
  return counterexample;
}

}  // namespace maide
