// Comparison of models: against plain searches on random machines, and on the reference models.
#include "maide/automata/compare.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <deque>
#include <set>

#include "maide/automata/minimize.hpp"
#include "maide/automata/random_automata.hpp"
#include "maide/base/error.hpp"
#include "maide/formats/model_file.hpp"

namespace maide {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

InterfaceAutomaton reference(const std::string& name) {
  return read_interface_automaton(MAIDE_SOURCE_DIR "/tests/models/" + name + ".dot");
}

// The least shortest word over equal alphabets, by a search that merges nothing.
std::optional<Word> search(const Mealy& left, const Mealy& right) {
  struct Entry {
    StateId left, right;
    Word word;
  };
  std::deque<Entry> queue{{left.initial(), right.initial(), {}}};
  std::set<std::pair<StateId, StateId>> seen{{left.initial(), right.initial()}};
  while (!queue.empty()) {
    const Entry entry = queue.front();
    queue.pop_front();
    for (Symbol input = 0; input < left.inputs().size(); ++input) {
      Word word = entry.word;
      word.push_back(input);
      if (left.output(entry.left, input) != right.output(entry.right, input)) return word;
      const auto next = std::pair(left.target(entry.left, input), right.target(entry.right, input));
      if (seen.insert(next).second) queue.push_back({next.first, next.second, std::move(word)});
    }
  }
  return std::nullopt;
}

TEST(CompareMealy, FindsTheLeastShortestWord) {
  Random random(11);
  int different = 0;
  for (int round = 0; round < 600; ++round) {
    const Mealy left = random_mealy({1 + random.below(12), 1 + random.below(3), 2}, random);
    Mealy right = minimize(left);
    // Change a single transition, so that long words are needed.
    if (random.chance(0.8)) {
      const auto state = static_cast<StateId>(random.below(right.size()));
      const auto input = static_cast<Symbol>(random.below(right.inputs().size()));
      right.set_transition(state, input, right.output(state, input),
                           static_cast<StateId>(random.below(right.size())));
    }
    const auto expected = search(left, right);
    EXPECT_EQ(find_distinguishing_word(left, right), expected);
    different += expected.has_value() ? 1 : 0;
  }
  EXPECT_GT(different, 100);
  EXPECT_LT(different, 590);
}

TEST(CompareMealy, SymbolsAreMatchedByName) {
  Mealy left({"a", "b"}, {"x", "y"}, 1);
  left.set_transition(0, 0, 0, 0);
  left.set_transition(0, 1, 1, 0);
  Mealy right({"b", "a"}, {"unused", "y", "x"}, 1);
  right.set_transition(0, 0, 1, 0);
  right.set_transition(0, 1, 2, 0);
  EXPECT_FALSE(find_difference(left, right));
  right.set_transition(0, 0, 0, 0);
  const auto difference = find_difference(left, right);
  ASSERT_TRUE(difference);
  EXPECT_THAT(difference->word, ElementsAre("b"));
  EXPECT_EQ(difference->left, "y");
  EXPECT_EQ(difference->right, "unused");
}

TEST(CompareMealy, AnInputThatOnlyOneHasIsADifference) {
  Mealy left({"a"}, {"x"}, 1);
  left.set_transition(0, 0, 0, 0);
  Mealy right({"b", "a"}, {"x"}, 1);
  right.set_transition(0, 0, 0, 0);
  right.set_transition(0, 1, 0, 0);
  const auto difference = find_difference(left, right);
  ASSERT_TRUE(difference);
  EXPECT_THAT(difference->word, ElementsAre("b"));
  EXPECT_EQ(difference->left, std::nullopt);
  EXPECT_EQ(difference->right, "x");
  const auto other_way = find_difference(right, left);
  ASSERT_TRUE(other_way);
  EXPECT_EQ(other_way->right, std::nullopt);
  EXPECT_THROW(find_distinguishing_word(left, right), UsageError);
}

TEST(CompareIa, StrictOfOneAndPortDifferInTheMarkAlone) {
  const IaComparison result = compare(reference("strict-1"), reference("port"));
  EXPECT_TRUE(result.differ_in_marks_alone());
  ASSERT_EQ(result.soft.size(), 1U);
  EXPECT_THAT(result.soft[0].word, ElementsAre("?write"));
  ASSERT_EQ(result.soft[0].inputs.size(), 1U);
  EXPECT_EQ(result.soft[0].inputs[0].name, "write");
  EXPECT_EQ(to_string(result.soft[0].inputs[0].left), "never tried");
  EXPECT_EQ(to_string(result.soft[0].inputs[0].right), "refused");
  EXPECT_THAT(result.notes, ElementsAre("hidden returns differ: none in the first, write in the "
                                        "second"));
}

TEST(CompareIa, AbsorbedCountsAsUnexplored) {
  const IaComparison result =
      compare(reference("strict-3-tryread"), reference("strict-3-tryread-absorb"));
  EXPECT_TRUE(result.same());
  EXPECT_THAT(result.notes, IsEmpty());
}

TEST(CompareIa, BufferedAndPortContradictEachOther) {
  const IaComparison result = compare(reference("buffered"), reference("port"));
  ASSERT_TRUE(result.hard);
  EXPECT_THAT(result.hard->word, ElementsAre("?write", "?write"));
  EXPECT_EQ(to_string(result.hard->left), "enabled");
  EXPECT_EQ(to_string(result.hard->right), "refused");
  EXPECT_THAT(result.hard->left_offers, ElementsAre("?write", "?read"));
  EXPECT_THAT(result.hard->right_offers, ElementsAre("?read"));
  EXPECT_THAT(result.soft, IsEmpty());
}

TEST(CompareIa, BoundsThatDifferAreSoft) {
  const IaComparison result = compare(reference("strict-3"), reference("strict-6"));
  EXPECT_FALSE(result.hard);
  ASSERT_EQ(result.soft.size(), 1U);
  EXPECT_THAT(result.soft[0].word, ElementsAre("?write", "?write", "?write"));
  EXPECT_EQ(to_string(result.soft[0].inputs[0].right), "enabled");
}

TEST(CompareIa, AnInputThatOnlyOneHasIsHard) {
  const IaComparison result = compare(reference("buffered"), reference("buffered-tryread"));
  ASSERT_TRUE(result.hard);
  EXPECT_THAT(result.hard->word, ElementsAre("?tryread"));
  EXPECT_EQ(to_string(result.hard->left), "not in the alphabet");
  EXPECT_THAT(result.notes, ElementsAre("only the second has the inputs tryread"));
}

// After ?a the one chooses between !x and !y by itself, the other leaves the choice.
TEST(CompareIa, ChoicesOfTheSystemAndOfTheEnvironmentDiffer) {
  const Action a{Action::Kind::input, 0}, x{Action::Kind::output, 0}, y{Action::Kind::output, 1};
  InterfaceAutomaton inner({"a"}, {"x", "y"}, 4);
  inner.add_transition(0, a, 1);
  inner.add_transition(0, a, 2);
  inner.add_transition(1, x, 3);
  inner.add_transition(2, y, 3);
  InterfaceAutomaton outer({"a"}, {"x", "y"}, 3);
  outer.add_transition(0, a, 1);
  outer.add_transition(1, x, 2);
  outer.add_transition(1, y, 2);
  const IaComparison result = compare(inner, outer);
  ASSERT_TRUE(result.hard);
  EXPECT_THAT(result.hard->word, ElementsAre("?a", "!x"));
  EXPECT_EQ(to_string(result.hard->left), "enabled or refused");
  EXPECT_EQ(to_string(result.hard->right), "enabled");
}

TEST(CompareIa, MaybeQuiescentIsNotNeverQuiescent) {
  const Action a{Action::Kind::input, 0}, x{Action::Kind::output, 0}, y{Action::Kind::output, 1};
  InterfaceAutomaton left({"a"}, {"x", "y"}, 4);
  left.add_transition(0, a, 1);
  left.add_transition(0, a, 2);
  left.add_transition(1, x, 3);
  left.add_transition(2, y, 3);
  InterfaceAutomaton right = left;
  right.add_transition(0, a, 3);
  const IaComparison result = compare(left, right);
  ASSERT_TRUE(result.hard);
  EXPECT_THAT(result.hard->word, ElementsAre("?a", "(quiescence)"));
}

// The states in which a word may end; for a plain search over all words.
std::set<StateId> after(const InterfaceAutomaton& automaton, const std::vector<Action>& word) {
  std::set<StateId> states{automaton.initial()};
  for (const Action action : word) {
    std::set<StateId> next;
    for (const StateId state : states) {
      for (const auto& transition : automaton.transitions(state)) {
        if (transition.action == action && !transition.absorbed) next.insert(transition.target);
      }
    }
    states = std::move(next);
  }
  return states;
}

// 0 equal, 1 soft, 2 hard, of one action after one word.
int judge(const InterfaceAutomaton& left, const InterfaceAutomaton& right,
          const std::vector<Action>& word, Action action) {
  std::set<int> kinds[2];  // 0 refused, 1 enabled, 2 never tried
  const InterfaceAutomaton* sides[2] = {&left, &right};
  for (int side = 0; side < 2; ++side) {
    for (const StateId state : after(*sides[side], word)) {
      bool enabled = false;
      bool untried = action.is_input() && sides[side]->is_unexplored(state, action.symbol);
      for (const auto& transition : sides[side]->transitions(state)) {
        if (transition.action == action) (transition.absorbed ? untried : enabled) = true;
      }
      if (enabled) kinds[side].insert(1);
      if (untried) kinds[side].insert(2);
      if (!enabled && !untried) kinds[side].insert(0);
    }
  }
  if (kinds[0] == kinds[1]) return 0;
  return kinds[0].contains(2) || kinds[1].contains(2) ? 1 : 2;
}

TEST(CompareIa, AgreesWithASearchOverAllWords) {
  Random random(12);
  int hard = 0, soft = 0, same = 0;
  for (int round = 0; round < 400; ++round) {
    RandomInterfaceAutomatonOptions options{1 + random.below(4), 2, 1, 0.5, 0.2, 0.1,
                                            random.chance(0.5)};
    const InterfaceAutomaton left = random_interface_automaton(options, random);
    InterfaceAutomaton right = minimize(left);
    if (random.chance(0.4)) {
      right.mark_unexplored(static_cast<StateId>(random.below(right.size())), 0);
    }
    if (random.chance(0.6)) {
      right.add_transition(static_cast<StateId>(random.below(right.size())),
                           {random.chance(0.5) ? Action::Kind::input : Action::Kind::output, 0},
                           static_cast<StateId>(random.below(right.size())));
    }
    const IaComparison result = compare(left, right);
    const std::vector<Action> actions{
        {Action::Kind::input, 0}, {Action::Kind::input, 1}, {Action::Kind::output, 0}};
    std::optional<std::vector<std::string>> first_hard;
    bool any_soft = false;
    std::vector<std::vector<Action>> words{{}};
    for (std::size_t next = 0; next < words.size() && words[next].size() < 5; ++next) {
      const std::vector<Action> word = words[next];
      for (const Action action : actions) {
        const int verdict = judge(left, right, word, action);
        any_soft |= verdict == 1;
        std::vector<Action> longer = word;
        longer.push_back(action);
        if (verdict == 2 && !first_hard) {
          first_hard.emplace();
          for (const Action step : longer) first_hard->push_back(left.name(step));
        }
        if (!after(left, longer).empty() && !after(right, longer).empty()) words.push_back(longer);
      }
    }
    if (first_hard) {
      ASSERT_TRUE(result.hard);
      // A difference in quiescence alone may come earlier; else the words are the same.
      if (result.hard->word.back() != "(quiescence)") {
        EXPECT_EQ(result.hard->word, *first_hard);
      } else {
        EXPECT_LE(result.hard->word.size(), first_hard->size());
      }
    }
    EXPECT_EQ(!result.soft.empty(), any_soft);
    hard += result.hard.has_value();
    soft += result.differ_in_marks_alone();
    same += result.same();
  }
  EXPECT_GT(hard, 50);
  EXPECT_GT(soft, 30);
  EXPECT_GT(same, 30);
}

}  // namespace
}  // namespace maide
