// Systems of several components: what is decided in each, and what is added up.
#include "maide/check/system/components.hpp"

#include <gtest/gtest.h>

#include "maide/check/verdict/check_system.hpp"
#include "systems.hpp"

namespace maide {
namespace {

// Two pairs that have nothing to do with one another: one of them deadlocks.
constexpr const char* two_pairs =
    "  writer: loop { via.write; }\n"
    "  reader: loop { via.read -> message; }\n"
    "  sender: \"@first sync.write; @second stop;\"\n"
    "  taker: \"sync.read -> message; sync.read -> message;\"\n";

const PropertyResult& result_of(const CheckReport& report, const std::string& name) {
  for (const PropertyResult& result : report.properties) {
    if (result.name == name) return result;
  }
  throw std::out_of_range(name);
}

CheckReport check(const System& system, const std::vector<std::string>& properties = {}) {
  NativeEngine engine;
  CheckRequest request;
  request.properties = properties;
  return check_system(system, engine, request);
}

using Components = std::vector<std::vector<std::uint32_t>>;

TEST(Components, AreProgramsThatNameTheSame) {
  const System system = test::system_of(two_pairs);
  EXPECT_EQ(find_components(system), (Components{{0, 1}, {2, 3}}));
}

TEST(Components, ANameCountsThoughNoStepUsesIt) {
  System system = test::system_of(two_pairs);
  system.programs[2].names = {0};
  EXPECT_EQ(find_components(system), (Components{{0, 1, 2, 3}}));
}

// Beside a pair that goes on for ever.
TEST(Components, ADeadlockIsOneOfItsComponent) {
  const System system = test::system_of(two_pairs, "", "wait");
  const CheckReport report = check(system);
  const PropertyResult& deadlock = result_of(report, "deadlock");
  ASSERT_EQ(deadlock.verdict, Verdict::violated);
  EXPECT_EQ(deadlock.programs, (std::vector<std::uint32_t>{2, 3}));
  for (const Step& step : deadlock.trace->steps) EXPECT_GE(step.actor, 2U);
  const Shown shown = shown_part(system, deadlock);
  ASSERT_EQ(shown.part.system().programs.size(), 2U);
  EXPECT_EQ(shown.part.system().programs[1].name, "taker");
  EXPECT_EQ(find_flaw(shown.part.system(), shown.property, shown.trace), "");
  ASSERT_EQ(report.components.size(), 2U);
  EXPECT_EQ(deadlock.states, report.components[0].states + report.components[1].states);
}

TEST(Components, AViolationLeavesNoComponentOut) {
  const System system = test::system_of("  a: via.read -> message;\n  b: sync.read -> message;\n");
  const CheckReport report = check(system);
  const PropertyResult& deadlock = result_of(report, "deadlock");
  EXPECT_EQ(deadlock.verdict, Verdict::violated);
  EXPECT_EQ(deadlock.programs, (std::vector<std::uint32_t>{0}));
  EXPECT_EQ(deadlock.reason, "2 of 2 components violate it, and the first is shown");
  ASSERT_EQ(report.components.size(), 2U);
  for (const CheckReport::Component& component : report.components) {
    EXPECT_EQ(component.states, 2U);
    EXPECT_EQ(component.verdicts.at("deadlock"), Verdict::violated);
    EXPECT_EQ(component.verdicts.at("stuck"), Verdict::holds);
  }
}

// In the whole system the other pair could go on.
TEST(Components, AClaimIsHeldAgainstItsComponent) {
  const System system = test::system_of(two_pairs, "", "wait");
  const PropertyResult deadlock = result_of(check(system), "deadlock");
  const Property property = find_property(system, "deadlock");
  EXPECT_NE(find_flaw(system, property, *deadlock.trace), "");
  EXPECT_EQ(find_flaw_in_parts(system, property, *deadlock.trace), "");
  const GlobalState last = replay(system, *deadlock.trace).back();
  EXPECT_EQ(deadlocked_programs(system, last), (std::vector<std::uint32_t>{2, 3}));
  EXPECT_TRUE(deadlocked_programs(system, initial_state(system)).empty());
  Trace shorter = *deadlock.trace;
  shorter.steps.pop_back();
  EXPECT_NE(find_flaw_in_parts(system, property, shorter), "");
}

// `X` sees no steps of other components; the formula of both sees them all.
TEST(Components, AFormulaRunsWhereItsAtomsAre) {
  const System system =
      test::system_of(two_pairs,
                      "  next: {ltl: \"sender@first && X sender@second\", fairness: none}\n"
                      "  both: {ltl: \"G !via.write || sender@first U sender@second\"}\n",
                      "wait");
  const CheckReport report = check(system, {"next", "both"});
  EXPECT_EQ(result_of(report, "next").verdict, Verdict::violated);
  EXPECT_EQ(result_of(report, "next").programs, (std::vector<std::uint32_t>{2, 3}));
  EXPECT_TRUE(result_of(report, "both").programs.empty());
  EXPECT_EQ(result_of(report, "both").verdict, Verdict::holds);
}

TEST(Components, AThousandAreASum) {
  System system = test::system_of("  p0: loop { sync.write; sync.read -> message; }\n",
                                  "  writes: G F p0@end\n");
  const CheckReport one = check(system, {"deadlock", "stuck"});
  for (std::uint32_t i = 1; i < 1000; ++i) {
    ModelInstance model = system.models[1];
    model.name += std::to_string(i);
    system.models.push_back(std::move(model));
    Program program = system.programs[0];
    program.name = "p" + std::to_string(i);
    for (ProgramEdge& edge : program.edges) {
      edge.model = static_cast<std::uint32_t>(system.models.size() - 1);
    }
    program.names = {static_cast<std::uint32_t>(system.models.size() - 1)};
    system.programs.push_back(std::move(program));
  }
  const CheckReport report = check(system, {"deadlock", "stuck", "writes"});
  EXPECT_EQ(report.components.size(), 1000U);
  for (const std::string name : {"deadlock", "stuck"}) {
    EXPECT_EQ(result_of(report, name).verdict, Verdict::holds);
    EXPECT_EQ(result_of(report, name).states, 1000 * result_of(one, name).states);
  }
  EXPECT_EQ(result_of(report, "writes").verdict, Verdict::violated);
  EXPECT_EQ(result_of(report, "writes").programs, std::vector<std::uint32_t>{0});
}

// The control state behind the first read of `taker` becomes an error.
System with_error() {
  System system = test::system_of(two_pairs, "  goes_on: G F via.write\n", "wait");
  Program& program = system.programs[3];
  program.errors = {{}, {"x = 4 is outside of 0..3", {"system.yaml", 8, 11}}};
  for (ControlState at = 0; at < program.states.size(); ++at) {
    for (const ProgramEdge& edge : program.edges_of(at)) {
      if (edge.kind != ModelUse::Kind::take) continue;
      program.states[edge.target].error = 1;
      program.states[edge.target].edge_count = 0;
      return system;
    }
  }
  return system;
}

// What the error is in is inconclusive; the other component is not touched.
TEST(Components, AnErrorStopsItsComponentAlone) {
  const System system = with_error();
  const CheckReport report = check(system, {"goes_on", "deadlock"});
  ASSERT_EQ(report.properties.size(), 3U);
  const PropertyResult& error = result_of(report, "error");
  EXPECT_EQ(error.verdict, Verdict::violated);
  EXPECT_EQ(error.reason, "taker: x = 4 is outside of 0..3 (system.yaml:8:11)");
  EXPECT_EQ(error.programs, (std::vector<std::uint32_t>{2, 3}));
  EXPECT_EQ(error.trace->steps.size(), 3U);
  const PropertyResult& deadlock = result_of(report, "deadlock");
  EXPECT_EQ(deadlock.verdict, Verdict::inconclusive);
  EXPECT_NE(deadlock.reason.find("x = 4 is outside of 0..3"), std::string::npos);
  EXPECT_EQ(result_of(report, "goes_on").verdict, Verdict::holds);
  EXPECT_EQ(report.verdict, Verdict::violated);
}

TEST(Components, WithoutErrorsTheirRowIsNotThere) {
  const CheckReport report = check(test::system_of(two_pairs, "", "wait"));
  EXPECT_THROW(result_of(report, "error"), std::out_of_range);
  EXPECT_EQ(result_of(check(test::system_of(two_pairs), {"error"}), "error").verdict,
            Verdict::holds);
}

TEST(Components, ANameSelectsAllItsInstances) {
  System system = test::system_of(two_pairs, "  fed: G F via.write\n  feds: G F via.write\n");
  system.properties[0].name = "fed[0]";
  system.properties.push_back(system.properties[0]);
  system.properties.back().name = "fed[1]";
  const auto found = find_properties(system, "fed");
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0].name, "fed[0]");
  EXPECT_EQ(found[1].name, "fed[1]");
  EXPECT_THROW(find_properties(system, "fe"), UsageError);
}

}  // namespace
}  // namespace maide
