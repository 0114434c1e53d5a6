// Machines that hide something: the default tests find it, or say that the model is weak. Uniform
// random machines, which the other laws draw, hide nothing.
#include <gtest/gtest.h>

#include <string>

#include "maide/automata/compare.hpp"
#include "maide/automata/minimize.hpp"
#include "maide/automata/random_automata.hpp"
#include "maide/base/error.hpp"
#include "maide/conformance/method/test_chain.hpp"
#include "maide/learn/cache/cache.hpp"
#include "maide/learn/learner.hpp"
#include "maide/learn/oracle/mealy_oracle.hpp"

namespace maide {
namespace {

class HidingLaws : public testing::TestWithParam<std::string_view> {
 protected:
  Hiding hiding() const { return find_hiding(GetParam()); }
};

INSTANTIATE_TEST_SUITE_P(All, HidingLaws, testing::ValuesIn(hiding_names()),
                         [](const auto& entry) { return std::string(entry.param); });

TEST_P(HidingLaws, MachinesAreMinimalAndTheSameForTheSameSeed) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Random random(seed), same(seed);
    const std::size_t states = 4 + 3 * seed, inputs = 4 + seed;
    const Mealy machine = hiding_mealy(hiding(), states, inputs, random);
    EXPECT_TRUE(machine.is_complete());
    EXPECT_EQ(minimize(machine).size(), machine.size());
    EXPECT_EQ(find_difference(machine, hiding_mealy(hiding(), states, inputs, same)), std::nullopt);
  }
  Random random(1);
  EXPECT_THROW(hiding_mealy(hiding(), 3, 10, random), UsageError);
  EXPECT_THROW(find_hiding("nowhere"), UsageError);
}

// The parts of a machine find inputs that do nothing yet, or do without.
TEST_P(HidingLaws, FourInputsAreEnough) {
  Random random(5);
  for (int i = 0; i < 300; ++i) {
    const Mealy machine = hiding_mealy(hiding(), 4 + random.below(40), 4, random);
    EXPECT_TRUE(machine.is_complete());
    EXPECT_EQ(machine.inputs().size(), 4U);
  }
}

TEST_P(HidingLaws, NoModelIsSilentlyWrong) {
  Random random(11);
  int weak = 0, machines = 12;
  for (int i = 0; i < machines; ++i) {
    const Mealy machine =
        hiding_mealy(hiding(), 4 + random.below(40), 4 + random.below(16), random);
    MealyOracle oracle(machine);
    Cache cache(oracle);
    const auto tests = TestChain("").make({cache, &cache, nullptr}, TestMethodOptions());
    const auto learner = find_deterministic_learner("lsharp").make(cache);
    const Mealy model = run_learner(*learner, *tests).model;
    const std::string shortfall = describe_shortfall(
        tests->strength(), default_demand(model.size(), model.inputs().size(), 0));
    weak += shortfall.empty() ? 0 : 1;
    if (!shortfall.empty()) continue;
    EXPECT_EQ(find_difference(model, machine), std::nullopt)
        << "machine " << i << ": " << model.size() << " of " << machine.size() << " states";
  }
  EXPECT_LE(weak, machines / 4);
}

}  // namespace
}  // namespace maide
