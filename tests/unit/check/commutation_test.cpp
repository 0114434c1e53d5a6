#include "maide/check/reduce/commutation.hpp"

#include <gtest/gtest.h>

namespace maide {
namespace {

constexpr std::size_t up = 0, down = 1;
constexpr std::uint64_t ups = 1, downs = 2;

// Counts from 0 to 2.
ModelInstance counter() {
  ModelInstance model;
  model.name = "counter";
  model.automaton = InterfaceAutomaton(Alphabet({"up", "down"}), Alphabet({"none"}), 3);
  for (StateId count = 0; count < 2; ++count) {
    model.automaton.add_transition(count, {Action::Kind::input, up}, count + 1);
    model.automaton.add_transition(count + 1, {Action::Kind::input, down}, count);
  }
  return model;
}

std::vector<ModelUse> up_and_down() {
  return {{ModelUse::Kind::give, 0, up}, {ModelUse::Kind::give, 0, down}};
}

using States = std::vector<std::uint8_t>;

TEST(Commutation, ReadersDisturbWritersOnlyAtTheEnds) {
  Commutation commutation(counter(), up_and_down(), Commutation::Watch::nothing);
  EXPECT_EQ(commutation.undisturbed(up, downs), (States{1, 1, 0}));
  EXPECT_EQ(commutation.undisturbed(down, ups), (States{0, 1, 1}));
}

// Two that write want the last place.
TEST(Commutation, WhoDoesTheSameCompetes) {
  Commutation commutation(counter(), up_and_down(), Commutation::Watch::nothing);
  EXPECT_EQ(commutation.undisturbed(up, ups), (States{0, 0, 1}));
  EXPECT_EQ(commutation.undisturbed(up, 0), (States{1, 1, 1}));
}

// A write at 0 makes a read possible. Under weak fairness that matters at 1 only: from there a
// reader could have been seen both able and, at 0, unable.
TEST(Commutation, FairnessWatchesWhatBecomesPossible) {
  Commutation weak(counter(), up_and_down(), Commutation::Watch::weak);
  EXPECT_EQ(weak.undisturbed(up, downs), (States{1, 0, 0}));
  Commutation strong(counter(), up_and_down(), Commutation::Watch::strong);
  EXPECT_EQ(strong.undisturbed(up, downs), (States{0, 0, 0}));
}

// `next` leads from 0 to 1 to 2, and with `set` given before from 3 to 4 to 5. `use` changes
// nothing. It is possible at 1 and 4, and at 5: there because `set` was given.
ModelInstance settable_model() {
  ModelInstance model;
  model.name = "settable";
  model.automaton = InterfaceAutomaton(Alphabet({"set", "use", "next"}), Alphabet({"none"}), 6);
  const auto add = [&model](StateId from, Symbol input, StateId to) {
    model.automaton.add_transition(from, {Action::Kind::input, input}, to);
  };
  for (const StateId at : {0, 1, 2}) add(at, 0, at + 3);
  for (const StateId at : {1, 4, 5}) add(at, 1, at);
  for (const StateId at : {0, 1, 3, 4}) add(at, 2, at + 1);
  return model;
}

// `set` commutes with both others everywhere, but at 2 it makes `use` possible. `use` was possible
// at 1, so weak fairness watches there and at 0, from where `next` leads to 1. At 2 it cannot have
// been possible before.
TEST(Commutation, FairnessLooksAheadForWhatWasPossible) {
  std::vector<ModelUse> actions;
  for (Symbol input = 0; input < 3; ++input) {
    actions.push_back({ModelUse::Kind::give, 0, input});
  }
  constexpr std::size_t set = 0;
  constexpr std::uint64_t use_and_next = 6;
  const auto undisturbed = [&actions](Commutation::Watch watch) {
    return Commutation(settable_model(), actions, watch).undisturbed(set, use_and_next);
  };
  EXPECT_EQ(undisturbed(Commutation::Watch::nothing), (States{1, 1, 1, 1, 1, 1}));
  EXPECT_EQ(undisturbed(Commutation::Watch::weak), (States{0, 0, 1, 1, 1, 1}));
  EXPECT_EQ(undisturbed(Commutation::Watch::strong), (States{0, 0, 0, 1, 1, 1}));
}

// Never tried at 2: a write there leaves what was learned, and a read first prevents that.
TEST(Commutation, ACutIsAnOutcomeOfItsOwn) {
  ModelInstance model = counter();
  model.automaton.mark_unexplored(2, up);
  Commutation commutation(model, up_and_down(), Commutation::Watch::nothing);
  EXPECT_EQ(commutation.undisturbed(up, downs), (States{1, 1, 0}));
}

}  // namespace
}  // namespace maide
