#include "maide/check/engines/ltsmin_engine.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>

#include "maide/base/file.hpp"
#include "maide/check/build/system_file.hpp"
#include "maide/check/verdict/check_system.hpp"
#include "systems.hpp"

namespace maide {
namespace {

using testing::HasSubstr;

SubprocessResult printed(int status, const std::string& text) {
  SubprocessResult result;
  result.exit_status = status;
  result.err = text;
  return result;
}

const std::string counts =
    "pins2lts-mc( 0/ 2): Explored 160 states 412 transitions, fanout: 2.575\n"
    "pins2lts-mc( 0/ 2): Est. total memory use: 1.5MB (~8.0MB paged-in)\n";

TEST(LtsminOutput, OfACompleteSearch) {
  const LtsminOutput output = read_ltsmin_output(printed(0, counts));
  EXPECT_TRUE(output.is_complete);
  EXPECT_FALSE(output.is_violated);
  EXPECT_EQ(output.states, 160u);
  EXPECT_EQ(output.transitions, 412u);
  EXPECT_EQ(output.peak_bytes, 3u << 19);
}

TEST(LtsminOutput, OfAViolation) {
  for (const char* found : {"pins2lts-mc: Deadlock found in state at depth 11!\n",
                            "pins2lts-mc: Invariant violation (!error) found at depth 7!\n"}) {
    const LtsminOutput output = read_ltsmin_output(printed(1, found + counts));
    EXPECT_TRUE(output.is_violated);
    EXPECT_FALSE(output.is_complete);
    // Neither is said without the other.
    EXPECT_FALSE(read_ltsmin_output(printed(0, found + counts)).is_violated);
    EXPECT_FALSE(read_ltsmin_output(printed(0, found + counts)).is_complete);
    EXPECT_FALSE(read_ltsmin_output(printed(1, counts)).is_violated);
  }
}

// It ends with status 0 then, and says what it has explored.
TEST(LtsminOutput, AFullTableIsNoCompleteSearch) {
  const LtsminOutput output = read_ltsmin_output(printed(
      0, "pins2lts-mc( 0/ 2): Error: tree leafs table full! Change -s/--ratio.\n" + counts));
  EXPECT_TRUE(output.is_table_full);
  EXPECT_FALSE(output.is_complete);
}

TEST(LtsminOutput, WhatIsNotSaidIsNoCompleteSearch) {
  EXPECT_FALSE(read_ltsmin_output(printed(0, "")).is_complete);
  EXPECT_FALSE(read_ltsmin_output(printed(0, "pins2lts-mc: Explored many states\n")).is_complete);
  EXPECT_FALSE(read_ltsmin_output(printed(139, counts)).is_complete);
  const LtsminOutput failed =
      read_ltsmin_output(printed(255, "pins2lts-mc, ** error **: Library is not found\n" + counts));
  EXPECT_FALSE(failed.is_complete || failed.is_violated);
  EXPECT_EQ(failed.error, "pins2lts-mc, ** error **: Library is not found");
}

// The programs' places, the models' states, and what else the plug-in shows.
TEST(LtsminRun, IsReadByItsStates) {
  const System system = test::system_of("  p: 'via.write; sync.read;'\n");
  const GlobalState first = initial_state(system);
  const GlobalState second = apply(system, first, enabled_steps(system, first).front());
  const auto line = [](const GlobalState& state) {
    return fmt::format("{},{},{},true,\"p via?write\"\n", state.programs[0], state.models[0],
                       state.models[1]);
  };
  const std::string names = "p_p:state,m_via:state,m_sync:state,guard_0:guard,action:action\n";
  const Trace trace = read_ltsmin_run(names + line(first) + line(second), system);
  ASSERT_EQ(trace.steps.size(), 1u);
  EXPECT_EQ(replay(system, trace).back(), second);
  const auto refused = [&](const std::string& lines) {
    try {
      read_ltsmin_run(names + lines, system);
    } catch (const std::logic_error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_THAT(refused(""), HasSubstr("empty"));
  EXPECT_THAT(refused("0,0,zero,a\n"), HasSubstr("no state: 0,0,zero,a"));
  EXPECT_THAT(refused("0,0\n"), HasSubstr("no state"));
  EXPECT_THAT(refused(line(second)), HasSubstr("does not begin"));
  EXPECT_THAT(refused(line(first) + "2,0,0,\n"), HasSubstr("not possible"));
}

TEST(LtsminEngine, SaysWhatItDoesNotCheck) {
  const System system = test::system_of("  p: 'loop { @there via.write; via.read -> message; }'\n",
                                        "  a: {always: '!p@end'}\n"
                                        "  b: {always: '!via.write || p@there'}\n"
                                        "  c: {ltl: 'G F p@there'}\n");
  const LtsminEngine engine;
  const auto obstacle = [&](const std::string& name) {
    return engine.obstacle(system, find_property(system, name));
  };
  for (const char* name : {"deadlock", "error", "a"}) EXPECT_EQ(obstacle(name), "") << name;
  EXPECT_THAT(obstacle("stuck"), HasSubstr("does not check 'stuck'"));
  EXPECT_THAT(obstacle("b"), HasSubstr("this sees events, and not states alone"));
  EXPECT_THAT(obstacle("c"), HasSubstr("this is no `always`"));
}

// A script in the place of pins2lts-mc.
class LtsminStandIn : public testing::Test {
 protected:
  LtsminOptions script(const std::string& text) const {
    const std::filesystem::path path = folder_.path() / "explorer";
    write_file_atomically(path, "#!/bin/sh\n" + text);
    std::filesystem::permissions(path, std::filesystem::perms::owner_all);
    LtsminOptions options;
    options.explorer = path.string();
    return options;
  }

  PropertyResult check(const LtsminOptions& tools, const EngineOptions& options = {}) const {
    return LtsminEngine(tools).check(system_, test::deadlock_property(), options);
  }

  TempDir folder_;
  System system_ = test::system_of("  p: via.write;\n");
};

TEST_F(LtsminStandIn, IsGivenThePlugInAndTheQuestion) {
  LtsminOptions tools = script("echo \"$@\" > '" + (folder_.path() / "seen").string() +
                               "'; test -s ./system.so || exit 7\n"
                               "echo ': Explored 2 states 1 transitions' >&2\n");
  EngineOptions options;
  options.threads = 3;
  options.memory_mib = 1024;
  const PropertyResult result = check(tools, options);
  EXPECT_EQ(result.verdict, Verdict::holds);
  EXPECT_EQ(result.states, 2u);
  EXPECT_EQ(read_file(folder_.path() / "seen"),
            "--strategy=bfs --procs=3 -s26 --deadlock ./system.so\n");
}

TEST_F(LtsminStandIn, WhatItDoesNotFinishIsInconclusive) {
  EngineOptions options;
  options.memory_mib = 64;
  const PropertyResult full = check(
      script("echo ': Error: tree roots table full!'; echo ': Explored 9 states 9 transitions'\n"),
      options);
  EXPECT_EQ(full.verdict, Verdict::inconclusive);
  EXPECT_EQ(full.reason, "the search needs more than 64 MiB of memory");
  const PropertyResult failed = check(script("echo ', ** error **: no such thing'; exit 255\n"));
  EXPECT_EQ(failed.verdict, Verdict::inconclusive);
  EXPECT_EQ(failed.reason, "LTSmin did not complete the search: , ** error **: no such thing");
}

TEST_F(LtsminStandIn, StopsInTime) {
  EngineOptions options;
  const auto start = std::chrono::steady_clock::now();
  options.control.deadline = start + std::chrono::seconds(3);
  const PropertyResult result = check(script("sleep 1000\n"), options);
  EXPECT_EQ(result.verdict, Verdict::inconclusive);
  EXPECT_EQ(result.reason, "out of time");
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(60));
}

TEST_F(LtsminStandIn, ToolsThatAreMissingAreNamed) {
  LtsminOptions tools;
  tools.explorer = "/nowhere/pins2lts-mc";
  EXPECT_THAT(test::error_of([&] { check(tools); }),
              HasSubstr("'/nowhere/pins2lts-mc' cannot be run: `maide doctor` says"));
  tools.compiler = "/nowhere/c++";
  EXPECT_THAT(test::error_of([&] { check(tools); }),
              HasSubstr("the engine ltsmin needs a C++ compiler"));
}

// A run that is no run of the system is an error of Maide's own, and never shown.
TEST_F(LtsminStandIn, ItsRunsAreHeldAgainstTheSystem) {
  LtsminOptions tools =
      script("echo ': Deadlock found'; echo ': Explored 1 states 1 transitions'; exit 1\n");
  tools.printer = "/bin/cp";  // of run.gcf, which the next line makes, to run.csv
  tools.explorer =
      script("printf 'names\\n0,0,0,a\\n' > run.gcf; echo ': Deadlock found'; exit 1\n").explorer;
  EXPECT_THROW(check(tools), std::logic_error);
}

}  // namespace
}  // namespace maide
