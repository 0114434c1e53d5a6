// What a Mealy machine says of itself.
#include "maide/automata/mealy.hpp"

#include <gtest/gtest.h>

#include <set>
#include <thread>
#include <vector>

namespace maide {
namespace {

Mealy make_flip_flop() {
  Mealy machine({"a", "b"}, {"0", "1"}, 2);
  for (StateId state = 0; state < machine.size(); ++state) {
    machine.set_transition(state, 0, 0, 1);
    machine.set_transition(state, 1, 1, 0);
  }
  return machine;
}

TEST(MealyRevision, ChangesWithItsRowAlone) {
  Mealy machine = make_flip_flop();
  const std::uint64_t first = machine.revision(0), second = machine.revision(1);
  EXPECT_NE(first, second);
  machine.set_transition(1, 0, 1, 0);
  EXPECT_EQ(machine.revision(0), first);
  EXPECT_NE(machine.revision(1), second);
  EXPECT_EQ(machine.revision(machine.add_state()), 0U);
}

TEST(MealyRevision, OfACopyStaysUntilOneOfThemChanges) {
  Mealy machine = make_flip_flop();
  Mealy copy = machine;
  EXPECT_EQ(copy.revision(0), machine.revision(0));
  machine.set_transition(0, 0, 1, 0);
  copy.set_transition(0, 0, 1, 1);
  EXPECT_NE(copy.revision(0), machine.revision(0));
  EXPECT_EQ(copy.revision(1), machine.revision(1));
}

TEST(MealyRevision, IsNoOtherRowsInAnyThread) {
  constexpr std::size_t threads = 4, changes = 100'000;  // of which each takes numbers twice
  std::vector<std::vector<std::uint64_t>> revisions(threads);
  {
    std::vector<std::jthread> running;
    for (std::vector<std::uint64_t>& mine : revisions) {
      running.emplace_back([&mine] {
        Mealy machine = make_flip_flop();
        for (std::size_t i = 0; i < changes; ++i) {
          machine.set_transition(0, 0, 0, 1);
          mine.push_back(machine.revision(0));
        }
      });
    }
  }
  std::set<std::uint64_t> all;
  for (const std::vector<std::uint64_t>& mine : revisions) all.insert(mine.begin(), mine.end());
  EXPECT_EQ(all.size(), threads * changes);
}

}  // namespace
}  // namespace maide
