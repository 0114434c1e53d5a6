#include "maide/conformance/random_identifier_suite.hpp"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "maide/base/error.hpp"
#include "maide/conformance/separating_words.hpp"

namespace maide {

namespace {

void check(const InfixLaw& law) {
  if (!(law.mean >= 0 && law.mean <= 1e6)) {
    throw UsageError(fmt::format("{} is no mean length of an infix", law.mean));
  }
  if (law.min > 1'000'000) {
    throw UsageError(fmt::format("an infix of at least {} inputs is too long", law.min));
  }
}

}  // namespace

InfixInputs find_infix_inputs(std::string_view name) {
  if (name == "off-sinks") return InfixInputs::off_sinks;
  if (name == "uniform") return InfixInputs::uniform;
  throw UsageError("the inputs of an infix are off-sinks or uniform, not '" + std::string(name) +
                   "'");
}

InfixSampler::InfixSampler(const Mealy& hypothesis, InfixInputs inputs)
    : input_count_(hypothesis.inputs().size()) {
  if (inputs == InfixInputs::uniform || input_count_ == 0) return;
  std::vector<double> leading(hypothesis.size(), 0);  // transitions to each state
  for (StateId state = 0; state < hypothesis.size(); ++state) {
    for (Symbol input = 0; input < input_count_; ++input) {
      ++leading[hypothesis.target(state, input)];
    }
  }
  slots_.resize(hypothesis.size() * input_count_);
  std::vector<double> share(input_count_);  // of each slot's probability, those of its input
  std::vector<Symbol> small, large;
  for (StateId state = 0; state < hypothesis.size(); ++state) {
    double sum = 0;
    for (Symbol input = 0; input < input_count_; ++input) {
      share[input] = 1 / leading[hypothesis.target(state, input)];
      sum += share[input];
    }
    for (Symbol input = 0; input < input_count_; ++input) {
      share[input] *= static_cast<double>(input_count_) / sum;
      (share[input] < 1 ? small : large).push_back(input);
    }
    Slot* const slots = &slots_[state * input_count_];
    while (!small.empty() && !large.empty()) {
      const Symbol poor = small.back(), rich = large.back();
      small.pop_back();
      slots[poor] = {static_cast<std::uint32_t>(share[poor] * 0x1p32), rich};
      share[rich] -= 1 - share[poor];
      if (share[rich] < 1) {
        large.pop_back();
        small.push_back(rich);
      }
    }
    for (std::vector<Symbol>* rest : {&small, &large}) {  // full, but for rounding
      for (const Symbol input : *rest) slots[input] = {0xffffffff, input};
      rest->clear();
    }
  }
}

Symbol InfixSampler::draw(StateId state, Random& random) const {
  // The bias of a product of 32 bits is below k / 2^32.
  const std::uint64_t bits = random();
  const auto input = static_cast<Symbol>((bits >> 32) * input_count_ >> 32);
  if (slots_.empty()) return input;
  const Slot& slot = slots_[state * input_count_ + input];
  return static_cast<std::uint32_t>(bits) < slot.threshold ? input : slot.other;
}

RandomIdentifierSuite::RandomIdentifierSuite(const Mealy& hypothesis, StateIdentifiers identifiers,
                                             InfixLaw law, Random random)
    : hypothesis_(hypothesis),
      identifiers_(std::move(identifiers)),
      law_(law),
      log_going_on_(std::log(law.mean / (law.mean + 1))),
      sampler_(hypothesis, law.inputs),
      random_(random),
      cover_(compute_state_cover(hypothesis)) {
  check(law);
  for (const Word& access : cover_) reached_.push_back(hypothesis.run(access));
}

std::size_t RandomIdentifierSuite::draw_length() {
  if (law_.mean == 0) return law_.min;
  return law_.min + static_cast<std::size_t>(std::log(1 - random_.unit()) / log_going_on_);
}

bool RandomIdentifierSuite::next(Word& word) {
  const std::size_t start = random_.below(cover_.size());
  word.assign(cover_[start].begin(), cover_[start].end());
  StateId state = reached_[start];
  if (!hypothesis_.inputs().empty()) {
    for (std::size_t left = draw_length(); left > 0; --left) {
      word.push_back(sampler_.draw(state, random_));
      state = hypothesis_.target(state, word.back());
    }
  }
  const auto suffixes = identifiers_.of(state);
  const Word& suffix = suffixes[suffixes.size() == 1 ? 0 : random_.below(suffixes.size())];
  word.insert(word.end(), suffix.begin(), suffix.end());
  return true;
}

RandomMethod::RandomMethod(OutputOracle& oracle, const IdentifierMethod& method,
                           RandomMethodOptions options)
    : runner_(oracle, {options.max_tests, options.batch_size}),
      method_(method),
      law_(options.infix),
      random_(options.seed) {
  check(law_);
}

std::optional<Word> RandomMethod::find_counterexample(const Mealy& hypothesis,
                                                      const RunControl& control) {
  StateIdentifiers identifiers = method_.compute(hypothesis, random_.split());
  RandomIdentifierSuite suite(hypothesis, std::move(identifiers), law_, random_.split());
  guarantee_ = "not tested to the end";
  std::optional<Word> counterexample = runner_.run(suite, hypothesis, control);
  guarantee_ =
      counterexample
          ? fmt::format("refuted by a random test of {}", method_.title)
          : fmt::format(
                "not refuted by {} random tests of {} with infixes of {:g} inputs "
                "on average",
                runner_.last_tests(), method_.title, static_cast<double>(law_.min) + law_.mean);
  return counterexample;
}

}  // namespace maide
