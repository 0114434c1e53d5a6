#include "maide/conformance/random_identifier_suite.hpp"

#include <fmt/format.h>

#include <utility>

#include "maide/conformance/separating_words.hpp"

namespace maide {

RandomIdentifierSuite::RandomIdentifierSuite(const Mealy& hypothesis, StateIdentifiers identifiers,
                                             InfixLaw law, Random random,
                                             std::span<const Word> counterexamples)
    : identifiers_(std::move(identifiers)),
      infixes_(hypothesis, law, counterexamples),
      random_(random),
      cover_(compute_state_cover(hypothesis)) {
  for (const Word& access : cover_) reached_.push_back(hypothesis.run(access));
}

bool RandomIdentifierSuite::next(Word& word) {
  const std::size_t start = random_.below(cover_.size());
  word.assign(cover_[start].begin(), cover_[start].end());
  StateId state = reached_[start];
  infixes_.draw(state, word, random_);
  const auto suffixes = identifiers_.of(state);
  const Word& suffix = suffixes[suffixes.size() == 1 ? 0 : random_.below(suffixes.size())];
  word.insert(word.end(), suffix.begin(), suffix.end());
  return true;
}

std::string describe_passed(std::uint64_t tests, const IdentifierMethod& method,
                            const InfixLaw& law) {
  return fmt::format("not refuted by {} random tests of {} with infixes of {:g} inputs on average",
                     tests, method.title, static_cast<double>(law.min) + law.mean);
}

RandomMethod::RandomMethod(OutputOracle& oracle, const IdentifierMethod& method,
                           RandomMethodOptions options)
    : oracle_(oracle), method_(method), options_(options), random_(options.seed) {
  check(options.infix);
}

std::optional<Word> RandomMethod::find_counterexample(const Mealy& hypothesis,
                                                      const RunControl& control) {
  StateIdentifiers identifiers = method_.compute(hypothesis, random_.split());
  RandomIdentifierSuite suite(hypothesis, std::move(identifiers), options_.infix, random_.split(),
                              counterexamples_);
  TestRunner runner(oracle_, {options_.max_tests, options_.batch_size});
  guarantee_ = "not tested to the end";
  std::optional<Word> counterexample = runner.run(suite, hypothesis, control);
  if (counterexample) {
    counterexamples_.push_back(*counterexample);
    guarantee_ = fmt::format("refuted by a random test of {}", method_.title);
  } else {
    guarantee_ = describe_passed(runner.last_tests(), method_, options_.infix);
  }
  return counterexample;
}

}  // namespace maide
