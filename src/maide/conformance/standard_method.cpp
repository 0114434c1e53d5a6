#include "maide/conformance/standard_method.hpp"

#include "maide/sul/ia_translation.hpp"

namespace maide {

StandardMethod::StandardMethod(OutputOracle& oracle, StandardMethodOptions options)
    : oracle_(oracle),
      options_(options),
      random_words_(oracle, {.max_tests = options.random_tests,
                             .seed = options.seed,
                             .batch_size = options.batch_size}),
      random_walk_(oracle, {.seed = options.seed, .batch_size = options.batch_size}) {}

std::optional<Word> StandardMethod::find_counterexample(const Mealy& hypothesis,
                                                        const RunControl& control) {
  const std::uint64_t budget =
      options_.max_tests.value_or(1000 + 50 * hypothesis.size() * hypothesis.inputs().size());
  WMethod w_method(oracle_, {options_.extra_states, {budget, options_.batch_size}});
  guarantee_ = "not tested to the end";
  std::optional<Word> counterexample = w_method.find_counterexample(hypothesis, control);
  guarantee_ = w_method.guarantee();
  if (!counterexample && options_.random_tests > 0) {
    counterexample = random_words_.find_counterexample(hypothesis, control);
    guarantee_ += "; " + random_words_.guarantee();
  }
  const bool takes_delta = hypothesis.inputs().find(delta_input).has_value();
  if (!counterexample && takes_delta && options_.random_tests > 0) {
    counterexample = random_walk_.find_counterexample(hypothesis, control);
    guarantee_ += "; " + random_walk_.guarantee();
  }
  return counterexample;
}

}  // namespace maide
