// The observation table by itself.
#include <gtest/gtest.h>

#include "maide/automata/compare.hpp"
#include "maide/learn/oracle/mealy_oracle.hpp"
#include "maide/learn/table/table_learners.hpp"

namespace maide {
namespace {

// Shows nothing but that the last of `size` states was left, to the first.
Mealy ticking_counter(std::size_t size) {
  Mealy machine({"tick"}, {"nothing", "full"}, size);
  for (StateId state = 0; state < size; ++state) {
    const bool is_last = state + 1 == size;
    machine.set_transition(state, 0, is_last ? 1 : 0, is_last ? 0 : state + 1);
  }
  return machine;
}

// The row that is like no other is made short by add_short_rows alone: no long row equals it.
TEST(ObservationTable, RowsOfACounterexampleBecomeStates) {
  const Mealy machine = ticking_counter(4);
  MealyOracle oracle(machine);
  ObservationTable table(oracle, FirstSuffixes::inputs);
  table.close({});
  table.check_invariants();
  EXPECT_EQ(table.state_count(), 1U);
  table.add_short_rows({0, 0, 0, 0});
  table.close({});
  table.check_invariants();
  EXPECT_EQ(table.state_count(), 2U);
  while (const auto suffix = table.find_inconsistency()) {
    ASSERT_TRUE(table.add_suffix(*suffix));
    table.close({});
    table.check_invariants();
  }
  EXPECT_EQ(table.state_count(), 4U);
  EXPECT_FALSE(find_difference(table.make_hypothesis().machine, machine));
}

}  // namespace
}  // namespace maide
