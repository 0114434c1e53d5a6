// The paper's case studies as examples/ has them: the real program must come to the paper's
// conclusions, and to the state counts that the meaning of steps gives.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "maide/base/file.hpp"
#include "maide/check/build/system_file.hpp"
#include "maide/check/engines/engine.hpp"
#include "maide/check/engines/export/promela_system.hpp"
#include "maide/check/engines/spin_engine.hpp"
#include "maide/check/verdict/check_system.hpp"
#include "run_maide.hpp"

namespace maide::test {
namespace {

using testing::HasSubstr;

std::string example(const std::string& name) {
  return std::string(MAIDE_SOURCE_DIR) + "/examples/" + name;
}

SubprocessResult check(const std::string& name, const std::vector<std::string>& options = {}) {
  std::vector<std::string> arguments{"check", example(name), "--json"};
  arguments.insert(arguments.end(), options.begin(), options.end());
  return run_maide(arguments);
}

const Json& property(const Json& report, const std::string& name) {
  for (const Json& entry : report["properties"]) {
    if (entry["name"] == name) return entry;
  }
  static const Json none = Json::object();
  ADD_FAILURE() << "no property " << name;
  return none;
}

TEST(CaseStudy1, BufferedPortDeadlocks) {
  const SubprocessResult result = check("case-study-1/buffered.yaml");
  EXPECT_EQ(result.exit_status, 1);
  const Json report = json_of(result);
  EXPECT_EQ(report["verdict"], "violated");
  const Json& deadlock = property(report, "deadlock");
  EXPECT_EQ(deadlock["verdict"], "violated");
  // Six writes, of which one is read, two reads, and the planner's read: no shorter way.
  EXPECT_EQ(deadlock["trace"].size(), 10u);
  EXPECT_EQ(deadlock["trace"][0]["program"], "planner");
  EXPECT_EQ(deadlock["trace"][0]["line"], 10);
  EXPECT_EQ(deadlock["trace"][0]["model"], "via");
  EXPECT_EQ(deadlock["trace"][0]["event"], "?write");
  EXPECT_EQ(property(report, "acknowledged")["verdict"], "violated");
  EXPECT_EQ(property(report, "in_step")["verdict"], "holds");
}

TEST(CaseStudy1, StrictPortsThatFitHold) {
  for (const std::string name : {"strict-1", "strict-6"}) {
    const SubprocessResult result = check("case-study-1/" + name + ".yaml");
    EXPECT_EQ(result.exit_status, 0) << result.out;
    const Json report = json_of(result);
    EXPECT_EQ(report["verdict"], "holds");
    EXPECT_EQ(report["properties"].size(), 4u);
    for (const Json& entry : report["properties"]) EXPECT_EQ(entry["verdict"], "holds") << entry;
  }
}

TEST(CaseStudy1, ABurstAboveTheBoundIsInconclusiveAndNamesIt) {
  const SubprocessResult result =
      check("case-study-1/beyond-the-bound.yaml", {"--property", "deadlock"});
  EXPECT_EQ(result.exit_status, 3);
  const Json report = json_of(result);
  EXPECT_EQ(report["verdict"], "inconclusive");
  EXPECT_EQ(property(report, "deadlock")["reason"],
            "via was learned for at most 6 messages in flight; planner's via.write at line 10 goes "
            "beyond");
}

// The robot leaves via points out before anything hangs.
TEST(CaseStudy1, LostViaPointsAreASafetyProperty) {
  const SubprocessResult lost =
      check("case-study-1/lost-via-points.yaml", {"--property", "nothing_lost"});
  EXPECT_EQ(lost.exit_status, 1);
  const Json report = json_of(lost);
  const Json& trace = property(report, "nothing_lost")["trace"];
  ASSERT_EQ(trace.size(), 4u);  // two writes, and a read that tells
  EXPECT_EQ(trace[3]["event"], "!gap");
  EXPECT_EQ(check("case-study-1/no-lost-via-points.yaml").exit_status, 0);
}

// A tracker that dies: no deadlock, for the sensor goes on for ever, but the controller is stuck.
TEST(CaseStudy2, ADeadTrackerLeavesTheControllerStuck) {
  const SubprocessResult dead =
      check("case-study-2/dead-tracker.yaml", {"--property", "deadlock", "--property", "stuck"});
  EXPECT_EQ(dead.exit_status, 1);
  const Json report = json_of(dead);
  EXPECT_NE(property(report, "deadlock")["verdict"], "violated");
  const Json& stuck = property(report, "stuck");
  EXPECT_EQ(stuck["verdict"], "violated");
  const Json& trace = stuck["trace"];
  const auto is_cut = [](const Json& step) { return step["event"] == "!disconnected"; };
  EXPECT_TRUE(std::any_of(trace.begin(), trace.end(), is_cut));
  ASSERT_TRUE(stuck["loop_start"].is_number());
  for (std::size_t at = stuck["loop_start"]; at < trace.size(); ++at) {
    EXPECT_EQ(trace[at]["program"], "sensor");
  }
  EXPECT_EQ(check("case-study-2/dead-tracker.yaml", {"--property", "goes_on"}).exit_status, 1);
  EXPECT_EQ(check("case-study-2/dead-tracker-nonblocking.yaml",
                  {"--property", "deadlock", "--property", "goes_on"})
                .exit_status,
            0);
}

struct Row {
  std::string name;
  std::string verdict;
  std::uint64_t states;  // of a search that found nothing; 0: it found something
};

class Table2 : public testing::TestWithParam<Row> {};

TEST_P(Table2, HasThePapersConclusion) {
  const Row& row = GetParam();
  const SubprocessResult result =
      check("case-study-2/" + row.name + ".yaml", {"--property", "deadlock"});
  EXPECT_EQ(result.exit_status, row.verdict == "holds" ? 0 : 1) << result.err;
  const Json report = json_of(result);
  EXPECT_EQ(report["verdict"], row.verdict);
  if (row.states > 0) {
    const System system = read_system(example("case-study-2/" + row.name + ".yaml"));
    EXPECT_EQ(NativeEngine().check(system, find_property(system, "deadlock"), {}).states,
              row.states);
  }
  EXPECT_THAT(report["assumptions"].dump(), HasSubstr("when_unexplored: "));
}

INSTANTIATE_TEST_SUITE_P(Rows, Table2,
                         testing::Values(Row{"100-100-100-size-1", "holds", 1597},
                                         Row{"90-100-100-size-1", "violated", 0},
                                         Row{"100-100-100-size-6", "holds", 18927},
                                         Row{"90-100-100-size-6", "violated", 0},
                                         Row{"200-200-200-size-6", "holds", 38527},
                                         Row{"180-200-200-size-6", "violated", 0},
                                         Row{"nonblocking-drop", "holds", 1986726},
                                         Row{"nonblocking-wait", "violated", 0}),
                         [](const auto& row) {
                           std::string name = row.param.name;
                           for (char& c : name) c = c == '-' ? '_' : c;
                           return name;
                         });

TEST(CaseStudy2, TheTableIsReproduced) {
  const SubprocessResult result = run_maide({"reproduce", "table2", "--json"});
  EXPECT_EQ(result.exit_status, 0) << result.err;
  const Json report = json_of(result);
  EXPECT_EQ(report["agree"], true);
  ASSERT_EQ(report["rows"].size(), 11u);
  for (const Json& row : report["rows"]) {
    EXPECT_EQ(row["native"]["verdict"], row["spin"]["verdict"]) << row;
    if (row["native"]["verdict"] == "holds") {
      EXPECT_EQ(row["native"]["states"], row["spin"]["states"]) << row;
    }
  }
  // The last row of the paper, and the one that it has not: nothing is dropped there.
  EXPECT_EQ(report["rows"][9]["native"]["states"], 1986726);
  EXPECT_EQ(report["rows"][9]["paper"]["states"], "19M");
  EXPECT_EQ(report["rows"][10]["native"]["verdict"], "violated");
  EXPECT_TRUE(report["rows"][10]["paper"].is_null());
}

// pan's breadth-first search loses deadlocks of programs that meet in rendezvous: why the reference
// is its depth-first search.
TEST(CaseStudy2, TheDeadlockThatPansBreadthFirstSearchMisses) {
  const System system = read_system(example("case-study-2/90-100-100-size-1.yaml"));
  const Property deadlock = find_property(system, "deadlock");
  EXPECT_EQ(NativeEngine().check(system, deadlock, {}).verdict, Verdict::violated);
  EXPECT_EQ(SpinEngine().check(system, deadlock, {}).verdict, Verdict::violated);

  const TempDir folder;
  SubprocessOptions options;
  options.folder = folder.path();
  write_file_atomically(folder.path() / "s.pml", write_promela(system).text);
  ASSERT_TRUE(run_program({"spin", "-a", "s.pml"}, options).succeeded());
  ASSERT_TRUE(
      run_program({"cc", "-w", "-DBFS", "-DSAFETY", "-DNOREDUCE", "-o", "pan", "pan.c"}, options)
          .succeeded());
  const SubprocessResult run = run_program({"./pan"}, options);
  const std::optional<PanOutput> output = parse_pan_output(run.out + run.err);
  ASSERT_TRUE(output);
  EXPECT_EQ(output->errors, 0u);
  EXPECT_GT(output->states, 1000u);
}

}  // namespace
}  // namespace maide::test
