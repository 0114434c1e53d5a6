#include "maide/conformance/infix_sampler.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "maide/base/error.hpp"

namespace maide {

InfixInputs find_infix_inputs(std::string_view name) {
  constexpr std::pair<std::string_view, InfixInputs> laws[] = {
      {"mixed", InfixInputs::mixed},         {"off-sinks", InfixInputs::off_sinks},
      {"off-loops", InfixInputs::off_loops}, {"few", InfixInputs::few},
      {"replayed", InfixInputs::replayed},   {"uniform", InfixInputs::uniform}};
  for (const auto& [known, inputs] : laws) {
    if (known == name) return inputs;
  }
  throw UsageError(
      "the inputs of an infix are mixed, off-sinks, off-loops, few, replayed or uniform, not '" +
      std::string(name) + "'");
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

}  // namespace maide
