#include "maide/conformance/standard_method.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "maide/base/log.hpp"
#include "maide/conformance/alternating_suite.hpp"
#include "maide/conformance/complete_method.hpp"
#include "maide/conformance/random_identifier_suite.hpp"
#include "maide/conformance/test_runner.hpp"
#include "maide/sul/ia_translation.hpp"

namespace maide {

StandardMethod::StandardMethod(OutputOracle& oracle, StandardMethodOptions options)
    : oracle_(oracle),
      options_(options),
      random_(options.seed),
      random_walk_(oracle, {.seed = options.seed, .batch_size = options.batch_size}) {}

StandardMethod::Budget StandardMethod::make_budget(const IdentifierSuite& suite,
                                                   const Mealy& hypothesis) const {
  const std::uint64_t all =
      options_.max_tests.value_or(1000 + 50 * hypothesis.size() * hypothesis.inputs().size());
  // Within a limit that was given, random tests come out of what is left of it.
  const auto at_least = [&](std::uint64_t complete) {
    return options_.max_tests ? std::min(options_.random_tests, all - complete)
                              : options_.random_tests;
  };
  if (*suite.size() <= all) return {*suite.size(), at_least(*suite.size())};
  std::uint64_t complete = suite.size_up_to(0) <= all ? suite.size_up_to(0) : all / 2;
  for (std::size_t extra = 1; extra <= options_.extra_states && suite.size_up_to(extra) <= all / 2;
       ++extra) {
    complete = suite.size_up_to(extra);
  }
  return {complete, std::max(at_least(complete), all - complete)};
}

std::optional<Word> StandardMethod::find_counterexample(const Mealy& hypothesis,
                                                        const RunControl& control) {
  guarantee_ = "not tested to the end";
  const StateIdentifiers identifiers = hads_identifiers.compute(hypothesis, Random(options_.seed));
  IdentifierSuite complete_tests(hypothesis, identifiers, options_.extra_states);
  const InfixLaw law;
  RandomIdentifierSuite random_tests(hypothesis, identifiers, law, random_.split(),
                                     counterexamples_);
  const Budget budget = make_budget(complete_tests, hypothesis);
  AlternatingSuite tests({random_tests, budget.random}, {complete_tests, budget.complete},
                         hypothesis.size() * hypothesis.inputs().size());
  log_detail(fmt::format("{} random tests and {} of hybrid ADS, for {} states", budget.random,
                         budget.complete, hypothesis.size()));
  TestRunner runner(oracle_, {.batch_size = options_.batch_size});
  std::optional<Word> counterexample = runner.run(tests, hypothesis, control);
  if (counterexample) {
    counterexamples_.push_back(*counterexample);
    guarantee_ = "refuted by a test";
    return counterexample;
  }
  guarantee_ =
      describe_passed(complete_tests, tests.made_of_second(), hads_identifiers, hypothesis) + "; " +
      describe_passed(tests.made_of_first(), hads_identifiers, law);
  if (hypothesis.inputs().find(delta_input).has_value()) {
    counterexample = random_walk_.find_counterexample(hypothesis, control);
    if (counterexample) counterexamples_.push_back(*counterexample);
    guarantee_ += "; " + random_walk_.guarantee();
  }
  return counterexample;
}

}  // namespace maide
