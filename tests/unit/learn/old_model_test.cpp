#include "maide/learn/lsharp/old_model.hpp"

#include <gtest/gtest.h>

#include <set>

#include "maide/automata/minimize.hpp"
#include "maide/automata/random_automata.hpp"

namespace maide {
namespace {

Word outputs_of(const OldModel& model, StateId state, const Word& word) {
  Word outputs;
  for (const Symbol input : word) {
    outputs.push_back(model.output(state, input));
    state = model.target(state, input);
  }
  return outputs;
}

TEST(OldModel, TellsAllItsStatesApart) {
  Random random(1);
  for (int i = 0; i < 20; ++i) {
    const Mealy machine = minimize(random_mealy({.states = 20, .inputs = 3, .outputs = 2}, random));
    const OldModel old(machine, machine.inputs());
    ASSERT_EQ(old.size(), machine.size());
    std::set<std::pair<Word, Word>> answers;
    for (StateId left = 0; left < old.size(); ++left) {
      const Word& word = old.identifying_word(left);
      answers.emplace(word, outputs_of(old, left, word));
      for (StateId right = 0; right < left; ++right) {
        const Word separating = old.separating_word(left, right);
        EXPECT_NE(outputs_of(old, left, separating), outputs_of(old, right, separating));
      }
    }
    EXPECT_GT(answers.size(), 4U);
  }
}

// Words that some state of a machine and no other answers so, from each of its states.
TEST(OldModel, TestWordsShowEveryState) {
  Random random(2);
  for (int i = 0; i < 20; ++i) {
    const Mealy machine = minimize(random_mealy({.states = 15, .inputs = 2, .outputs = 2}, random));
    const OldModel old(machine, machine.inputs());
    std::vector<std::set<std::pair<Word, Word>>> seen(machine.size());  // by state
    for (const Word& word : old.test_words()) {
      for (std::size_t place = 0; place <= word.size(); ++place) {
        const StateId state = machine.run(std::span(word).first(place));
        for (std::size_t end = place + 1; end <= word.size(); ++end) {
          const Word suffix(word.begin() + static_cast<std::ptrdiff_t>(place),
                            word.begin() + static_cast<std::ptrdiff_t>(end));
          seen[state].emplace(suffix, machine.output_word(state, suffix));
        }
      }
    }
    for (StateId left = 0; left < machine.size(); ++left) {
      for (StateId right = 0; right < left; ++right) {
        bool apart = false;
        for (const auto& [suffix, outputs] : seen[left]) {
          const auto same = seen[right].lower_bound({suffix, {}});
          apart = apart ||
                  (same != seen[right].end() && same->first == suffix && same->second != outputs);
        }
        EXPECT_TRUE(apart) << left << " " << right;
      }
    }
  }
}

TEST(OldModel, IsRestrictedToTheInputsThatBothHave) {
  Mealy machine({"gone", "kept"}, {"0", "1"}, 2);
  machine.set_transition(0, 0, 0, 1);
  machine.set_transition(0, 1, 0, 0);
  machine.set_transition(1, 0, 0, 1);
  machine.set_transition(1, 1, 1, 1);
  const OldModel one(machine, Alphabet{"new", "kept"});
  EXPECT_EQ(one.size(), 1U);  // nothing leads to the other state
  EXPECT_FALSE(one.has_input(0));
  EXPECT_TRUE(one.has_input(1));
  EXPECT_TRUE(one.test_words().empty());
  const OldModel both(machine, Alphabet{"kept", "new", "gone"});
  EXPECT_EQ(both.size(), 2U);
  EXPECT_EQ(both.target(both.initial(), 2), 1U);
  EXPECT_EQ(both.separating_word(0, 1), (Word{0}));
  EXPECT_EQ(OldModel(machine, Alphabet{"other"}).size(), 1U);
}

}  // namespace
}  // namespace maide
