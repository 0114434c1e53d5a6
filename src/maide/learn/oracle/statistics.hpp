// What a run cost: queries, symbols, resets and seconds, by the phase of the learning loop and by
// hypothesis.
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace maide {

// What the learning loop is doing.
enum class LearnPhase : std::uint8_t {
  learning,      // the first hypothesis
  refinement,    // a counterexample is analysed and the hypothesis made to agree with it
  testing,       // an equivalence query
  confirmation,  // words asked again: votes on contradictions, counterexamples, the final model
};
inline constexpr std::size_t learn_phase_count = 4;
std::string_view to_string(LearnPhase phase);

struct QueryCounts {
  std::uint64_t queries = 0;  // words and decision trees
  std::uint64_t symbols = 0;  // inputs given, those of repeated attempts included
  std::uint64_t resets = 0;   // one for each attempt at each query
  // Summed over all systems that work in parallel:
  std::chrono::microseconds in_reset{0};       // resets
  std::chrono::microseconds in_reset_wait{0};  // the part of them that a query waited for
  std::chrono::microseconds in_system{0};      // steps, resets not included
  std::chrono::microseconds in_settling{0};    // the part of them in which nothing came any more
  // By the clock: from the question to the answer of each batch.
  std::chrono::microseconds asking{0};

  QueryCounts& operator+=(const QueryCounts& other);
  QueryCounts& operator-=(const QueryCounts& other);
  bool operator==(const QueryCounts&) const = default;
};

class Statistics {
 public:
  QueryCounts& at(LearnPhase phase) { return phases_[static_cast<std::size_t>(phase)]; }
  const QueryCounts& at(LearnPhase phase) const { return phases_[static_cast<std::size_t>(phase)]; }
  QueryCounts total() const;

 private:
  std::array<QueryCounts, learn_phase_count> phases_{};
};

// A hypothesis, and what had been spent in all when it was made.
struct HypothesisCost {
  std::size_t states = 0;
  Statistics before;
};

// The costs of each hypothesis: of making it (learning, refinement) and then of testing it
// (testing, confirmation). They go up to the next hypothesis, or to `end`, the costs of the whole
// run.
struct HypothesisShare {
  std::size_t states = 0;
  QueryCounts to_make, to_test;
};
std::vector<HypothesisShare> divide(std::span<const HypothesisCost> hypotheses,
                                    const Statistics& end);

}  // namespace maide
