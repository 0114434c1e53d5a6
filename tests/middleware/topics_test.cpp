// Topics of real middleware, learned with all their ends at once, beside what the engine puts
// together from the model of one reader. Where the two differ, a system file uses the whole model;
// the test then says by which word they differ, and the middleware's page why.
#include <gtest/gtest.h>

#include <filesystem>
#include <ostream>
#include <string>
#include <vector>

#include "maide/automata/compare.hpp"
#include "maide/base/text.hpp"
#include "topic_composition.hpp"
#include "wrapper_checks.hpp"

namespace maide {
namespace {

struct TopicCase {
  std::string name, middleware;
  test::SystemOptions options;
  test::TopicShape shape;
  std::size_t readers = 1;
  std::string difference;  // the shortest word that tells them apart; "": they are the same
};

void PrintTo(const TopicCase& tested, std::ostream* out) { *out << tested.name; }

class Topics : public testing::TestWithParam<TopicCase> {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(MAIDE_BINARY_DIR "/bin/maide-wrap-" + GetParam().middleware)) {
      GTEST_SKIP() << "skipped: maide-wrap-" << GetParam().middleware << " is not built";
    }
  }

  static InterfaceAutomaton learn(std::size_t writers, std::size_t readers) {
    test::SystemOptions options = GetParam().options;
    options["writers"] = std::to_string(writers);
    options["readers"] = std::to_string(readers);
    return test::learn_system(GetParam().middleware, options).automaton;
  }
};

TEST_P(Topics, AreMadeOfTheirReadersOrDifferByAWord) {
  const TopicCase& tested = GetParam();
  const std::vector<InterfaceAutomaton> readers(tested.readers, learn(1, 1));
  const InterfaceAutomaton composed = test::compose_topic(readers, tested.shape);
  const InterfaceAutomaton whole = learn(tested.shape.writers, tested.readers);
  const IaComparison comparison = compare(whole, composed);
  std::string difference;
  if (comparison.hard) {
    difference = join(comparison.hard->word, " ");
    RecordProperty("whole", to_string(comparison.hard->left));
    RecordProperty("composed", to_string(comparison.hard->right));
  } else if (!comparison.soft.empty()) {
    const SoftDifference& soft = comparison.soft.front();
    difference = join(soft.word, " ") + " ~ " + soft.inputs.front().name;
  }
  EXPECT_EQ(difference, tested.difference)
      << whole.size() << " states learned whole, " << composed.size() << " composed of "
      << readers.front().size();
}

INSTANTIATE_TEST_SUITE_P(Short, Topics,
                         testing::Values(TopicCase{
                             "cyclonedds_last_1_2x2", "cyclonedds", {}, {2, false}, 2, ""}),
                         [](const auto& tested) { return tested.param.name; });
INSTANTIATE_TEST_SUITE_P(
    Wide, Topics,
    testing::Values(TopicCase{"fastdds_last_1_2x2", "fastdds", {}, {2, false}, 2, ""},
                    TopicCase{"ros2_last_1_2x2", "ros2", {{"depth", "1"}}, {2, false}, 2, ""}),
    [](const auto& tested) { return tested.param.name; });

}  // namespace
}  // namespace maide
