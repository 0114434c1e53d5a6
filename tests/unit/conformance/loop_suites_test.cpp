// Tests of loops: that chains and pumps hold what they say, by looking at every word.
#include "maide/conformance/suite/loop_suites.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>
#include <tuple>

#include "maide/automata/random_automata.hpp"
#include "maide/conformance/method/complete_method.hpp"
#include "maide/learn/counterexample.hpp"
#include "suite_words.hpp"

namespace maide {
namespace {

using test::list;

struct Loops {
  explicit Loops(const Mealy& machine)
      : identifiers(hads_identifiers.compute(machine, Random(0))), inputs(machine, identifiers) {}
  StateIdentifiers identifiers;
  LoopingInputs inputs;
};

// Where only the end of a session leads, nothing loops; where another output leads there, too, it
// is entered so.
TEST(LoopingInputs, AreNotLookedForBehindTheEndOfASession) {
  Mealy machine(Alphabet({"a", "b", "c"}), Alphabet({"ok", "end", "closed"}), 3);
  for (Symbol input = 0; input < 3; ++input) {
    machine.set_transition(0, input, 0, 0);
    machine.set_transition(1, input, 0, 1);
    machine.set_transition(2, input, 2, 2);
  }
  machine.set_transition(0, 0, 1, 2);
  machine.set_transition(0, 1, 0, 1);
  const StateIdentifiers identifiers = hads_identifiers.compute(machine, Random(0));
  const std::vector<bool> is_error{false, true, false};
  const LoopingInputs loops(machine, identifiers, is_error);
  EXPECT_TRUE(loops.of(2).empty());
  EXPECT_EQ(loops.of(1).size(), 3U);
  EXPECT_EQ(LoopingInputs(machine, identifiers).of(2).size(), 3U);

  machine.set_transition(1, 2, 0, 2);
  const StateIdentifiers others = hads_identifiers.compute(machine, Random(0));
  const LoopingInputs entered(machine, others, is_error);
  EXPECT_EQ(entered.of(2).size(), 3U);
  const auto start = std::ranges::find(entered.states(), 2U, &LoopingInputs::Start::state);
  ASSERT_NE(start, entered.states().end());
  EXPECT_EQ(start->access, (Word{1, 2}));
}

TEST(Chain, HoldsEveryWordOnce) {
  for (std::size_t letters = 1; letters <= 5; ++letters) {
    for (std::size_t order = 1; order <= 4; ++order) {
      Word alphabet;
      for (std::size_t i = 0; i < letters; ++i) alphabet.push_back(static_cast<Symbol>(10 + 3 * i));
      const Word chain = draw_chain(alphabet, order, Random(letters));
      std::set<Word> words;
      ASSERT_GE(chain.size(), order);
      for (std::size_t i = 0; i + order <= chain.size(); ++i) {
        const auto begin = chain.begin() + static_cast<std::ptrdiff_t>(i);
        EXPECT_TRUE(words.emplace(begin, begin + static_cast<std::ptrdiff_t>(order)).second);
      }
      std::size_t all = 1;
      for (std::size_t i = 0; i < order; ++i) all *= letters;
      EXPECT_EQ(words.size(), all) << letters << " letters, order " << order;
    }
  }
  EXPECT_TRUE(draw_chain({}, 3, Random(1)).empty());
}

TEST(Chain, DiffersFromDrawToDraw) {
  const Word letters{0, 1, 2, 3};
  EXPECT_NE(draw_chain(letters, 3, Random(1)), draw_chain(letters, 3, Random(2)));
  EXPECT_EQ(draw_chain(letters, 3, Random(1)), draw_chain(letters, 3, Random(1)));
}

// In every state every word of three looping inputs is a part of what is played there, with the
// hypothesis in that state; short pieces and long ones.
TEST(ChainSuite, PlaysEveryWordOfLoopsInEveryState) {
  Random random(5);
  for (const Hiding hiding : {Hiding::pairs, Hiding::modes, Hiding::sinks}) {
    const Mealy machine = hiding_mealy(hiding, 12, 6, random);
    const Loops loops(machine);
    for (const std::size_t piece : {std::size_t{7}, ChainSuite::long_piece}) {
      ChainSuite suite(loops.inputs, loops.inputs.states(), 3, piece, Random(1));
      EXPECT_TRUE(suite.is_whole());
      const std::vector<Word> words = list(suite);
      EXPECT_EQ(words.size(), suite.size());
      std::map<StateId, std::set<Word>> played;
      std::uint64_t symbols = 0;
      for (const Word& word : words) {
        symbols += word.size();
        StateId state = machine.initial();
        std::size_t in_row = 0;  // inputs before this one that looped
        for (std::size_t i = 0; i < word.size(); ++i) {
          const StateId next = machine.target(state, word[i]);
          in_row = next == state ? in_row + 1 : 0;
          state = next;
          if (in_row >= 3) {
            const auto end = word.begin() + static_cast<std::ptrdiff_t>(i + 1);
            played[state].emplace(end - 3, end);
          }
        }
      }
      for (StateId state = 0; state < machine.size(); ++state) {
        const std::size_t letters = loops.inputs.of(state).size();
        EXPECT_GE(played[state].size(), letters * letters * letters) << "state " << state;
      }
      // Without the words that identify.
      EXPECT_LE(*suite.symbols(), symbols);
    }
    ChainSuite some(loops.inputs, loops.inputs.states(), 3, 7, Random(1), 1);
    EXPECT_FALSE(some.is_whole());
    EXPECT_LE(list(some).size(), machine.size());
  }
}

TEST(PumpSuite, RepeatsEveryLoopBeforeEveryOtherInputInEveryState) {
  Random random(6);
  for (const Hiding hiding : {Hiding::pairs, Hiding::modes, Hiding::nothing}) {
    const Mealy machine = hiding_mealy(hiding, 10, 5, random);
    const Loops loops(machine);
    const std::vector<std::size_t> counts{3, 9};
    PumpSuite suite(loops.inputs, counts);
    const std::vector<Word> words = list(suite);
    EXPECT_EQ(words.size(), suite.size());
    // State, loop, times, follower.
    std::set<std::tuple<StateId, Symbol, std::size_t, Symbol>> played;
    for (const Word& word : words) {
      StateId state = machine.initial();
      std::size_t times = 0;
      for (std::size_t i = 0; i < word.size(); ++i) {
        if (i > 0 && times > 0 && word[i] != word[i - 1]) {
          for (std::size_t fewer = 1; fewer <= times; ++fewer) {
            played.emplace(state, word[i - 1], fewer, word[i]);
          }
        }
        const StateId next = machine.target(state, word[i]);
        const bool goes_on = i > 0 && word[i] == word[i - 1] && times > 0;
        times = next != state ? 0 : goes_on ? times + 1 : 1;
        state = next;
      }
    }
    for (StateId state = 0; state < machine.size(); ++state) {
      for (const Symbol loop : loops.inputs.of(state)) {
        for (Symbol follower = 0; follower < machine.inputs().size(); ++follower) {
          for (const std::size_t count : counts) {
            if (follower == loop) continue;
            EXPECT_TRUE(played.contains({state, loop, count, follower}))
                << "state " << state << ", " << loop << " " << count << " times, " << follower;
          }
        }
      }
    }
  }
}

TEST(LoopingInputs, AreNotThoseThatWereRefusedOrNotTried) {
  Mealy machine({"a", "b", "c", "d"}, {"ok", "refused", "unexplored"}, 2);
  for (StateId state = 0; state < 2; ++state) {
    machine.set_transition(state, 0, 0, state);
    machine.set_transition(state, 1, 1, state);
    machine.set_transition(state, 2, 2, state);
    machine.set_transition(state, 3, state == 0 ? 0 : 1, 1);
  }
  const Loops loops(machine);
  EXPECT_TRUE(std::ranges::equal(loops.inputs.of(0), Word{0}));
  EXPECT_TRUE(std::ranges::equal(loops.inputs.of(1), Word{0}));
}

TEST(LoopingInputs, WaysAreTransitionsThatNoAccessWordTakes) {
  Random random(7);
  const Mealy machine = random_mealy({.states = 20, .inputs = 4, .outputs = 3}, random);
  const Loops loops(machine);
  std::set<Word> access;
  for (const auto& [word, state] : loops.inputs.states()) {
    EXPECT_EQ(machine.run(word), state);
    access.insert(word);
  }
  std::set<std::pair<StateId, Symbol>> kinds;
  for (const auto& [word, state] : loops.inputs.ways()) {
    EXPECT_EQ(machine.run(word), state);
    EXPECT_FALSE(access.contains(word));
    EXPECT_TRUE(access.contains(Word(word.begin(), word.end() - 1)));
    EXPECT_TRUE(kinds.emplace(state, machine.output_word(word).back()).second);
  }
  EXPECT_FALSE(kinds.empty());
}

TEST(GrowthSuite, GoesOnWhereARowIsSeen) {
  // 0 -a-> 1 -a-> 2 -a-> 3, b takes back, c does nothing.
  Mealy machine({"a", "b", "c"}, {"ok"}, 4);
  for (StateId state = 0; state < 4; ++state) {
    machine.set_transition(state, 0, 0, std::min<StateId>(state + 1, 3));
    machine.set_transition(state, 1, 0, state == 0 ? 0 : state - 1);
    machine.set_transition(state, 2, 0, state);
  }
  const Loops loops(machine);
  GrowthSuite suite(loops.inputs, {}, 1000);
  const std::vector<Word> words = list(suite);
  Word up(8, 0), back = up, once = up;
  back.insert(back.end(), 9, 1);
  once.push_back(2);
  EXPECT_NE(std::find(words.begin(), words.end(), back), words.end());
  EXPECT_NE(std::find(words.begin(), words.end(), once), words.end());
  GrowthSuite none(loops.inputs, {}, 5);
  EXPECT_TRUE(list(none).empty());
}

// Input 0 leads through a row of states, 1 does nothing, 2 leads back.
Mealy row_machine(StateId states) {
  Mealy machine(Alphabet({"a", "b", "c"}), Alphabet({"ok", "full"}), states);
  const StateId last = states - 1;
  for (StateId state = 0; state < states; ++state) {
    machine.set_transition(state, 0, 0, std::min(state + 1, last));
    machine.set_transition(state, 1, 0, state);
    machine.set_transition(state, 2, state == last ? 1 : 0, 0);
  }
  return machine;
}

TEST(LadderSuite, CountsEveryLoopUpAroundARow) {
  const Mealy machine = row_machine(5);
  const Loops loops(machine);
  LadderSuite suite(loops.inputs, 64);
  std::set<std::tuple<StateId, Symbol, std::size_t, Symbol>> seen;  // in a state: a, so often, b
  Word word;
  while (suite.next(word)) {
    const std::vector<StateId> states = states_along(machine, word);
    for (std::size_t i = 0; i < word.size(); ++i) {
      if (i > 0 && word[i - 1] == word[i] && states[i - 1] == states[i]) continue;
      std::size_t end = i;
      while (end < word.size() && word[end] == word[i] && states[end] == states[i]) ++end;
      if (end < word.size()) seen.emplace(states[i], word[i], end - i, word[end]);
    }
  }
  for (const StateId state : {StateId{0}, StateId{4}}) {
    for (const Symbol loop : loops.inputs.of(state)) {
      for (Symbol follower = 0; follower < 3; ++follower) {
        for (std::size_t times = 1; times <= 64 && follower != loop; ++times) {
          EXPECT_TRUE(seen.contains({state, loop, times, follower}))
              << state << ": " << times << " times " << loop << ", then " << follower;
        }
      }
    }
  }
  EXPECT_FALSE(seen.contains({2, 1, 24, 2}));  // inside of the row

  const Mealy short_row = row_machine(3);
  const Loops none(short_row);
  EXPECT_FALSE(LadderSuite(none.inputs, 64).next(word));
}

TEST(LoopSampler, IsTheSameForTheSameSeedAndEndsWithoutLoops) {
  Random random(8);
  const Mealy machine = hiding_mealy(Hiding::pairs, 10, 5, random);
  const Loops loops(machine);
  LoopSampler sampler(loops.inputs, 20, Random(1)), same(loops.inputs, 20, Random(1)),
      other(loops.inputs, 20, Random(2));
  const std::vector<Word> words = list(sampler, 300);
  EXPECT_EQ(words, list(same, 300));
  EXPECT_NE(words, list(other, 300));
  EXPECT_GT(sampler.enough(), 0U);

  Mealy turning({"a"}, {"x", "y"}, 2);
  turning.set_transition(0, 0, 0, 1);
  turning.set_transition(1, 0, 1, 0);
  const Loops none(turning);
  LoopSampler nothing(none.inputs, 20, Random(1));
  EXPECT_TRUE(list(nothing, 10).empty());
}

}  // namespace
}  // namespace maide
