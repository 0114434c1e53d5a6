#include "maide/conformance/standard_method.hpp"

#include <algorithm>

#include "maide/sul/ia_translation.hpp"

namespace maide {

StandardMethod::StandardMethod(OutputOracle& oracle, StandardMethodOptions options)
    : oracle_(oracle),
      options_(options),
      random_tests_(oracle, hads_identifiers,
                    {.seed = options.seed, .batch_size = options.batch_size}),
      random_walk_(oracle, {.seed = options.seed, .batch_size = options.batch_size}) {}

StandardMethod::Plan StandardMethod::make_plan(const IdentifierSuite& suite,
                                               const Mealy& hypothesis) const {
  const std::uint64_t budget =
      options_.max_tests.value_or(1000 + 50 * hypothesis.size() * hypothesis.inputs().size());
  // Within a limit that was given, random tests come out of what is left of it.
  const auto at_least = [&](std::uint64_t spent) {
    return options_.max_tests ? std::min(options_.random_tests, budget - spent)
                              : options_.random_tests;
  };
  if (*suite.size() <= budget) return {*suite.size(), at_least(*suite.size()), 0};
  const std::uint64_t before = std::min(suite.size_up_to(0), budget);
  std::uint64_t all = before;
  for (std::size_t extra = 1; extra <= options_.extra_states; ++extra) {
    const std::uint64_t deeper = suite.size_up_to(extra);
    if (deeper > budget / 2) break;
    all = deeper;
  }
  return {before, std::max(at_least(all), budget - all), all - before};
}

std::optional<Word> StandardMethod::find_counterexample(const Mealy& hypothesis,
                                                        const RunControl& control) {
  guarantee_ = "not tested to the end";
  IdentifierSuite suite(hypothesis, hads_identifiers.compute(hypothesis, Random(options_.seed)),
                        options_.extra_states);
  const Plan plan = make_plan(suite, hypothesis);
  const auto run_suite = [&](std::uint64_t tests) {
    TestRunner runner(oracle_, {tests, options_.batch_size});
    auto found = runner.run(suite, hypothesis, control);
    if (found) random_tests_.add_counterexample(*found);
    return found;
  };
  std::optional<Word> counterexample = run_suite(plan.suite_before);
  random_tests_.set_max_tests(plan.random);
  if (!counterexample) counterexample = random_tests_.find_counterexample(hypothesis, control);
  if (!counterexample) counterexample = run_suite(plan.suite_after);
  if (counterexample) {
    guarantee_ = "refuted by a test";
    return counterexample;
  }
  guarantee_ =
      describe_passed(suite, plan.suite_before + plan.suite_after, hads_identifiers, hypothesis) +
      "; " + random_tests_.guarantee();
  if (hypothesis.inputs().find(delta_input).has_value()) {
    counterexample = random_walk_.find_counterexample(hypothesis, control);
    guarantee_ += "; " + random_walk_.guarantee();
  }
  return counterexample;
}

}  // namespace maide
