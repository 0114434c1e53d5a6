// The W-method (Vasilevskii, "Failure diagnosis of automata", 1973; Chow, "Testing software design
// modeled by finite-state machines", 1978). With a state cover P, a characterising set W and k
// extra states the suite is P.W and (P.I \ P).I^{<=k}.W: if the system has at most k states more
// than the hypothesis has, and differs from it, then some test shows it.
//
// Tests come by level, few extra states first, so counterexamples that lie near come early and a
// suite that is cut off is complete for fewer extra states. Words that two of Chow's factors give
// twice are left out; prefixes of other tests are left to the cache.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "maide/automata/mealy.hpp"
#include "maide/conformance/test_runner.hpp"
#include "maide/conformance/test_suite.hpp"

namespace maide {

class WSuite : public TestSuite {
 public:
  // `hypothesis` must be complete; it is not kept. O(n k log n + |W| n l).
  WSuite(const Mealy& hypothesis, std::size_t extra_states);

  bool next(Word& word) override;
  std::optional<std::uint64_t> size() const override { return size_up_to(extra_states_); }

  // Tests of the suite for that many extra states, which are the first tests of this one.
  // Saturates at 2^64-1. O(extra_states).
  std::uint64_t size_up_to(std::size_t extra_states) const;
  // States of the hypothesis that are reachable and not equivalent to each other: `extra_states`
  // counts from there.
  std::size_t class_count() const { return class_count_; }
  const std::vector<Word>& characterising_set() const { return characterising_; }

 private:
  bool advance();

  std::size_t inputs_, extra_states_, class_count_;
  std::vector<Word> cover_;           // P
  std::vector<Word> transitions_;     // P.I \ P
  std::vector<Word> characterising_;  // W; the empty word if there is nothing to tell apart
  // The test that comes next: a base, an infix, a characterising word. Level 0 is P.W.
  std::size_t level_ = 0, base_ = 0, suffix_ = 0;
  Word infix_;
  bool at_end_ = false;
};

struct WMethodOptions {
  std::size_t extra_states = 2;
  TestRunnerOptions runner = {};
};

class WMethod : public EquivalenceOracle {
 public:
  // Keeps a reference to `oracle`.
  explicit WMethod(OutputOracle& oracle, WMethodOptions options = {})
      : runner_(oracle, options.runner), options_(options) {}

  std::optional<Word> find_counterexample(const Mealy& hypothesis,
                                          const RunControl& control = {}) override;
  std::string guarantee() const override { return guarantee_; }

 private:
  TestRunner runner_;
  WMethodOptions options_;
  std::string guarantee_ = "not tested";
};

}  // namespace maide
