// What real middlewares do with messages on their way, for the defaults of `delivery:` (the table
// in docs/middleware/deliveries.md). Where a connection is taken to hand over within the writer's
// call, no round of a race may miss; where what is sent may come later, some round does miss, so
// that the race could have seen it. How many is not asked: that depends on the machine.
#include <gtest/gtest.h>

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <ostream>
#include <string>
#include <vector>

#include "maide/base/subprocess.hpp"

namespace maide {
namespace {

struct Race {
  std::string name, middleware;
  std::vector<std::string> settings;
};

void PrintTo(const Race& race, std::ostream* out) { *out << race.name; }

struct Outcome {
  std::uint32_t rounds = 0, misses = 0, lost = 0, unnoticed = 0;
};

class Deliveries : public testing::TestWithParam<Race> {
 protected:
  static std::string program() {
    return MAIDE_BINARY_DIR "/bin/maide-deliveries-" + GetParam().middleware;
  }

  void SetUp() override {
    if (!std::filesystem::exists(program())) {
      GTEST_SKIP() << "skipped: maide-wrap-" << GetParam().middleware << " is not built";
    }
  }

  static Outcome play() {
    std::vector<std::string> command{program()};
    command.insert(command.end(), GetParam().settings.begin(), GetParam().settings.end());
    SubprocessOptions options;
    options.time_limit = std::chrono::minutes(4);
    const SubprocessResult result = run_program(command, options);
    Outcome outcome;
    EXPECT_TRUE(result.succeeded()) << result.err;
    if (!result.succeeded()) return outcome;
    const auto line = nlohmann::json::parse(result.out);
    outcome.rounds = line.at("rounds");
    outcome.misses = line.at("misses");
    outcome.lost = line.at("lost");
    outcome.unnoticed = line.at("unnoticed");
    return outcome;
  }
};

// The middleware's own threads are slowed down, so that what one of them would hand over is late.
class AtOnce : public Deliveries {};
TEST_P(AtOnce, TheReaderAlwaysHasTheMap) {
  const Outcome outcome = play();
  EXPECT_GT(outcome.rounds, 0U);
  EXPECT_EQ(outcome.misses, 0U);
  EXPECT_EQ(outcome.unnoticed, 0U);
}

class Late : public Deliveries {};
TEST_P(Late, TheReaderSometimesLacksTheMap) {
  const Outcome outcome = play();
  EXPECT_GT(outcome.misses, 0U);
  EXPECT_EQ(outcome.lost, 0U);
  EXPECT_EQ(outcome.unnoticed, 0U);
}

class Loses : public Deliveries {};
TEST_P(Loses, SomethingNeverComes) {
  const Outcome outcome = play();
  EXPECT_GT(outcome.lost + outcome.unnoticed, 0U);
}

// Two topics of DDS within one process, in every way that was measured.
std::vector<Race> races_within_a_process(const std::string& middleware) {
  std::vector<Race> races;
  for (const std::string ends : {"threads", "participants"}) {
    for (const std::string notice : {"topic", "call", "look"}) {
      for (const std::string reliability : {"reliable", "best_effort"}) {
        for (const bool is_large : {false, true}) {
          races.push_back({middleware + "_" + ends + "_" + notice + "_" + reliability +
                               (is_large ? "_4_MB" : "_100_B"),
                           middleware,
                           {"ends=" + ends, "notice=" + notice, "reliability=" + reliability,
                            is_large ? "size=4000000" : "size=100",
                            is_large ? "rounds=50" : "rounds=200", "library=slow"}});
        }
      }
    }
  }
  return races;
}

std::vector<Race> races_at_once() {
  std::vector<Race> races = races_within_a_process("cyclonedds");
  for (const Race& race : races_within_a_process("fastdds")) races.push_back(race);
  const std::vector<Race> others{
      {"cyclonedds_list", "cyclonedds", {"notice=look", "between=100", "rounds=5000"}},
      {"fastdds_list", "fastdds", {"notice=look", "between=100", "rounds=5000"}},
      {"fastdds_data_sharing", "fastdds", {"notice=call", "shared=on", "library=slow"}},
      {"zeromq_push", "zeromq", {"notice=call", "library=slow"}},
      {"zeromq_pub", "zeromq", {"notice=call", "pattern=pub", "library=slow"}},
      {"ros1_pointer", "ros1", {"notice=call", "library=slow"}},
  };
  races.insert(races.end(), others.begin(), others.end());
  return races;
}

const std::vector<Race> races_late{
    {"cyclonedds_call", "cyclonedds", {"ends=processes", "notice=call", "library=slow"}},
    {"cyclonedds_loss", "cyclonedds", {"ends=processes", "lost=100", "rounds=100"}},
    {"cyclonedds_in_turn", "cyclonedds", {"notice=look", "look=turn"}},
    {"fastdds_call", "fastdds", {"ends=processes", "notice=call", "library=slow"}},
    {"fastdds_shm_call",
     "fastdds",
     {"ends=processes", "transport=shm", "notice=call", "library=slow"}},
    {"fastdds_loss", "fastdds", {"ends=processes", "transport=lossy", "lost=10", "rounds=100"}},
    {"fastdds_data_sharing",
     "fastdds",
     {"ends=processes", "shared=on", "notice=call", "library=slow"}},
    {"fastdds_asynchronous", "fastdds", {"publish=async", "notice=call", "library=slow"}},
    {"fastdds_no_shortcut", "fastdds", {"intraprocess=off", "notice=call", "library=slow"}},
    {"fastdds_in_turn", "fastdds", {"notice=look", "look=turn"}},
    {"zeromq_push", "zeromq", {"ends=processes", "transport=ipc", "notice=call", "library=slow"}},
    {"zeromq_pub",
     "zeromq",
     {"ends=processes", "transport=ipc", "pattern=pub", "notice=call", "library=slow"}},
    {"zeromq_tcp_in_one_process", "zeromq", {"transport=tcp", "notice=call", "library=slow"}},
    {"mqtt_qos_0", "mqtt", {"notice=call", "library=slow"}},
    {"ros1_processes", "ros1", {"ends=processes", "notice=call", "library=slow"}},
    {"ros1_reference", "ros1", {"hands=reference", "notice=call", "library=slow"}},
};

const std::vector<Race> races_that_lose{
    {"cyclonedds",
     "cyclonedds",
     {"ends=processes", "reliability=best_effort", "lost=100", "rounds=100"}},
    {"fastdds",
     "fastdds",
     {"ends=processes", "reliability=best_effort", "transport=lossy", "lost=10", "rounds=100"}},
};

std::string name_of(const testing::TestParamInfo<Race>& info) { return info.param.name; }

INSTANTIATE_TEST_SUITE_P(Real, AtOnce, testing::ValuesIn(races_at_once()), name_of);
INSTANTIATE_TEST_SUITE_P(Real, Late, testing::ValuesIn(races_late), name_of);
INSTANTIATE_TEST_SUITE_P(Real, Loses, testing::ValuesIn(races_that_lose), name_of);

}  // namespace
}  // namespace maide
