#include "maide/sul/query_player.hpp"

#include <gtest/gtest.h>

namespace maide {
namespace {

// A rendezvous: write and read meet; the writer returns after the reader got the message, and the
// events are reported in the wrong order on purpose.
class Rendezvous : public SteppedSystem {
 public:
  bool is_busy(Symbol input) override { return busy_[input]; }
  Outcome take(Symbol input, SulStep& step) override {
    busy_[input] = true;
    if (busy_[0] && busy_[1]) {
      busy_[0] = busy_[1] = false;
      step.events = {{1, "message"}, {0, "written"}};
    }
    for (std::uint32_t actor = 0; actor < 2; ++actor) {
      if (busy_[actor]) step.busy.push_back(actor);
    }
    return ++taken_ == crash_at ? Outcome::crash : Outcome::quiescent;
  }
  int crash_at = 0;

 private:
  bool busy_[2] = {false, false};
  int taken_ = 0;
};

class QueryPlayer : public testing::Test {
 protected:
  QueryPlayer() {
    info_.actors = {"writer", "reader"};
    info_.inputs = {{"write", 0, {"written"}}, {"read", 1, {"message"}}};
    info_.outputs = {{"written", 0}, {"message", 1}};
  }
  std::vector<std::string> outputs(const SulQuery& query,
                                   std::span<const LearningPurpose> purposes = {}) {
    Rendezvous system;
    const SulAnswer answer = play(system, query, info_, purposes);
    std::vector<std::string> result;
    for (const SulStep& step : answer.steps) {
      result.push_back(mealy_output(step, query.translation));
    }
    return result;
  }
  SulInfo info_;
  static constexpr Symbol write = 0, read = 1, delta = 2;
};

using Outputs = std::vector<std::string>;

TEST_F(QueryPlayer, RefusesInputsOfBusyActorsAndSortsByActor) {
  EXPECT_EQ(outputs({Word{write, write, read, read}}),
            (Outputs{"quiet", "refused", "written,message", "quiet"}));
}

TEST_F(QueryPlayer, QueuesOutputsUnderAv) {
  EXPECT_EQ(outputs({Word{delta, write, delta, read, write, delta, read, delta, delta, read},
                     Translation::av}),
            (Outputs{"delta", "+", "delta", "+", "refused", "written", "refused", "message",
                     "delta", "+"}));
}

TEST_F(QueryPlayer, NeverOffersWhatLiesBeyondThePurpose) {
  InterfaceAutomaton no_write({"write"}, {}, 1);
  const std::vector<LearningPurpose> refusing{LearningPurpose(no_write)};
  EXPECT_EQ(outputs({Word{write, read, write}}, refusing),
            (Outputs{"unexplored", "quiet", "unexplored"}));
  const std::vector<LearningPurpose> absorbing{LearningPurpose(no_write, AtBound::absorb)};
  EXPECT_EQ(outputs({Word{write}}, absorbing), (Outputs{"absorbed"}));
}

TEST_F(QueryPlayer, WalksDecisionTrees) {
  BasicDecisionTree<std::string> tree;
  tree.nodes = {{write, {{"quiet", 1}, {"written", 2}}}, {read, {{"nothing", 2}}}, {write, {}}};
  Rendezvous system;
  const SulAnswer answer = play(system, {tree}, info_, {});
  EXPECT_EQ(answer.inputs, (Word{write, read}));  // no branch for "written,message"
  EXPECT_EQ(answer.steps.size(), 2U);
  EXPECT_EQ(answer.end, WordEnd::complete);
}

TEST_F(QueryPlayer, EndsTheWordAtACrash) {
  Rendezvous system;
  system.crash_at = 2;
  const SulAnswer answer = play(system, {Word{write, read, write}}, info_, {});
  EXPECT_EQ(answer.end, WordEnd::crash);
  EXPECT_EQ(answer.inputs.size(), 2U);
}

}  // namespace
}  // namespace maide
