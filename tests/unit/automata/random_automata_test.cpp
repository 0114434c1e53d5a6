// Random machines: reachable, complete, and the same for the same seed.
#include "maide/automata/random_automata.hpp"

#include <gtest/gtest.h>

#include <sstream>

#include "maide/automata/minimize.hpp"
#include "maide/base/error.hpp"
#include "maide/formats/model_file.hpp"

namespace maide {
namespace {

TEST(RandomAutomata, MealyMachinesAreCompleteAndReachable) {
  Random random(5);
  for (int round = 0; round < 100; ++round) {
    const RandomMealyOptions options{1 + random.below(30), 1 + random.below(4),
                                     1 + random.below(4)};
    const Mealy machine = random_mealy(options, random);
    EXPECT_TRUE(machine.is_complete());
    EXPECT_EQ(machine.size(), options.states);
    EXPECT_EQ(breadth_first(machine).size(), options.states);
  }
}

TEST(RandomAutomata, DeterminismOfInterfaceAutomataIsAsAsked) {
  Random random(6);
  int nondeterministic = 0;
  for (int round = 0; round < 50; ++round) {
    RandomInterfaceAutomatonOptions options;
    EXPECT_TRUE(random_interface_automaton(options, random).is_deterministic());
    options.deterministic = false;
    nondeterministic += random_interface_automaton(options, random).is_deterministic() ? 0 : 1;
  }
  EXPECT_GT(nondeterministic, 40);
}

// The very machine, so that a change of the generator is noticed: seeds stand in reports.
TEST(RandomAutomata, ASeedMeansTheSameMachineEverywhere) {
  Random random(7);
  std::ostringstream out;
  write_dot(out, random_mealy({2, 2, 2}, random));
  EXPECT_EQ(out.str(), R"(digraph g {
  inputs="i0,i1";
  outputs="o0,o1";
  __start0 [label="" shape="none"];
  s0 [shape="circle" label="s0"];
  s1 [shape="circle" label="s1"];
  __start0 -> s0;
  s0 -> s1 [label="i0 / o0"];
  s0 -> s0 [label="i1 / o0"];
  s1 -> s0 [label="i0 / o1"];
  s1 -> s0 [label="i1 / o0"];
}
)");
}

TEST(RandomAutomata, ImpossibleSizesAreRefused) {
  Random random(8);
  EXPECT_THROW(random_mealy({0, 1, 1}, random), UsageError);
  EXPECT_THROW(random_mealy({2, 0, 1}, random), UsageError);
  EXPECT_THROW(random_interface_automaton({1, 0, 0}, random), UsageError);
}

}  // namespace
}  // namespace maide
