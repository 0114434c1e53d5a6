// Against brute force: shortest words by breadth-first search over pairs of states.
#include "maide/conformance/identify/separating_words.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <deque>
#include <set>

#include "maide/automata/minimize.hpp"
#include "maide/automata/random_automata.hpp"

namespace maide {
namespace {

// Length of a shortest word that tells them apart, 0 if none does.
std::size_t shortest_length(const Mealy& machine, StateId left, StateId right) {
  std::set<std::pair<StateId, StateId>> seen{{left, right}};
  std::deque<std::pair<std::pair<StateId, StateId>, std::size_t>> queue{{{left, right}, 0}};
  while (!queue.empty()) {
    const auto [pair, length] = queue.front();
    queue.pop_front();
    for (Symbol input = 0; input < machine.inputs().size(); ++input) {
      if (machine.output(pair.first, input) != machine.output(pair.second, input)) {
        return length + 1;
      }
      const std::pair next{machine.target(pair.first, input), machine.target(pair.second, input)};
      if (seen.insert(next).second) queue.push_back({next, length + 1});
    }
  }
  return 0;
}

// Answers "1" once in `states` steps: words to tell states apart are as long as they can be.
Mealy ring(std::size_t states) {
  Mealy machine({"a", "b"}, {"0", "1"}, states);
  for (StateId state = 0; state < states; ++state) {
    machine.set_transition(state, 0, state + 1 == states ? 1 : 0,
                           static_cast<StateId>((state + 1) % states));
    machine.set_transition(state, 1, 0, 0);
  }
  return machine;
}

std::vector<Mealy> examples() {
  std::vector<Mealy> machines{ring(1), ring(2), ring(17), ring(40)};
  Random random(1);
  for (int i = 0; i < 60; ++i) {
    machines.push_back(random_mealy({.states = random.between(1, 30),
                                     .inputs = random.between(1, 4),
                                     .outputs = random.between(1, 3)},
                                    random));
  }
  return machines;
}

TEST(SeparatingWords, AreShortestForEveryPair) {
  int separable = 0, equivalent = 0;
  for (const Mealy& machine : examples()) {
    const SeparatingWords separating(machine);
    EXPECT_EQ(separating.class_count(), minimize(machine).size());
    for (StateId left = 0; left < machine.size(); ++left) {
      for (StateId right = 0; right < machine.size(); ++right) {
        const auto word = separating.find(left, right);
        const std::size_t expected = shortest_length(machine, left, right);
        ASSERT_EQ(separating.are_separable(left, right), expected != 0);
        ASSERT_EQ(word ? word->size() : 0, expected);
        if (!word) {
          ++equivalent;
          continue;
        }
        ASSERT_NE(machine.output_word(left, *word).back(),
                  machine.output_word(right, *word).back());
        ++separable;
      }
    }
  }
  EXPECT_GT(separable, 1000);
  EXPECT_GT(equivalent, 1000);
}

TEST(CharacterisingSet, TellsAllStatesApartWithFewWords) {
  for (const Mealy& machine : examples()) {
    const SeparatingWords separating(machine);
    const std::vector<Word> words = compute_characterising_set(machine, separating);
    EXPECT_LT(words.size(), separating.class_count());
    for (StateId left = 0; left < machine.size(); ++left) {
      for (StateId right = 0; right < left; ++right) {
        const bool told_apart = std::any_of(words.begin(), words.end(), [&](const Word& word) {
          return machine.output_word(left, word) != machine.output_word(right, word);
        });
        ASSERT_EQ(told_apart, separating.are_separable(left, right));
      }
    }
    for (const Word& word : words) {
      EXPECT_FALSE(word.empty());
      for (const Word& other : words) {
        if (&word == &other) continue;
        EXPECT_FALSE(word.size() <= other.size() &&
                     std::equal(word.begin(), word.end(), other.begin()));
      }
    }
    EXPECT_TRUE(std::is_sorted(words.begin(), words.end(), [](const Word& a, const Word& b) {
      return a.size() != b.size() ? a.size() < b.size() : a < b;
    }));
  }
}

TEST(CharacterisingSet, OfARingIsOneWord) {
  const Mealy machine = ring(40);
  EXPECT_EQ(compute_characterising_set(machine, SeparatingWords(machine)),
            std::vector<Word>{Word(39, 0)});
}

TEST(StateCover, ReachesEveryReachableStateByAShortestWord) {
  for (const Mealy& machine : examples()) {
    const std::vector<Word> cover = compute_state_cover(machine);
    EXPECT_EQ(cover.size(), breadth_first(machine).size());
    std::set<Word> words(cover.begin(), cover.end());
    std::set<StateId> reached;
    for (const Word& word : cover) {
      reached.insert(machine.run(word));
      if (word.empty()) continue;
      EXPECT_TRUE(words.contains(Word(word.begin(), word.end() - 1))) << "not prefix-closed";
    }
    EXPECT_EQ(reached.size(), cover.size());
    EXPECT_TRUE(std::is_sorted(cover.begin(), cover.end(), [](const Word& a, const Word& b) {
      return a.size() != b.size() ? a.size() < b.size() : a < b;
    }));
  }
}

}  // namespace
}  // namespace maide
