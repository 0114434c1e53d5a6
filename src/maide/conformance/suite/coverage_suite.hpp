// Tests that pass k states or transitions of the hypothesis, in each order. A test goes from one to
// the next by shortest paths, and then takes some random inputs, whose outputs show where it really
// is. With k = 1 this is a cover; otherwise it finds differences that need several things to happen
// one after the other, however far apart they lie. (AALpy's KWayStateCoverage and
// KWayTransitionCoverage: Muskardin, Aichernig, Pill, Pferscher & Tappler, "AALpy: an active
// automata learning library", Innovations Syst. Softw. Eng. 2022.)
//
// There are w m^k tests for m states or transitions and w walks. Their order is random enough for a
// suite that is cut off to pass all parts of the hypothesis, and takes no memory: the i-th test is
// the one with number a i + b modulo w m^k, for an a that has no factor in common with that number.
// Where there are more than 2^64 tests, they are drawn.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "maide/automata/mealy.hpp"
#include "maide/base/random.hpp"
#include "maide/conformance/method/test_runner.hpp"
#include "maide/conformance/suite/test_suite.hpp"

namespace maide {

enum class Covered : std::uint8_t { states, transitions };

struct CoverageOptions {
  Covered covered = Covered::states;
  std::size_t ways = 1;          // how many a test passes; 1 to most_ways
  std::size_t walks = 1;         // tests that pass the same; at least 1
  std::size_t walk_length = 10;  // random inputs of each behind that; at most longest_walk

  static constexpr std::size_t most_ways = 100, longest_walk = 1'000'000;
  static constexpr std::size_t walks_of_state_cover = 10;
};

class CoverageSuite : public TestSuite {
 public:
  // Keeps a reference to `hypothesis`, which must be complete, its states all reachable. Up to 64
  // MB for shortest paths. Throws UsageError if the options are out of range.
  CoverageSuite(const Mealy& hypothesis, CoverageOptions options, Random random);

  // Where what should come next cannot be reached, the random inputs come at once.
  // O(length), and O(n k) for n states and k inputs where a shortest path begins at a new state.
  bool next(Word& word) override;
  std::optional<std::uint64_t> size() const override { return size_; }

 private:
  // By state: the transition, state x inputs + input, by which a shortest path enters it.
  using Tree = std::vector<std::uint64_t>;

  const Tree& paths_from(StateId state);
  bool append_path(StateId from, StateId to, Word& word);

  const Mealy& hypothesis_;
  CoverageOptions options_;
  Random random_;
  std::uint64_t targets_ = 0;  // m
  std::uint64_t size_ = 1;     // w m^k, saturated
  std::uint64_t step_ = 1, number_ = 0;
  std::uint64_t made_ = 0;
  std::vector<Tree> trees_;  // by state; empty: not made
  std::size_t tree_count_ = 0;
};

class CoverageMethod : public SuiteMethod {
 public:
  // Keeps a reference to `oracle`. Each equivalence query draws the order and the random inputs
  // anew. Throws UsageError as the suite does.
  CoverageMethod(OutputOracle& oracle, CoverageOptions options, TestRunnerOptions runner,
                 std::uint64_t seed);

  std::optional<Word> find_counterexample(const Mealy& hypothesis,
                                          const RunControl& control = {}) override;

 private:
  CoverageOptions options_;
  Random random_;
};

}  // namespace maide
