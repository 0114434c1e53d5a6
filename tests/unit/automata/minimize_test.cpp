#include "maide/automata/minimize.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <utility>
#include <vector>

#include "maide/automata/random_automata.hpp"
#include "maide/base/random.hpp"

namespace maide {
namespace {

// The number of classes of reachable states that no word tells apart, by Moore's rounds.
std::size_t count_classes(const Mealy& machine) {
  std::set<StateId> reachable{machine.initial()};
  for (std::size_t before = 0; before != reachable.size();) {
    before = reachable.size();
    for (const StateId state : std::set<StateId>(reachable)) {
      for (Symbol input = 0; input < machine.inputs().size(); ++input) {
        reachable.insert(machine.target(state, input));
      }
    }
  }
  std::vector<std::size_t> block(machine.size(), 0);
  for (std::size_t before = 0, now = 1;;) {
    std::set<std::vector<std::size_t>> rows;
    std::vector<std::vector<std::size_t>> row_of(machine.size());
    for (const StateId state : reachable) {
      std::vector<std::size_t> row{block[state]};
      for (Symbol input = 0; input < machine.inputs().size(); ++input) {
        row.push_back(machine.output(state, input));
        row.push_back(block[machine.target(state, input)]);
      }
      rows.insert(row);
      row_of[state] = std::move(row);
    }
    for (const StateId state : reachable) {
      block[state] =
          static_cast<std::size_t>(std::distance(rows.begin(), rows.find(row_of[state])));
    }
    before = std::exchange(now, rows.size());
    if (before == now) return now;
  }
}

// For each two states the step that splits them, by Moore's table; `never` where none does.
TEST(StateClasses, AreSplitInTheStepsOfShortestWords) {
  constexpr std::size_t never = ~std::size_t{0};
  Random random(2);
  for (int round = 0; round < 300; ++round) {
    const Mealy machine = random_mealy({.states = random.between(1, 20),
                                        .inputs = random.between(1, 3),
                                        .outputs = random.between(1, 2)},
                                       random);
    const std::size_t states = machine.size(), inputs = machine.inputs().size();
    std::vector<std::vector<std::size_t>> expected(states, std::vector<std::size_t>(states, never));
    for (std::size_t step = 0; step < states * inputs; ++step) {
      const auto input = static_cast<Symbol>(step % inputs);
      for (StateId left = 0; left < states; ++left) {
        for (StateId right = 0; right < states; ++right) {
          const bool differ = machine.output(left, input) != machine.output(right, input);
          const std::size_t next =
              expected[machine.target(left, input)][machine.target(right, input)];
          if (differ || next / inputs < step / inputs) {
            expected[left][right] = std::min(expected[left][right], step);
          }
        }
      }
    }
    std::vector<std::pair<Partition::Block, std::size_t>> made{{0, never}};  // from a block, when
    const Partition classes = compute_state_classes(
        machine, [&](Partition::Block block, Partition::Block fresh, std::size_t step) {
          ASSERT_EQ(fresh, made.size());
          made.emplace_back(block, step);
        });
    classes.check_invariants();
    ASSERT_EQ(classes.blocks(), made.size());
    for (StateId left = 0; left < states; ++left) {
      for (StateId right = 0; right < states; ++right) {
        std::size_t last = never;
        for (auto a = classes.block_of(left), b = classes.block_of(right); a != b;) {
          auto& later = a > b ? a : b;
          last = made[later].second;
          later = made[later].first;
        }
        ASSERT_EQ(last, expected[left][right]);
      }
    }
  }
}

TEST(Minimize, AgreesWithMooreOnRandomMachines) {
  Random random(1);
  for (int round = 0; round < 500; ++round) {
    const std::size_t states = 1 + random.below(30);
    const auto inputs = static_cast<Symbol>(1 + random.below(3));
    Alphabet in, out;
    for (Symbol i = 0; i < inputs; ++i) in.intern("i" + std::to_string(i));
    out.intern("x");
    out.intern("y");
    Mealy machine(in, out, states);
    for (StateId state = 0; state < states; ++state) {
      for (Symbol input = 0; input < inputs; ++input) {
        machine.set_transition(state, input, random.below(8) == 0 ? 1 : 0,
                               static_cast<StateId>(random.below(states)));
      }
    }
    const Mealy minimal = minimize(machine);
    ASSERT_EQ(minimal.size(), count_classes(machine)) << "round " << round;
    for (int word_number = 0; word_number < 20; ++word_number) {
      Word word(random.below(12));
      for (Symbol& symbol : word) symbol = static_cast<Symbol>(random.below(inputs));
      ASSERT_EQ(minimal.output_word(word), machine.output_word(word));
    }
    EXPECT_EQ(minimize(minimal).size(), minimal.size());
  }
}

TEST(Minimize, KeepsStatesApartThatDifferInWhatWasNeverTried) {
  InterfaceAutomaton automaton({"a", "b"}, {"x"}, 3);
  automaton.add_transition(0, {Action::Kind::input, 0}, 1);
  automaton.add_transition(1, {Action::Kind::input, 0}, 2);
  automaton.add_transition(2, {Action::Kind::input, 0}, 2);
  EXPECT_EQ(minimize(automaton).size(), 1U);
  automaton.mark_unexplored(2, 1);
  EXPECT_EQ(minimize(automaton).size(), 3U);
}

TEST(Minimize, DropsUnreachableStatesAndNumbersBreadthFirst) {
  InterfaceAutomaton automaton({"a"}, {"x"}, 4);
  automaton.set_initial(3);
  automaton.add_transition(3, {Action::Kind::input, 0}, 1);
  automaton.add_transition(1, {Action::Kind::output, 0}, 3);
  automaton.add_transition(0, {Action::Kind::output, 0}, 0);
  const InterfaceAutomaton minimal = minimize(automaton);
  EXPECT_EQ(minimal.size(), 2U);
  EXPECT_EQ(minimal.initial(), 0U);
  EXPECT_EQ(minimal.successor(0, {Action::Kind::input, 0}), 1U);
}

}  // namespace
}  // namespace maide
