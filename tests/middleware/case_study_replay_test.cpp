// Case study 1 on every middleware: where we say that it deadlocks, the real one follows into the
// deadlock every time; where we say that it does not, random runs of the programs on the real one
// never do, and never leave the model.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <ostream>
#include <string>
#include <vector>

#include "at_rest.hpp"
#include "maide/base/file.hpp"
#include "maide/check/engines/engine.hpp"
#include "maide/check/verdict/check_system.hpp"
#include "maide/experiment/open_system.hpp"
#include "maide/join/learned_models.hpp"
#include "maide/join/real_system.hpp"
#include "maide/join/replay.hpp"
#include "maide/join/replay_plan.hpp"

namespace maide {
namespace {

struct CaseStudy {
  std::string middleware;
  std::string file;  // of examples/case-study-1
  Verdict verdict;
};

void PrintTo(const CaseStudy& study, std::ostream* out) { *out << study.file; }

class CaseStudyReplay : public testing::TestWithParam<CaseStudy> {
 protected:
  static void SetUpTestSuite() {
    const char* path = std::getenv("PATH");
    ::setenv("PATH", (MAIDE_BINARY_DIR "/bin:" + std::string(path ? path : "")).c_str(), 1);
  }
  void SetUp() override {
    if (!find_wrapper(GetParam().middleware)) {
      GTEST_SKIP() << "skipped: maide-wrap-" << GetParam().middleware << " is not built";
    }
    const std::string name = GetParam().file + ".yaml";
    write_file_atomically(folder_.path() / name,
                          read_file(MAIDE_SOURCE_DIR "/examples/case-study-1/" + name));
    const ModelSource models =
        record_requests(make_learning_source({folder_.path(), {}, {}, 0}), requests_);
    system_ = read_system(folder_.path() / name, models);
    NativeEngine engine;
    CheckRequest request;
    request.properties = {"deadlock"};
    result_ = check_system(system_, engine, request).properties.front();
    ASSERT_EQ(to_string(result_.verdict), to_string(GetParam().verdict)) << result_.reason;
    system_ = test::at_rest(system_, folder_.path() / name, models, result_);
  }

  // The counterexample, or random runs.
  std::vector<Trace> traces(std::size_t rounds) const {
    if (result_.trace) return std::vector<Trace>(rounds, *result_.trace);
    std::vector<Trace> traces;
    Random random(1);
    for (std::size_t round = 0; round < rounds; ++round) {
      traces.push_back(draw_run(system_, 60, random));
    }
    return traces;
  }

  void expect_followed(std::size_t rounds) {
    const auto real = open_real_systems(system_, requests_, {0, "", {}});
    const std::vector<Trace> played = traces(rounds);
    std::size_t deadlocks = 0;
    play_on_real_system(system_, real, played, {}, [&](std::size_t round, ReplayedRun run) {
      EXPECT_EQ(run.steps, played[round].steps.size());
      EXPECT_FALSE(run.deviation) << "round " << round << ": expected " << run.deviation->expected
                                  << ", seen " << run.deviation->seen;
      if (ends_in_deadlock(system_, played[round])) ++deadlocks;
    });
    EXPECT_EQ(deadlocks, result_.trace ? rounds : 0);
  }

  TempDir folder_{"maide-case-study-"};
  ModelRequests requests_;
  System system_;
  PropertyResult result_;
};

TEST_P(CaseStudyReplay, IsWhatWeSayInThreeRounds) { expect_followed(3); }

TEST_P(CaseStudyReplay, IsWhatWeSayInAHundredRounds) { expect_followed(100); }

INSTANTIATE_TEST_SUITE_P(
    Examples, CaseStudyReplay,
    testing::Values(CaseStudy{"yarp", "yarp-buffered", Verdict::violated},
                    CaseStudy{"yarp", "yarp-strict", Verdict::holds},
                    CaseStudy{"ros1", "ros1-queue-1", Verdict::violated},
                    CaseStudy{"ros1", "ros1-queue-10", Verdict::violated},
                    CaseStudy{"ros1", "ros1-queue-10-fits", Verdict::holds},
                    CaseStudy{"cyclonedds", "cyclonedds-default", Verdict::violated},
                    CaseStudy{"cyclonedds", "cyclonedds-keep-all", Verdict::holds},
                    CaseStudy{"fastdds", "fastdds-default", Verdict::violated},
                    CaseStudy{"fastdds", "fastdds-keep-all", Verdict::holds},
                    CaseStudy{"zeromq", "zeromq-conflate", Verdict::violated},
                    CaseStudy{"zeromq", "zeromq-pub-sub", Verdict::violated},
                    CaseStudy{"zeromq", "zeromq-push-pull", Verdict::holds},
                    CaseStudy{"mqtt", "mqtt-qos-1", Verdict::violated},
                    CaseStudy{"mqtt", "mqtt-qos-0", Verdict::holds}),
    [](const auto& row) {
      std::string name = row.param.file;
      std::replace(name.begin(), name.end(), '-', '_');
      return name;
    });

}  // namespace
}  // namespace maide
