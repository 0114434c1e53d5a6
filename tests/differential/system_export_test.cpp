// Systems in other languages against their meaning (check/system/system.hpp): on random systems
// with fixed seeds, with joint steps and without, in all three ways of meeting the bound, as many
// states, steps and deadlocks.
// SMV and mCRL2 are explored by small readers of the part of these languages that the exports use
// (explore_smv.py, explore_mcrl2.py), and by NuSMV and mCRL2 themselves where they are installed.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <deque>
#include <map>
#include <optional>
#include <set>
#include <sstream>
#include <tuple>

#include "joint_systems.hpp"
#include "maide/base/error.hpp"
#include "maide/base/file.hpp"
#include "maide/base/subprocess.hpp"
#include "maide/check/engines/export/step_action.hpp"
#include "maide/check/engines/export/system_exporters.hpp"
#include "maide/experiment/open_system.hpp"
#include "random_system.hpp"

namespace maide {
namespace {

constexpr std::size_t state_limit = 250;
constexpr std::uint64_t memory = std::uint64_t{64} << 20;

struct Graph {
  std::size_t states = 0, all_steps = 0;
  std::size_t steps = 0;  // those that differ in what is done or what comes of it
  std::size_t dead = 0;   // states without a step
  bool has_deadlock = false, has_error = false, may_err = false;
};

// Straight from the meaning: a cut stays where it is. Nothing if there are too many states.
std::optional<Graph> explore(const System& system) {
  using Key = std::pair<std::vector<StateId>, std::vector<ControlState>>;
  std::map<Key, bool> seen;
  std::deque<GlobalState> open;
  const auto visit = [&](const GlobalState& state) {
    if (seen.emplace(Key{state.models, state.programs}, true).second) open.push_back(state);
  };
  visit(initial_state(system));
  Graph graph;
  for (; !open.empty(); open.pop_front()) {
    if (seen.size() > state_limit) return std::nullopt;
    const auto steps = enabled_steps(system, open.front());
    std::set<std::tuple<StepAction, std::vector<StateId>, ControlState>> distinct;
    for (const Step& step : steps) {
      const bool stays = step.is_cut || step.actor == nobody;  // the program
      const ControlState target = stays ? 0 : edge_of(system, step).target;
      distinct.emplace(action_of(system, step), step.is_cut ? std::vector<StateId>() : step.targets,
                       target);
    }
    graph.all_steps += steps.size();
    graph.steps += distinct.size();
    graph.has_error = graph.has_error || is_error(system, open.front());
    graph.dead += steps.empty() ? 1 : 0;
    graph.has_deadlock = graph.has_deadlock || is_deadlock(system, open.front());
    for (const Step& step : steps) {
      const GlobalState next = apply(system, open.front(), step);
      if (!next.is_cut) visit(next);
    }
  }
  graph.states = seen.size();
  for (const Program& program : system.programs) {
    for (ControlState state = 0; state < program.states.size(); ++state) {
      graph.may_err = graph.may_err || program.is_error(state);
    }
  }
  return graph;
}

std::string text_of(const System& system, std::string_view format) {
  std::ostringstream out;
  find_system_exporter(format).write(out, system, {memory, {}});
  return out.str();
}

std::string run(const std::vector<std::string>& command) {
  const SubprocessResult result = run_program(command);
  EXPECT_TRUE(result.succeeded()) << result.out << result.err;
  return result.out;
}

// Every other system has joint steps, and half of these deaths, errors and places to rest, and half
// of all of these what happens by itself.
template <typename Compare>
void for_random_systems(std::uint64_t seed, int count, Compare compare) {
  Random random(seed);
  int deadlocks = 0;
  for (int compared = 0; compared < count;) {
    const bool has_more = compared % 4 == 1;
    const bool has_nobody = compared % 8 == 1 || compared % 8 == 3;
    const System system =
        compared % 2 == 0
            ? test::random_system(random)
            : test::random_joint_system(random, {1, 3, 3, 0.5, 0.5},
                                        {has_more, has_more, has_more, false, has_nobody});
    const std::optional<Graph> graph = explore(system);
    if (!graph || graph->states < 4) continue;
    ++compared;
    deadlocks += graph->has_deadlock ? 1 : 0;
    compare(system, *graph);
    if (testing::Test::HasFailure()) break;
  }
  EXPECT_GT(deadlocks, 0);
}

TEST(SystemExport, AutIsTheStateGraph) {
  // No two steps have one label.
  for_random_systems(51, 300, [](const System& system, const Graph& graph) {
    const std::string text = text_of(system, "aut");
    std::istringstream lines(text);
    std::string line;
    std::getline(lines, line);
    EXPECT_EQ(line, "des (0, " + std::to_string(graph.all_steps) + ", " +
                        std::to_string(graph.states) + ")");
    std::set<std::string> distinct;
    while (std::getline(lines, line)) distinct.insert(line);
    EXPECT_EQ(distinct.size(), graph.steps) << test::show(system) << text;
  });
}

// Python starts slowly where it is asked often: the script explores all files at once, and prints a
// line for each.
template <typename Line>
void expect_explored(std::uint64_t seed, const std::string& format, Line expected_line) {
  const TempDir folder;
  std::vector<std::string> command{
      "python3", MAIDE_SOURCE_DIR "/tests/differential/explore_" + format + ".py"};
  std::string expected;
  for_random_systems(seed, 80, [&](const System& system, const Graph& graph) {
    command.push_back((folder.path() / std::to_string(command.size())).string());
    write_file_atomically(command.back(), text_of(system, format));
    expected += expected_line(graph) + "\n";
  });
  EXPECT_EQ(run(command), expected);
}

std::string counts(const Graph& graph) {
  return "states " + std::to_string(graph.states) + " steps " + std::to_string(graph.steps);
}

TEST(SystemExport, SmvHasTheSameStatesAndSteps) {
  expect_explored(52, "smv", [](const Graph& graph) {
    const auto line = [](bool is_bad) {
      return std::string(" invariant ") + (is_bad ? "false" : "true");
    };
    return counts(graph) + line(graph.has_deadlock) + (graph.may_err ? line(graph.has_error) : "");
  });
}

TEST(SystemExport, Mcrl2HasTheSameStatesAndSteps) {
  expect_explored(53, "mcrl2", [](const Graph& graph) {
    return counts(graph) + " dead " + std::to_string(graph.dead);
  });
}

TEST(SystemExport, NuSmvCountsTheSameStates) {
  if (!find_on_path("NuSMV")) GTEST_SKIP() << "skipped: no NuSMV on PATH";
  const TempDir folder;
  const std::string file = (folder.path() / "system.smv").string();
  for_random_systems(54, 20, [&](const System& system, const Graph& graph) {
    write_file_atomically(file, text_of(system, "smv"));
    const std::string out = run({"NuSMV", "-r", file});
    EXPECT_THAT(out, testing::HasSubstr("reachable states: " + std::to_string(graph.states) + " "));
    EXPECT_EQ(out.find("is false") != std::string::npos, graph.has_deadlock || graph.has_error);
  });
}

TEST(SystemExport, Mcrl2CountsTheSameStates) {
  if (!find_on_path("mcrl22lps")) GTEST_SKIP() << "skipped: no mcrl22lps on PATH";
  const TempDir folder;
  const auto path = [&](const char* name) { return (folder.path() / name).string(); };
  for_random_systems(55, 20, [&](const System& system, const Graph& graph) {
    write_file_atomically(path("system.mcrl2"), text_of(system, "mcrl2"));
    run({"mcrl22lps", path("system.mcrl2"), path("system.lps")});
    run({"lps2lts", path("system.lps"), path("system.aut")});
    const std::string written = read_file(path("system.aut"));
    EXPECT_EQ(written.substr(0, written.find('\n')),
              "des (0," + std::to_string(graph.steps) + "," + std::to_string(graph.states) + ")");
  });
}

TEST(SystemExport, StopsWhenAskedAndAtTheLimit) {
  Random random(56);
  System system = test::random_system(random);
  std::ostringstream out;
  std::stop_source stop;
  stop.request_stop();
  EXPECT_THROW(write_aut(out, system, memory, {stop.get_token(), {}, nullptr}), Interrupted);
  try {
    write_aut(out, system, 1, {});
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.status(), ExitStatus::inconclusive);
    EXPECT_THAT(error.what(), testing::HasSubstr("memory"));
  }
}

}  // namespace
}  // namespace maide
