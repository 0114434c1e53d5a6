#include "maide/conformance/suite/identifier_suite.hpp"

#include <algorithm>
#include <span>
#include <utility>

#include "maide/base/numbers.hpp"
#include "maide/conformance/identify/separating_words.hpp"

namespace maide {
IdentifierSuite::IdentifierSuite(const Mealy& hypothesis, StateIdentifiers identifiers,
                                 std::size_t extra_states, std::vector<bool> is_error)
    : hypothesis_(hypothesis),
      identifiers_(std::move(identifiers)),
      extra_states_(extra_states),
      is_error_(std::move(is_error)),
      cover_(compute_state_cover(hypothesis)) {
  for (const Word& access : cover_) reached_.push_back(hypothesis.run(access));
  compute_transitions();
  compute_volumes();
  select_suffixes();
}

// P has one word for each state: with one more input it is in P if that is the next state's.
void IdentifierSuite::compute_transitions() {
  std::vector<const Word*> access_of(hypothesis_.size());
  for (std::size_t i = 0; i < cover_.size(); ++i) access_of[reached_[i]] = &cover_[i];
  for (std::uint32_t i = 0; i < cover_.size(); ++i) {
    if (passes_error(cover_[i])) continue;
    for (Symbol input = 0; input < hypothesis_.inputs().size(); ++input) {
      const Word& next = *access_of[hypothesis_.target(reached_[i], input)];
      const bool is_access = next.size() == cover_[i].size() + 1 && next.back() == input &&
                             std::equal(cover_[i].begin(), cover_[i].end(), next.begin());
      if (!is_access) transitions_.push_back({i, input});
    }
  }
}

bool IdentifierSuite::passes_error(const Word& word) const {
  StateId state = hypothesis_.initial();
  for (const Symbol input : word) {
    if (ends_session(state, input)) return true;
    state = hypothesis_.target(state, input);
  }
  return false;
}

// Of words that go on with one more input; `ended` counts those that end the session by it.
std::vector<IdentifierSuite::Reaching> IdentifierSuite::extend(
    const std::vector<Reaching>& reaching, Reaching& ended) const {
  std::vector<Reaching> further(hypothesis_.size());
  for (StateId state = 0; state < hypothesis_.size(); ++state) {
    if (reaching[state].words == 0) continue;
    for (Symbol input = 0; input < hypothesis_.inputs().size(); ++input) {
      Reaching& there =
          ends_session(state, input) ? ended : further[hypothesis_.target(state, input)];
      there.words = saturating_sum(there.words, reaching[state].words);
      there.length = saturating_sum(there.length,
                                    saturating_sum(reaching[state].length, reaching[state].words));
    }
  }
  return further;
}

void IdentifierSuite::compute_volumes() {
  // Beyond so many levels, which only a machine with a single input can have, nobody counts.
  constexpr std::size_t most_levels = 1'000'000;
  Volume volume;
  const auto add_tests = [&](const std::vector<Reaching>& reaching, auto suffixes_of) {
    for (StateId state = 0; state < hypothesis_.size(); ++state) {
      for (const Word& suffix : suffixes_of(state)) {
        volume.tests = saturating_sum(volume.tests, reaching[state].words);
        const std::uint64_t ends = saturating_product(reaching[state].words, suffix.size());
        volume.symbols =
            saturating_sum(volume.symbols, saturating_sum(reaching[state].length, ends));
      }
    }
  };
  const auto own = [&](StateId state) { return identifiers_.of(state); };
  const auto rest = [&](StateId state) { return identifiers_.rest_of(state); };
  std::vector<Reaching> reaching(hypothesis_.size());
  for (std::size_t i = 0; i < cover_.size(); ++i) reaching[reached_[i]] = {1, cover_[i].size()};
  add_tests(reaching, own);
  if (transitions_.empty()) {
    add_tests(reaching, rest);
    volumes_ = {volume};
    return;
  }
  for (std::size_t level = 1; level - 1 <= extra_states_; ++level) {
    add_tests(reaching, rest);
    Reaching ended;
    if (level == 1) {
      reaching.assign(hypothesis_.size(), {});
      for (const auto& [access, input] : transitions_) {
        Reaching& there = ends_session(reached_[access], input)
                              ? ended
                              : reaching[hypothesis_.target(reached_[access], input)];
        ++there.words;
        there.length += cover_[access].size() + 1;
      }
    } else {
      reaching = extend(reaching, ended);
    }
    add_tests(reaching, own);
    volume.tests = saturating_sum(volume.tests, ended.words);
    volume.symbols = saturating_sum(volume.symbols, ended.length);
    const bool is_countable = volume.tests != saturated && level <= most_levels;
    volumes_.push_back(is_countable ? volume : Volume{saturated, saturated});
    if (!is_countable) return;
  }
}

bool IdentifierSuite::next(Word& word) {
  if (at_end_) return false;
  if (level_ == 0) {
    word.assign(cover_[base_].begin(), cover_[base_].end());
  } else {
    const auto& [access, input] = transitions_[base_];
    word.assign(cover_[access].begin(), cover_[access].end());
    word.push_back(input);
  }
  const Word& suffix = suffixes_[suffix_];
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
    carry = ++base_ == base_count();
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

// Nothing comes behind an input that ends the session; words that go on there are passed over.
void IdentifierSuite::select_suffixes() {
  static const std::vector<Word> nothing{Word{}};
  suffix_ = 0;
  StateId state;
  if (level_ == 0) {
    state = reached_[base_];
  } else {
    const auto& [access, input] = transitions_[base_];
    bool is_over = ends_session(reached_[access], input);
    state = hypothesis_.target(reached_[access], input);
    std::size_t place = 0;
    for (; place < infix_.size() && !is_over; ++place) {
      is_over = ends_session(state, infix_[place]);
      state = hypothesis_.target(state, infix_[place]);
    }
    if (is_over) {
      const bool is_all = place == infix_.size() && pass_ == Pass::identifiers;
      suffixes_ = is_all ? std::span<const Word>(nothing) : std::span<const Word>();
      const auto last = static_cast<Symbol>(hypothesis_.inputs().size() - 1);
      std::fill(infix_.begin() + static_cast<std::ptrdiff_t>(place), infix_.end(), last);
      return;
    }
  }
  suffixes_ = pass_ == Pass::rest ? identifiers_.rest_of(state) : identifiers_.of(state);
}

}  // namespace maide
