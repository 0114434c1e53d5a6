#include "maide/conformance/random_identifier_suite.hpp"

#include <fmt/format.h>

#include <utility>

#include "maide/base/error.hpp"
#include "maide/conformance/separating_words.hpp"

namespace maide {

RandomIdentifierSuite::RandomIdentifierSuite(const Mealy& hypothesis, StateIdentifiers identifiers,
                                             InfixLaw law, Random random)
    : hypothesis_(hypothesis),
      identifiers_(std::move(identifiers)),
      law_(law),
      stop_probability_(1 / (law.mean + 1)),
      random_(random),
      cover_(compute_state_cover(hypothesis)) {
  for (const Word& access : cover_) reached_.push_back(hypothesis.run(access));
}

bool RandomIdentifierSuite::next(Word& word) {
  const std::size_t inputs = hypothesis_.inputs().size();
  const std::size_t start = random_.below(cover_.size());
  word.assign(cover_[start].begin(), cover_[start].end());
  StateId state = reached_[start];
  for (std::size_t length = 0; inputs > 0; ++length) {
    if (length >= law_.min && random_.chance(stop_probability_)) break;
    word.push_back(static_cast<Symbol>(random_.below(inputs)));
    state = hypothesis_.target(state, word.back());
  }
  const auto suffixes = identifiers_.of(state);
  const Word& suffix = suffixes[random_.below(suffixes.size())];
  word.insert(word.end(), suffix.begin(), suffix.end());
  return true;
}

RandomMethod::RandomMethod(OutputOracle& oracle, const IdentifierMethod& method,
                           RandomMethodOptions options)
    : runner_(oracle, {options.max_tests, options.batch_size}),
      method_(method),
      law_(options.infix),
      random_(options.seed) {
  if (!(law_.mean >= 0 && law_.mean <= 1e6)) {
    throw UsageError(fmt::format("{} is no mean length of an infix", law_.mean));
  }
}

std::optional<Word> RandomMethod::find_counterexample(const Mealy& hypothesis,
                                                      const RunControl& control) {
  StateIdentifiers identifiers = method_.compute(hypothesis, random_.split());
  RandomIdentifierSuite suite(hypothesis, std::move(identifiers), law_, random_.split());
  guarantee_ = "not tested to the end";
  std::optional<Word> counterexample = runner_.run(suite, hypothesis, control);
  guarantee_ = counterexample
                   ? fmt::format("refuted by a random test of {}", method_.title)
                   : fmt::format(
                         "not refuted by {} random tests of {} (infixes of {} and on average {:g} "
                         "more inputs)",
                         runner_.last_tests(), method_.title, law_.min, law_.mean);
  return counterexample;
}

}  // namespace maide
