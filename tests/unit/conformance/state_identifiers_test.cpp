// Identifiers tell every state from every other, and the adaptive ones are few.
#include "maide/conformance/identify/state_identifiers.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "maide/automata/minimize.hpp"
#include "maide/automata/random_automata.hpp"
#include "maide/conformance/identify/separating_words.hpp"

namespace maide {
namespace {

std::vector<Mealy> examples() {
  std::vector<Mealy> machines;
  Random random(1);
  for (int i = 0; i < 150; ++i) {
    machines.push_back(random_mealy({.states = random.between(1, 30),
                                     .inputs = random.between(1, 4),
                                     .outputs = random.between(1, 3)},
                                    random));
  }
  return machines;
}

// Some word tells them apart and is a prefix of a word of both: where the answers first differ on
// a word of one, the other has a word that agrees so far.
bool are_harmonised(const Mealy& machine, const StateIdentifiers& identifiers, StateId left,
                    StateId right) {
  for (const Word& word : identifiers.of(left)) {
    const Word answer = machine.output_word(left, word), other = machine.output_word(right, word);
    const auto differs = std::mismatch(answer.begin(), answer.end(), other.begin()).first;
    if (differs == answer.end()) continue;
    const auto length = differs - answer.begin() + 1;
    for (const Word& shared : identifiers.of(right)) {
      if (std::ssize(shared) >= length &&
          std::equal(word.begin(), word.begin() + length, shared.begin())) {
        return true;
      }
    }
  }
  return false;
}

TEST(StateIdentifiers, AreHarmonised) {
  std::uint64_t pairs = 0;
  for (const Mealy& machine : examples()) {
    const SeparatingWords separating(machine);
    for (const auto compute :
         {compute_characterising_words, compute_harmonised_words, compute_adaptive_words}) {
      const StateIdentifiers identifiers = compute(machine, Random(7));
      for (StateId left = 0; left < machine.size(); ++left) {
        for (StateId right = 0; right < machine.size(); ++right) {
          EXPECT_EQ(are_harmonised(machine, identifiers, left, right),
                    separating.are_separable(left, right));
          ++pairs;
        }
      }
    }
  }
  EXPECT_GT(pairs, 50'000U);
}

// Wp's need not be prefixes of each other's, but each tells its state from all others, and with the
// rest they are the characterising set.
TEST(StateIdentifiers, PartialOnesTellTheirStateFromTheOthers) {
  for (const Mealy& machine : examples()) {
    const SeparatingWords separating(machine);
    const StateIdentifiers identifiers = compute_partial_words(machine, Random(7));
    std::vector<Word> all = compute_characterising_set(machine, separating);
    std::sort(all.begin(), all.end());
    for (StateId state = 0; state < machine.size(); ++state) {
      for (StateId other = 0; other < machine.size(); ++other) {
        const auto tells = [&](const Word& word) {
          return machine.output_word(state, word) != machine.output_word(other, word);
        };
        const auto own = identifiers.of(state);
        EXPECT_EQ(std::any_of(own.begin(), own.end(), tells),
                  separating.are_separable(state, other));
      }
      std::vector<Word> together(identifiers.of(state).begin(), identifiers.of(state).end());
      std::erase(together, Word());
      const auto rest = identifiers.rest_of(state);
      together.insert(together.end(), rest.begin(), rest.end());
      std::sort(together.begin(), together.end());
      EXPECT_EQ(together, all);
    }
  }
}

// A queue-like machine with an adaptive distinguishing sequence, though no word tells all states
// apart: what comes next depends on the answers.
Mealy permuting(std::size_t states) {
  Mealy machine({"next", "look"}, {"0", "1"}, states);
  for (StateId state = 0; state < states; ++state) {
    machine.set_transition(state, 0, 0, static_cast<StateId>((state + 1) % states));
    machine.set_transition(state, 1, state == 0 ? 1 : 0, state);
  }
  return machine;
}

TEST(StateIdentifiers, OneAdaptiveWordIsEnoughWhereThereIsOne) {
  for (std::size_t states = 2; states < 40; ++states) {
    const Mealy machine = permuting(states);
    const SplittingTree tree(machine, Random(1));
    EXPECT_EQ(tree.class_count(), states);
    EXPECT_EQ(tree.invalid_count(), 0U);
    const StateIdentifiers identifiers = compute_adaptive_words(machine, Random(1));
    for (StateId state = 0; state < states; ++state) EXPECT_EQ(identifiers.of(state).size(), 1U);
  }
}

TEST(SplittingTree, SplitsAllThatCanBeToldApart) {
  std::size_t invalid = 0;
  for (const Mealy& machine : examples()) {
    const SeparatingWords separating(machine);
    const SplittingTree tree(machine, Random(3));
    EXPECT_EQ(tree.class_count(), separating.class_count());
    for (StateId state = 0; state < machine.size(); ++state) {
      for (StateId other = 0; other < machine.size(); ++other) {
        EXPECT_EQ(tree.leaf_of(state) != tree.leaf_of(other),
                  separating.are_separable(state, other));
      }
    }
    invalid += tree.invalid_count();
  }
  EXPECT_GT(invalid, 50U);
}

}  // namespace
}  // namespace maide
