#include "maide/conformance/suite/random_identifier_suite.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <span>
#include <utility>

#include "maide/base/text.hpp"
#include "maide/conformance/identify/separating_words.hpp"

namespace maide {
namespace {

template <typename Law>
struct NamedLaw {
  std::string_view name;
  Law law;
};

constexpr std::array prefixes{NamedLaw<PrefixStates>{"uniform", PrefixStates::uniform},
                              NamedLaw<PrefixStates>{"deep", PrefixStates::deep},
                              NamedLaw<PrefixStates>{"transitions", PrefixStates::transitions}};
constexpr std::array suffixes{NamedLaw<SuffixWords>{"own", SuffixWords::own},
                              NamedLaw<SuffixWords>{"any", SuffixWords::any},
                              NamedLaw<SuffixWords>{"none", SuffixWords::none}};

}  // namespace

PrefixStates find_prefix_states(std::string_view name) {
  return find_row(std::span<const NamedLaw<PrefixStates>>(prefixes), "law of prefixes", name).law;
}

SuffixWords find_suffix_words(std::string_view name) {
  return find_row(std::span<const NamedLaw<SuffixWords>>(suffixes), "law of suffixes", name).law;
}

RandomIdentifierSuite::RandomIdentifierSuite(const Mealy& hypothesis, StateIdentifiers identifiers,
                                             InfixLaw law, Random random,
                                             std::span<const Word> counterexamples, TestEnds ends)
    : hypothesis_(hypothesis),
      identifiers_(std::move(identifiers)),
      infixes_(hypothesis, law, counterexamples),
      random_(random),
      ends_(ends),
      cover_(compute_state_cover(hypothesis)) {
  for (const Word& access : cover_) reached_.push_back(hypothesis.run(access));
}

bool RandomIdentifierSuite::next(Word& word) {
  StateId state = draw_prefix(word);
  infixes_.draw(state, word, random_);
  append_suffix(state, word);
  return true;
}

// The state where the word leads.
StateId RandomIdentifierSuite::draw_prefix(Word& word) {
  std::size_t start = random_.below(cover_.size());
  if (ends_.prefix == PrefixStates::deep) {
    start = std::max<std::size_t>(start, random_.below(cover_.size()));
  }
  word.assign(cover_[start].begin(), cover_[start].end());
  const std::size_t inputs = hypothesis_.inputs().size();
  if (ends_.prefix != PrefixStates::transitions || inputs == 0) return reached_[start];
  word.push_back(static_cast<Symbol>(random_.below(inputs)));
  return hypothesis_.target(reached_[start], word.back());
}

void RandomIdentifierSuite::append_suffix(StateId state, Word& word) {
  if (ends_.suffix == SuffixWords::none) return;
  if (ends_.suffix == SuffixWords::any) state = reached_[random_.below(reached_.size())];
  const auto suffixes = identifiers_.of(state);
  const Word& suffix = suffixes[suffixes.size() == 1 ? 0 : random_.below(suffixes.size())];
  word.insert(word.end(), suffix.begin(), suffix.end());
}

std::string describe_passed(std::uint64_t tests, const IdentifierMethod& method,
                            const InfixLaw& law, const TestEnds& ends) {
  const char* end = "";
  if (ends.suffix == SuffixWords::any) end = ", which end by words for any states";
  if (ends.suffix == SuffixWords::none) end = ", which identify nothing at their ends";
  return fmt::format(
      "not refuted by {} random tests of {} with infixes of {:g} inputs on average{}", tests,
      method.title, static_cast<double>(law.min) + law.mean, end);
}

RandomMethod::RandomMethod(OutputOracle& oracle, const IdentifierMethod& method,
                           RandomMethodOptions options)
    : SuiteMethod(oracle, {options.max_tests, options.batch_size}),
      method_(method),
      options_(options),
      random_(options.seed) {
  check(options.infix);
}

std::optional<Word> RandomMethod::find_counterexample(const Mealy& hypothesis,
                                                      const RunControl& control) {
  StateIdentifiers identifiers = method_.compute(hypothesis, random_.split());
  RandomIdentifierSuite suite(hypothesis, std::move(identifiers), options_.infix, random_.split(),
                              counterexamples_, options_.ends);
  std::optional<Word> counterexample = run(
      suite, hypothesis, control, fmt::format("a random test of {}", method_.title),
      [&](std::uint64_t tests) -> Passed {
        return {describe_passed(tests, method_, options_.infix, options_.ends), {.random = tests}};
      });
  if (counterexample) counterexamples_.push_back(*counterexample);
  return counterexample;
}

}  // namespace maide
