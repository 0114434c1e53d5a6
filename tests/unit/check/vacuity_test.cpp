// Formulas that hold and say nothing.
#include "maide/check/verdict/vacuity.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "maide/check/engines/engine.hpp"
#include "maide/check/verdict/check_system.hpp"
#include "systems.hpp"

namespace maide {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

// One program that writes and another that reads, for ever; `never` is a label that control does
// not come to.
System pair_with(const std::string& properties) {
  return parse_system(
      "models: {q: {use: queue, with: {size: 1}}}\nvariables: \"var s: 0..1;\"\n"
      "programs:\n"
      "  a: \"loop { @w q.write; }\"\n"
      "  b: \"loop { q.read -> message; if (s == 1) { @never skip; } @got skip; }\"\n"
      "properties:\n" +
          properties,
      "system.yaml", test::test_model);
}

std::string reason_of(const System& system, const std::string& property) {
  NativeEngine engine;
  CheckRequest request;
  request.properties = {property};
  request.options.threads = 1;
  const CheckReport report = check_system(system, engine, request);
  EXPECT_EQ(report.properties.front().verdict, Verdict::holds) << property;
  return report.properties.front().reason;
}

std::vector<std::string> premises(const std::string& formula) {
  const System system = pair_with("  f: \"" + formula + "\"\n");
  const std::vector<ProgramInterface> interfaces = system.interfaces();
  const FormulaScope scope{system.programs, interfaces, system.expressions, &system.words};
  std::vector<std::string> result;
  for (const Premise& premise : premises_of(system.properties.front().formula)) {
    result.push_back(to_string(premise.premise, scope) + " in " + to_string(premise.denied, scope));
  }
  return result;
}

TEST(Vacuity, PremisesAreThoseOfImplicationsThatWeaken) {
  EXPECT_THAT(premises("G (a@w -> F b@got)"), ElementsAre("a@w in G !a@w"));
  EXPECT_THAT(premises("a@w -> X a@w -> b@got"),
              ElementsAre("a@w in !a@w", "X a@w in (a@w -> !X a@w)"));
  EXPECT_THAT(premises("F a@w || (a@w -> b@got) U b@got"),
              ElementsAre("a@w in (F a@w || (!a@w U b@got))"));
  EXPECT_THAT(premises("!(a@w -> b@got)"), IsEmpty());
  EXPECT_THAT(premises("(a@w -> b@got) -> a@w"), ElementsAre("(a@w -> b@got) in !(a@w -> b@got)"));
  EXPECT_THAT(premises("!((a@w -> b@got) -> a@w) && F a@w"), ElementsAre("a@w in !(!a@w -> a@w)"));
  EXPECT_THAT(premises("a@w <-> (a@w -> b@got)"), IsEmpty());
}

TEST(Vacuity, SaysThatAPremiseNeverComesTrue) {
  const System system = pair_with(
      "  start: \"b@got -> F !a@w\"\n"
      "  label: \"G (b@never -> F b@got)\"\n"
      "  behind: \"G (a@w -> F (b@got || a@w)) && (G F b@never -> G F b@got)\"\n"
      "  always: {always: b@never -> a@w}\n"
      "  fine: {ltl: \"G (b@got -> F a@w)\", fairness: strong}\n"
      "  often: \"G F a@w -> G F b@got\"\n"
      "  plain: \"G F b@got\"\n");
  EXPECT_THAT(reason_of(system, "start"), HasSubstr("never comes true where it is asked: b@got"));
  EXPECT_THAT(reason_of(system, "label"), HasSubstr("asked: b@never"));
  EXPECT_THAT(reason_of(system, "behind"), HasSubstr("asked: G F b@never"));
  EXPECT_THAT(reason_of(system, "always"), HasSubstr("asked: b@never"));
  EXPECT_EQ(reason_of(system, "fine"), "");
  EXPECT_EQ(reason_of(system, "often"), "");
  EXPECT_EQ(reason_of(system, "plain"), "");
}

TEST(Vacuity, SaysThatAFormulaHoldsOfEverything) {
  const System system = pair_with(
      "  truth: \"true\"\n"
      "  twice: \"F a@w -> F a@w\"\n"
      "  never: \"G (a@w && b@got && !a@w -> F false)\"\n"
      "  either: {always: a@w || !a@w}\n"
      "  fair: \"G F a@w -> G F a@w\"\n");
  for (const char* property : {"truth", "twice", "never", "either", "fair"}) {
    EXPECT_THAT(reason_of(system, property), HasSubstr("every run of everything")) << property;
  }
}

}  // namespace
}  // namespace maide
