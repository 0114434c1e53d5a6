// Steps that no formula sees.
#include <gtest/gtest.h>

#include "maide/check/reduce/reduction.hpp"
#include "systems.hpp"

namespace maide {
namespace {

System two_programs() {
  return test::system_of("  p: '@a via.write; @b via.write;'\n  q: 'loop { sync.write; }'\n");
}

Formula parse(const std::string& text, const System& system) {
  const std::vector<ProgramInterface> interfaces = system.interfaces();
  return parse_formula(ScalarText(text, text, {"f", 1, 1}), {system.programs, interfaces});
}

TEST(SilentSteps, FormulasThatIgnoreThem) {
  const System system = two_programs();
  for (const std::string text :
       {"p@a U p@b", "G (p@a -> F p@b)", "!(p@a R (p@b W p@end))", "G !via.write", "F via.write",
        "G F via.write", "F G !via.write", "G (via.write -> F sync.write)", "G (via.write -> !p@b)",
        "!sync.write W via.write"}) {
    EXPECT_TRUE(ignores_silent_steps(parse(text, system))) << text;
  }
}

TEST(SilentSteps, FormulasThatSeeThem) {
  const System system = two_programs();
  for (const std::string text :
       {"X p@a", "G (p@a -> X p@b)", "F !via.write", "F G via.write", "via.write U sync.write",
        "F (p@b && !via.write)", "G (via.write || p@a)"}) {
    EXPECT_FALSE(ignores_silent_steps(parse(text, system))) << text;
  }
}

TEST(SilentSteps, StepsThatChangeALabelOrAreAnEventAreVisible) {
  const System system = two_programs();
  using Edges = std::vector<std::vector<bool>>;
  EXPECT_EQ(visible_edges(parse("p@a", system), system), (Edges{{true, false}, {false}}));
  EXPECT_EQ(visible_edges(parse("p@end", system), system), (Edges{{false, true}, {false}}));
  EXPECT_EQ(visible_edges(parse("sync.write", system), system), (Edges{{false, false}, {true}}));
}

}  // namespace
}  // namespace maide
