#include "maide/conformance/w_method.hpp"

#include <fmt/format.h>

#include <limits>
#include <unordered_set>

#include "maide/conformance/separating_words.hpp"

namespace maide {
namespace {

constexpr std::uint64_t saturated = std::numeric_limits<std::uint64_t>::max();

std::uint64_t multiply(std::uint64_t left, std::uint64_t right) {
  std::uint64_t result = 0;
  return __builtin_mul_overflow(left, right, &result) ? saturated : result;
}

std::uint64_t add(std::uint64_t left, std::uint64_t right) {
  std::uint64_t result = 0;
  return __builtin_add_overflow(left, right, &result) ? saturated : result;
}

}  // namespace

WSuite::WSuite(const Mealy& hypothesis, std::size_t extra_states)
    : inputs_(hypothesis.inputs().size()),
      extra_states_(extra_states),
      cover_(compute_state_cover(hypothesis)) {
  const SeparatingWords separating(hypothesis);
  characterising_ = compute_characterising_set(hypothesis, separating);
  if (characterising_.empty()) characterising_.emplace_back();
  const std::unordered_set<Word, WordHash> states(cover_.begin(), cover_.end());
  std::unordered_set<std::uint32_t> classes;
  for (const Word& access : cover_) {
    classes.insert(separating.class_of(hypothesis.run(access)));
    for (Symbol input = 0; input < inputs_; ++input) {
      Word word = access;
      word.push_back(input);
      if (!states.contains(word)) transitions_.push_back(std::move(word));
    }
  }
  class_count_ = classes.size();
}

std::uint64_t WSuite::size_up_to(std::size_t extra_states) const {
  std::uint64_t total = cover_.size();
  std::uint64_t level = transitions_.size();
  if (inputs_ == 1) {  // every level has as many
    return multiply(add(total, multiply(level, add(extra_states, 1))), characterising_.size());
  }
  for (std::size_t i = 0; i <= extra_states && level != 0; ++i) {
    total = add(total, level);
    if (total == saturated) break;
    level = multiply(level, inputs_);
  }
  return multiply(total, characterising_.size());
}

bool WSuite::next(Word& word) {
  if (at_end_) return false;
  const Word& base = level_ == 0 ? cover_[base_] : transitions_[base_];
  const Word& suffix = characterising_[suffix_];
  word.assign(base.begin(), base.end());
  word.insert(word.end(), infix_.begin(), infix_.end());
  word.insert(word.end(), suffix.begin(), suffix.end());
  at_end_ = !advance();
  return true;
}

// The fastest wheel is the characterising word, then the infix, then the base, then the level.
bool WSuite::advance() {
  if (++suffix_ < characterising_.size()) return true;
  suffix_ = 0;
  for (std::size_t i = infix_.size(); i > 0; --i) {
    if (++infix_[i - 1] < inputs_) return true;
    infix_[i - 1] = 0;
  }
  if (++base_ < (level_ == 0 ? cover_ : transitions_).size()) return true;
  base_ = 0;
  if (level_++ > extra_states_ || transitions_.empty()) return false;
  infix_.assign(level_ - 1, 0);
  return true;
}

std::optional<Word> WMethod::find_counterexample(const Mealy& hypothesis,
                                                 const RunControl& control) {
  WSuite suite(hypothesis, options_.extra_states);
  guarantee_ = "not tested to the end";
  std::optional<Word> counterexample = runner_.run(suite, hypothesis, control);
  if (counterexample) {
    guarantee_ = "refuted by the W-method";
    return counterexample;
  }
  const std::uint64_t tests = runner_.last_tests();
  guarantee_ = fmt::format("not refuted by {} tests of the W-method", tests);
  std::optional<std::size_t> complete_for;
  // The sizes grow, or there is nothing to test.
  for (std::size_t extra = 0; extra <= options_.extra_states; ++extra) {
    if (suite.size_up_to(extra) > tests) break;
    complete_for = extra;
    if (extra == tests) break;
  }
  if (complete_for) {
    guarantee_ +=
        fmt::format(": no other machine of at most {} states ({} + {} extra) passes them",
                    suite.class_count() + *complete_for, suite.class_count(), *complete_for);
  } else {
    guarantee_ +=
        fmt::format(", cut off before the {} that would exclude other machines of {} states",
                    suite.size_up_to(0), suite.class_count());
  }
  return counterexample;
}

}  // namespace maide
