#include "maide/learn/oracle/statistics.hpp"

#include <gtest/gtest.h>

namespace maide {
namespace {

void spend(Statistics& statistics, LearnPhase phase, std::uint64_t words, std::uint64_t symbols) {
  QueryCounts counts;
  counts.queries = counts.resets = words;
  counts.symbols = symbols;
  statistics.at(phase) += counts;
}

TEST(Statistics, EveryWordBelongsToTheHypothesisThatItMadeOrTested) {
  Statistics now;
  std::vector<HypothesisCost> hypotheses;
  spend(now, LearnPhase::learning, 4, 9);
  hypotheses.push_back({1, now});
  spend(now, LearnPhase::testing, 10, 70);
  spend(now, LearnPhase::confirmation, 1, 7);
  spend(now, LearnPhase::refinement, 3, 21);
  hypotheses.push_back({5, now});
  spend(now, LearnPhase::testing, 100, 900);
  const auto shares = divide(hypotheses, now);
  ASSERT_EQ(shares.size(), 2U);
  EXPECT_EQ(shares[0].states, 1U);
  EXPECT_EQ(shares[0].to_make.queries, 4U);
  EXPECT_EQ(shares[0].to_make.symbols, 9U);
  EXPECT_EQ(shares[0].to_test.queries, 11U);
  EXPECT_EQ(shares[0].to_test.symbols, 77U);
  EXPECT_EQ(shares[1].states, 5U);
  EXPECT_EQ(shares[1].to_make.queries, 3U);
  EXPECT_EQ(shares[1].to_test.resets, 100U);
  EXPECT_EQ(shares[1].to_test.symbols, 900U);
  EXPECT_TRUE(divide({}, now).empty());
}

}  // namespace
}  // namespace maide
