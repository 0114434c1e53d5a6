// LTSmin on random systems with fixed seeds: each of its backends counts the states of the system,
// and the engine comes to the verdicts of Maide's own, with runs that are as short.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <optional>
#include <regex>

#include "joint_systems.hpp"
#include "maide/base/file.hpp"
#include "maide/base/subprocess.hpp"
#include "maide/check/engines/export/system_exporters.hpp"
#include "maide/check/engines/ltsmin_engine.hpp"
#include "maide/check/verdict/check_system.hpp"
#include "maide/experiment/open_system.hpp"
#include "random_system.hpp"

namespace maide {
namespace {

Property property_of(Property::Kind kind, const std::string& name) {
  Property property;
  property.name = name;
  property.kind = kind;
  return property;
}
const Property deadlock = property_of(Property::Kind::deadlock, "deadlock");
const Property error = property_of(Property::Kind::error, "error");

// Each third without joint steps, and each third with deaths.
System some_system(Random& random, int number) {
  System system = number % 3 == 0 ? test::random_system(random)
                                  : test::random_joint_system(
                                        random, {1, 3, 3, 0.5, 0.5},
                                        {true, number % 3 == 1, true, false, number % 2 == 1});
  if (number % 2 == 0) {
    for (ModelInstance& model : system.models) model.when_unexplored = WhenUnexplored::stop;
  }
  return system;
}

// `G !(the last program has ended)`.
Property never_ends(const System& system) {
  FormulaNode atom, negation, always;
  atom.op = FormulaNode::Operator::atom;
  atom.atom = {Atom::Kind::end, static_cast<std::uint32_t>(system.programs.size() - 1), 0};
  negation.op = FormulaNode::Operator::negation;
  negation.left = std::make_shared<const FormulaNode>(atom);
  always.op = FormulaNode::Operator::globally;
  always.left = std::make_shared<const FormulaNode>(negation);
  Property property = property_of(Property::Kind::ltl, "goes on: for ever");
  property.formula = std::make_shared<const FormulaNode>(always);
  return property;
}

TEST(LtsminSystems, TheEngineHasTheVerdictsOfOurs) {
  if (!find_on_path("pins2lts-mc")) GTEST_SKIP() << "skipped: no LTSmin";
  EngineOptions options;
  options.memory_mib = 256;
  Random random(61);
  int violated = 0, cuts = 0;
  for (int number = 0; number < 12; ++number) {
    const System system = some_system(random, number);
    NativeEngine ours;
    LtsminEngine theirs;
    for (const Property& property : {deadlock, error, never_ends(system)}) {
      const PropertyResult expected = ours.check(system, property, {});
      const PropertyResult found = theirs.check(system, property, options);
      ASSERT_EQ(found.verdict, expected.verdict) << property.name << test::show(system);
      if (found.verdict == Verdict::holds) {
        EXPECT_EQ(found.states, expected.states);
        EXPECT_EQ(found.transitions > 0, expected.transitions > 0);
      } else {
        ASSERT_TRUE(found.trace);
        EXPECT_EQ(found.trace->steps.size(), expected.trace->steps.size());
        ++violated;
      }
    }
    const CutResult expected = ours.find_cut(system, {});
    const CutResult found = theirs.find_cut(system, options);
    ASSERT_EQ(found.verdict, expected.verdict) << test::show(system);
    if (!found.trace) continue;
    ++cuts;
    EXPECT_EQ(found.trace->steps.size(), expected.trace->steps.size());
    EXPECT_TRUE(replay(system, *found.trace).back().is_cut);
  }
  EXPECT_GT(violated, 10);
  EXPECT_GT(cuts, 0);
}

class Backends : public testing::Test {
 protected:
  void load(const System& system) {
    std::ofstream text(path("system.cpp"));
    write_pins(text, system, {});
    text.close();
    run({"c++", "-std=c++17", "-O1", "-shared", "-fPIC", "-o", path("system.so"),
         path("system.cpp")});
  }
  std::string path(const char* name) const { return (folder_.path() / name).string(); }
  // What the backend prints; of a violation, too.
  std::string run(std::vector<std::string> command, bool may_find = false) const {
    const SubprocessResult result = run_program(command);
    EXPECT_TRUE(result.succeeded() || (may_find && result.exit_status == 1))
        << result.out << result.err;
    return result.out + result.err;
  }
  std::string explore(std::vector<std::string> command, bool may_find = false) const {
    command.push_back(path("system.so"));
    return run(command, may_find);
  }
  static std::string count(const std::string& text) {
    std::smatch found;
    const std::regex pattern("(?:Explored|state space(?: has)?)(?: \\d+ levels,?)? (\\d+) states");
    return std::regex_search(text, found, pattern) ? found[1].str() : text;
  }
  TempDir folder_;
};

TEST_F(Backends, CountTheStatesAndAgreeOnDeadlocks) {
  if (!find_on_path("pins2lts-mc")) GTEST_SKIP() << "skipped: no LTSmin";
  Random random(62);
  int compared = 0, deadlocks = 0;
  for (int number = 1; compared < 4; ++number) {
    const System system = some_system(random, 3 * number + 2);  // without deaths
    const PropertyResult expected = NativeEngine().check(system, deadlock, {});
    const PropertyResult whole =
        NativeEngine().check(system, property_of(Property::Kind::error, "error"), {});
    if (whole.verdict != Verdict::holds || whole.states < 20) continue;
    ++compared;
    load(system);
    const std::string states = std::to_string(whole.states);
    EXPECT_EQ(count(explore({"pins2lts-mc", "--procs=2", "-s20"})), states);
    EXPECT_EQ(count(explore({"pins2lts-seq"})), states);
    if (find_on_path("pins2lts-sym")) {
      EXPECT_EQ(count(explore({"pins2lts-sym"})), states);
    }
    if (find_on_path("pins2lts-dist") && find_on_path("mpirun")) {
      EXPECT_EQ(count(explore({"mpirun", "--allow-run-as-root", "--oversubscribe", "-n", "2",
                               "pins2lts-dist"})),
                states);
    }
    const bool is_violated = expected.verdict == Verdict::violated;
    deadlocks += is_violated ? 1 : 0;
    // With each of its reductions.
    for (const char* reduction : {"--por=heur", "--por=del"}) {
      const std::string text =
          explore({"pins2lts-mc", "--procs=1", "-s20", "--deadlock", reduction}, true);
      EXPECT_EQ(text.find("Deadlock found") != std::string::npos, is_violated) << text;
      EXPECT_THAT(text, testing::HasSubstr("Initializing POR dependencies"));
    }
  }
  EXPECT_GT(deadlocks, 0);
}

}  // namespace
}  // namespace maide
