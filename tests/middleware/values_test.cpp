// Queues of real middleware with values: the model that is made of the one without is the one that
// is learned with them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "maide/automata/compare.hpp"
#include "maide/base/file.hpp"
#include "maide/experiment/open_system.hpp"
#include "maide/join/learned_models.hpp"
#include "maide/join/valued_queue.hpp"

namespace maide {
namespace {

using testing::HasSubstr;
using Options = std::vector<std::pair<std::string, std::string>>;

struct ValuesCase {
  std::string name, middleware;
  Options with;
  std::string rule;  // that explains it
};

void PrintTo(const ValuesCase& tested, std::ostream* out) { *out << tested.name; }

class Values : public testing::TestWithParam<ValuesCase> {
 protected:
  static void SetUpTestSuite() {
    const char* path = std::getenv("PATH");
    ::setenv("PATH", (MAIDE_BINARY_DIR "/bin:" + std::string(path ? path : "")).c_str(), 1);
  }
  void SetUp() override {
    if (!find_wrapper(GetParam().middleware)) {
      GTEST_SKIP() << "skipped: maide-wrap-" << GetParam().middleware << " is not built";
    }
  }
  InterfaceAutomaton learn(const Options& more, const std::vector<std::string>& values) {
    ModelRequest request;
    request.instance = "via";
    request.learn = GetParam().middleware;
    request.with = GetParam().with;
    request.with.insert(request.with.end(), more.begin(), more.end());
    request.values = values;
    return make_learning_source({folder_.path(), {}, {}, 0})(request);
  }

  TempDir folder_{"maide-values-"};
};

TEST_P(Values, AreThoseThatAreLearned) {
  const std::vector<std::string> values{"0", "1", "stop"};
  const InterfaceAutomaton made = learn({}, values);
  EXPECT_THAT(made.origin.at("tests"), HasSubstr(GetParam().rule));
  EXPECT_TRUE(compare(learn({}, values), made).same());  // kept
  const InterfaceAutomaton learned = learn({{"payload", payload_of(values)}}, {});
  EXPECT_TRUE(compare(learned, made).same());
}

INSTANTIATE_TEST_SUITE_P(
    Short, Values,
    testing::Values(ValuesCase{
        "cyclonedds_last_2", "cyclonedds", {{"depth", "2"}}, "the oldest is lost"}),
    [](const auto& tested) { return tested.param.name; });
INSTANTIATE_TEST_SUITE_P(Wide, Values,
                         testing::Values(ValuesCase{"cyclonedds_best_effort_1",
                                                    "cyclonedds",
                                                    {{"history", "keep_all"}, {"max-samples", "1"}},
                                                    "the newest is lost"}),
                         [](const auto& tested) { return tested.param.name; });

}  // namespace
}  // namespace maide
