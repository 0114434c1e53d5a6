// Black-box checking on Cyclone DDS: models that were learned without a single test are refined
// until the running middleware confirms the verdict, in as many states as a careful learner finds.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <string>

#include "maide/base/file.hpp"
#include "maide/check/engines/engine.hpp"
#include "maide/experiment/open_system.hpp"
#include "maide/join/refine_system.hpp"

namespace maide {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

class RefinedCycloneDds : public testing::Test {
 protected:
  void SetUp() override {
    const char* path = std::getenv("PATH");
    ::setenv("PATH", (MAIDE_BINARY_DIR "/bin:" + std::string(path ? path : "")).c_str(), 1);
    if (!find_wrapper("cyclonedds")) {
      GTEST_SKIP() << "skipped: maide-wrap-cyclonedds is not built";
    }
  }
  // A burst of four over a connection with these options.
  RefinedCheck check_burst(const std::string& options) {
    const auto file = folder_.path() / "system.yaml";
    write_file_atomically(file, "models:\n  via:\n    learn: cyclonedds\n    with: {" + options +
                                    "}\n    learning: {eq: random-words, max-tests: 0}\n"
                                    "programs:\n  planner: repeat 4 { via.write; }\n"
                                    "  controller: repeat 4 { via.read -> message; }\n");
    NativeEngine engine;
    CheckRequest request;
    request.properties = {"deadlock"};
    RefinementOptions refinement;
    refinement.models.folder = folder_.path();
    return check_and_refine(file, engine, request, refinement);
  }
  TempDir folder_{"maide-refined-"};
};

TEST_F(RefinedCycloneDds, AFalseAlarmGoesAway) {
  const RefinedCheck checked = check_burst("history: keep_all, size: 4");
  EXPECT_EQ(to_string(checked.report.verdict), "holds");
  EXPECT_THAT(checked.rounds, Not(IsEmpty()));
  EXPECT_EQ(checked.system.models[0].automaton.size(), 10U);  // 2N + 2
  EXPECT_THAT(checked.report.assumptions, Contains(HasSubstr("tested again on the real system")));
}

// The first model deadlocks, too, but not as the middleware does.
TEST_F(RefinedCycloneDds, AFalseAlarmGivesWayToTheRealOne) {
  const RefinedCheck checked = check_burst("depth: 3");
  EXPECT_EQ(to_string(checked.report.verdict), "violated");
  EXPECT_THAT(checked.rounds, Not(IsEmpty()));
  const auto& steps = checked.report.properties.front().trace->steps;
  EXPECT_EQ(std::ranges::count(steps, nobody, &Step::actor), 4);  // arrivals
  EXPECT_EQ(steps.size(), 11U + 4);                               // four writes, three reads
  EXPECT_THAT(checked.report.assumptions,
              Contains("the real system followed the counterexample to deadlock"));
}

}  // namespace
}  // namespace maide
