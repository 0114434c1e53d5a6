#include "maide/conformance/identifier_suite.hpp"

#include <limits>
#include <unordered_set>
#include <utility>

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

// Words that reach a state: how many, and their lengths together.
struct Reaching {
  std::uint64_t words = 0, length = 0;
};

std::vector<Reaching> count_reaching(const Mealy& machine, const std::vector<Word>& words) {
  std::vector<Reaching> reaching(machine.size());
  for (const Word& word : words) {
    Reaching& there = reaching[machine.run(word)];
    ++there.words;
    there.length += word.size();
  }
  return reaching;
}

// The same for words that go on with one more input.
std::vector<Reaching> extend(const Mealy& machine, const std::vector<Reaching>& reaching) {
  std::vector<Reaching> further(machine.size());
  for (StateId state = 0; state < machine.size(); ++state) {
    if (reaching[state].words == 0) continue;
    for (Symbol input = 0; input < machine.inputs().size(); ++input) {
      Reaching& there = further[machine.target(state, input)];
      there.words = add(there.words, reaching[state].words);
      there.length = add(there.length, add(reaching[state].length, reaching[state].words));
    }
  }
  return further;
}

}  // namespace

IdentifierSuite::IdentifierSuite(const Mealy& hypothesis, StateIdentifiers identifiers,
                                 std::size_t extra_states)
    : hypothesis_(hypothesis),
      identifiers_(std::move(identifiers)),
      extra_states_(extra_states),
      cover_(compute_state_cover(hypothesis)) {
  const std::unordered_set<Word, WordHash> states(cover_.begin(), cover_.end());
  for (const Word& access : cover_) {
    for (Symbol input = 0; input < hypothesis.inputs().size(); ++input) {
      Word word = access;
      word.push_back(input);
      if (!states.contains(word)) transitions_.push_back(std::move(word));
    }
  }
  volume_ = compute_volume(extra_states);
  select_suffixes();
}

IdentifierSuite::Volume IdentifierSuite::compute_volume(std::size_t extra_states) const {
  // Beyond so many levels, which only a machine with a single input can have, nobody counts.
  constexpr std::size_t most_levels = 1'000'000;
  Volume volume;
  const auto add_tests = [&](const std::vector<Reaching>& reaching, auto suffixes_of) {
    for (StateId state = 0; state < hypothesis_.size(); ++state) {
      for (const Word& suffix : suffixes_of(state)) {
        volume.tests = add(volume.tests, reaching[state].words);
        const std::uint64_t ends = multiply(reaching[state].words, suffix.size());
        volume.symbols = add(volume.symbols, add(reaching[state].length, ends));
      }
    }
  };
  const auto own = [&](StateId state) { return identifiers_.of(state); };
  const auto rest = [&](StateId state) { return identifiers_.rest_of(state); };
  std::vector<Reaching> reaching = count_reaching(hypothesis_, cover_);
  add_tests(reaching, own);
  if (transitions_.empty()) {
    add_tests(reaching, rest);
    return volume;
  }
  for (std::size_t level = 1;; ++level) {
    add_tests(reaching, rest);
    reaching =
        level == 1 ? count_reaching(hypothesis_, transitions_) : extend(hypothesis_, reaching);
    add_tests(reaching, own);
    if (volume.tests == saturated || level > most_levels) return {saturated, saturated};
    if (level > extra_states) return volume;
  }
}

bool IdentifierSuite::next(Word& word) {
  if (at_end_) return false;
  const Word& base = bases()[base_];
  const Word& suffix = suffixes_[suffix_];
  word.assign(base.begin(), base.end());
  word.insert(word.end(), infix_.begin(), infix_.end());
  word.insert(word.end(), suffix.begin(), suffix.end());
  if (++suffix_ < suffixes_.size()) return true;
  do {
    at_end_ = !advance_access();
  } while (!at_end_ && suffixes_.empty());
  return true;
}

// The fastest wheel is the infix, then the base, then the pass, then the level.
bool IdentifierSuite::advance_access() {
  bool carry = true;
  for (std::size_t i = infix_.size(); i > 0 && carry; --i) {
    carry = ++infix_[i - 1] == hypothesis_.inputs().size();
    if (carry) infix_[i - 1] = 0;
  }
  if (carry) {
    carry = ++base_ == bases().size();
    if (carry) base_ = 0;
  }
  if (carry && !start_level()) return false;
  select_suffixes();
  return true;
}

// What comes after all words of a pass.
bool IdentifierSuite::start_level() {
  if (pass_ == Pass::identifiers && level_ > 0) complete_for_ = level_ - 1;
  if (level_ > extra_states_) return false;
  if (pass_ == Pass::identifiers && identifiers_.has_rest()) {
    pass_ = Pass::rest;
    return true;
  }
  if (transitions_.empty()) {
    complete_for_ = extra_states_;
    return false;
  }
  pass_ = Pass::identifiers;
  infix_.assign(level_++, 0);
  return true;
}

void IdentifierSuite::select_suffixes() {
  const StateId state = hypothesis_.run(hypothesis_.run(bases()[base_]), infix_);
  suffixes_ = pass_ == Pass::rest ? identifiers_.rest_of(state) : identifiers_.of(state);
  suffix_ = 0;
}

}  // namespace maide
