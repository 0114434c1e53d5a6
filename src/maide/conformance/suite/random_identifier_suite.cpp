#include "maide/conformance/suite/random_identifier_suite.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <span>
#include <string>
#include <utility>

#include "maide/base/error.hpp"
#include "maide/base/text.hpp"
#include "maide/conformance/identify/separating_words.hpp"

namespace maide {

WeightedInputs::WeightedInputs(std::span<const double> weights, std::size_t input_count)
    : input_count_(input_count), slots_(weights.size()) {
  std::vector<double> share(input_count);  // of each slot's probability, those of its input
  std::vector<Symbol> small, large;
  for (std::size_t first = 0; first < weights.size(); first += input_count) {
    const std::span<const double> own = weights.subspan(first, input_count);
    const double scale =
        static_cast<double>(input_count) / std::accumulate(own.begin(), own.end(), 0.0);
    for (Symbol input = 0; input < input_count; ++input) {
      share[input] = own[input] * scale;
      (share[input] < 1 ? small : large).push_back(input);
    }
    Slot* const slots = &slots_[first];
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

Symbol WeightedInputs::draw(StateId state, Random& random) const {
  // The bias of a product of 32 bits is below k / 2^32.
  const std::uint64_t bits = random();
  const auto input = static_cast<Symbol>((bits >> 32) * input_count_ >> 32);
  const Slot& slot = slots_[state * input_count_ + input];
  return static_cast<std::uint32_t>(bits) < slot.threshold ? input : slot.other;
}

std::vector<double> compute_off_sink_weights(const Mealy& machine) {
  std::vector<double> leading(machine.size(), 0);  // transitions to each state
  for (StateId state = 0; state < machine.size(); ++state) {
    for (const Mealy::Cell& cell : machine.row(state)) ++leading[cell.target];
  }
  std::vector<double> weights;
  weights.reserve(machine.size() * machine.inputs().size());
  for (StateId state = 0; state < machine.size(); ++state) {
    for (const Mealy::Cell& cell : machine.row(state)) weights.push_back(1 / leading[cell.target]);
  }
  return weights;
}

std::vector<double> compute_off_loop_weights(const Mealy& machine) {
  // To each state: the states that lead there, and the transitions from the state at hand.
  std::vector<double> leading(machine.size(), 0), parallel(machine.size(), 0);
  const auto count_parallel = [&](StateId state) {
    for (const Mealy::Cell& cell : machine.row(state)) parallel[cell.target] = 0;
    for (const Mealy::Cell& cell : machine.row(state)) ++parallel[cell.target];
  };
  for (StateId state = 0; state < machine.size(); ++state) {
    count_parallel(state);
    for (const Mealy::Cell& cell : machine.row(state)) {
      leading[cell.target] += 1 / parallel[cell.target];
    }
  }
  std::vector<double> weights;
  weights.reserve(machine.size() * machine.inputs().size());
  for (StateId state = 0; state < machine.size(); ++state) {
    count_parallel(state);
    for (const Mealy::Cell& cell : machine.row(state)) {
      weights.push_back(1 / (leading[cell.target] * parallel[cell.target]));
    }
  }
  return weights;
}

InfixInputs find_infix_inputs(std::string_view name) {
  constexpr std::pair<std::string_view, InfixInputs> laws[] = {
      {"mixed", InfixInputs::mixed},         {"off-sinks", InfixInputs::off_sinks},
      {"off-loops", InfixInputs::off_loops}, {"few", InfixInputs::few},
      {"replayed", InfixInputs::replayed},   {"uniform", InfixInputs::uniform}};
  std::vector<std::string> names;
  for (const auto& [known, inputs] : laws) {
    if (known == name) return inputs;
    names.emplace_back(known);
  }
  throw unknown_name("law of infixes", name, names);
}

void check(const InfixLaw& law) {
  if (!(law.mean >= 0 && law.mean <= 1e6)) {
    throw UsageError(fmt::format("{} is no mean length of an infix", law.mean));
  }
  if (law.min > 1'000'000) {
    throw UsageError(fmt::format("an infix of at least {} inputs is too long", law.min));
  }
}

InfixSampler::InfixSampler(const Mealy& hypothesis, InfixLaw law,
                           std::span<const Word> counterexamples)
    : hypothesis_(hypothesis),
      law_(law),
      counterexamples_(counterexamples),
      log_going_on_(std::log(law.mean / (law.mean + 1))) {
  check(law);
  const std::size_t inputs = hypothesis.inputs().size();
  if (inputs == 0) return;
  const bool is_mixed = law.inputs == InfixInputs::mixed;
  if (is_mixed || law.inputs == InfixInputs::off_sinks || law.inputs == InfixInputs::replayed) {
    off_sinks_.emplace(compute_off_sink_weights(hypothesis), inputs);
  }
  if (is_mixed || law.inputs == InfixInputs::off_loops) {
    off_loops_.emplace(compute_off_loop_weights(hypothesis), inputs);
  }
}

std::size_t InfixSampler::draw_length(Random& random) const {
  if (law_.mean == 0) return law_.min;
  return law_.min + static_cast<std::size_t>(std::log(1 - random.unit()) / log_going_on_);
}

InfixInputs InfixSampler::draw_inputs(Random& random) const {
  constexpr std::array laws{InfixInputs::off_sinks, InfixInputs::off_loops, InfixInputs::few,
                            InfixInputs::replayed};
  const InfixInputs inputs =
      law_.inputs == InfixInputs::mixed ? laws[random.below(laws.size())] : law_.inputs;
  return inputs == InfixInputs::replayed && counterexamples_.empty() ? InfixInputs::off_sinks
                                                                     : inputs;
}

void InfixSampler::draw(StateId& state, Word& word, Random& random) const {
  const std::size_t inputs = hypothesis_.inputs().size();
  if (inputs == 0) return;
  const std::size_t length = draw_length(random);
  const auto append = [&](auto&& draw_input) {
    for (std::size_t i = 0; i < length; ++i) {
      word.push_back(draw_input());
      state = hypothesis_.target(state, word.back());
    }
  };
  switch (draw_inputs(random)) {
    case InfixInputs::mixed:
    case InfixInputs::off_sinks: return append([&] { return off_sinks_->draw(state, random); });
    case InfixInputs::off_loops: return append([&] { return off_loops_->draw(state, random); });
    case InfixInputs::uniform:
      return append([&] { return static_cast<Symbol>(random.below(inputs)); });
    case InfixInputs::few: {
      std::array<Symbol, 4> few{};
      const std::uint64_t count = 1 + random.below(few.size());
      for (Symbol& input : few) input = static_cast<Symbol>(random.below(inputs));
      return append([&] { return few[count == 1 ? 0 : random.below(count)]; });
    }
    case InfixInputs::replayed: {
      std::span<const Symbol> piece;
      return append([&] {
        if (piece.empty()) {
          const Word& whole = counterexamples_[random.below(counterexamples_.size())];
          piece = std::span(whole).subspan(random.below(whole.size()));
        }
        const Symbol input = piece.front();
        piece = piece.subspan(1);
        return input;
      });
    }
  }
}

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
  const auto known = identifiers_.of(state);
  const Word& suffix = known[known.size() == 1 ? 0 : random_.below(known.size())];
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
