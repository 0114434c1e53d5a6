// The complete test suites of the W-method's family. A test is a word that reaches a state or
// transition of the hypothesis, then a word of up to k inputs, then a word that identifies the
// state reached. The last part makes the method: the same words for all states (W), harmonised ones
// (HSI, hybrid ADS), or few at the last level and the rest when a further level begins (Wp).
//
// Guarantee: with a state cover P such a suite finds every system that differs from a hypothesis of
// n states and has at most n + k. It finds more: every one whose states all lie within k inputs of
// those that the words of P reach (k-P-completeness: Vaandrager & Melse, "New fault domains for
// conformance testing of finite state machines", CONCUR 2025).
//
// Tests come by level, few extra states first. So differences that lie near are found early, and a
// suite that is cut off is complete for fewer extra states. Prefixes of other tests are left to the
// cache. Where outputs are known to end the session nothing comes behind them in a test.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "maide/automata/mealy.hpp"
#include "maide/conformance/identify/state_identifiers.hpp"
#include "maide/conformance/suite/test_suite.hpp"

namespace maide {

class IdentifierSuite : public TestSuite {
 public:
  // Keeps a reference to `hypothesis`, which must be complete; the identifiers must be its own.
  // `is_error`: of each output whether it ends the session; empty: none does.
  IdentifierSuite(const Mealy& hypothesis, StateIdentifiers identifiers, std::size_t extra_states,
                  std::vector<bool> is_error = {});

  bool next(Word& word) override;
  std::optional<std::uint64_t> size() const override { return volumes_.back().tests; }
  std::optional<std::uint64_t> symbols() const override { return volumes_.back().symbols; }

  // Extra states for which the tests made so far are complete; nothing if not even for none. O(1).
  std::optional<std::size_t> complete_for() const { return complete_for_; }
  // Tests that are complete for so many extra states, or for all of this suite: the first of it.
  // O(1).
  std::uint64_t size_up_to(std::size_t extra_states) const {
    return volumes_[std::min(extra_states, volumes_.size() - 1)].tests;
  }
  // The inputs of these tests. O(1).
  std::uint64_t symbols_up_to(std::size_t extra_states) const {
    return volumes_[std::min(extra_states, volumes_.size() - 1)].symbols;
  }

 private:
  struct Volume {
    std::uint64_t tests = 0, symbols = 0;
  };
  // The words of a level are followed by the identifiers; by the rest when the next level begins.
  enum class Pass : std::uint8_t { identifiers, rest };

  // A word of P, and an input behind it.
  struct Transition {
    std::uint32_t access;
    Symbol input;
  };

  // Words that reach a state: how many, and their lengths together.
  struct Reaching {
    std::uint64_t words = 0, length = 0;
  };

  void compute_transitions();
  void compute_volumes();
  bool passes_error(const Word& word) const;
  std::vector<Reaching> extend(const std::vector<Reaching>& reaching, Reaching& ended) const;
  bool ends_session(StateId state, Symbol input) const {
    return !is_error_.empty() && is_error_[hypothesis_.output(state, input)];
  }
  bool start_level();
  bool advance_access();
  void select_suffixes();
  std::size_t base_count() const { return level_ == 0 ? cover_.size() : transitions_.size(); }

  const Mealy& hypothesis_;
  StateIdentifiers identifiers_;
  std::size_t extra_states_;
  std::vector<bool> is_error_;           // by output, or empty
  std::vector<Word> cover_;              // P
  std::vector<StateId> reached_;         // by each word of P
  std::vector<Transition> transitions_;  // P.I \ P, but for what comes behind an error output
  std::vector<Volume> volumes_;          // up to each number of extra states, or to saturation
  // The test that comes next: a base, an infix, a suffix. Level 0 is P, level i is
  // (P.I \ P).I^(i-1).
  std::size_t level_ = 0, base_ = 0;
  Pass pass_ = Pass::identifiers;
  Word infix_;
  std::span<const Word> suffixes_;
  std::size_t suffix_ = 0;
  bool at_end_ = false;
  std::optional<std::size_t> complete_for_;
};

}  // namespace maide
