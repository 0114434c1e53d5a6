// The observation tree and what L# knows from it: apartness that is kept up to date must be the
// apartness that comparing subtrees finds.
#include "maide/learn/lsharp/apartness.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "maide/automata/compare.hpp"
#include "maide/automata/random_automata.hpp"
#include "maide/learn/lsharp/adaptive_experiment.hpp"
#include "maide/learn/lsharp/lsharp.hpp"
#include "maide/learn/oracle/mealy_oracle.hpp"
#include "maide/learn/oracle/output_oracle.hpp"

namespace maide {
namespace {

Word random_word(std::size_t length, std::size_t inputs, Random& random) {
  Word word(length);
  for (Symbol& input : word) input = static_cast<Symbol>(random.below(inputs));
  return word;
}

TEST(ObservationTree, HoldsWhatWasInsertedAndNothingElse) {
  Random random(1);
  const Mealy machine = random_mealy({.states = 8, .inputs = 3, .outputs = 2}, random);
  ObservationTree tree(3);
  std::set<Word> prefixes{{}};
  for (int i = 0; i < 300; ++i) {
    const Word word = random_word(random.between(0, 7), 3, random);
    std::size_t known = 0;
    for (std::size_t length = 0; length <= word.size(); ++length) {
      const Word prefix(word.begin(), word.begin() + static_cast<std::ptrdiff_t>(length));
      if (!prefixes.insert(prefix).second) known = length;
    }
    const auto inserted = tree.insert(word, machine.output_word(word));
    EXPECT_EQ(inserted.known, known);
    EXPECT_FALSE(inserted.conflict);
    if (i % 10 == 0) tree.make_table(tree.find(ObservationTree::root, word));
  }
  EXPECT_EQ(tree.size(), prefixes.size());
  for (int i = 0; i < 1000; ++i) {
    const Word word = random_word(random.between(1, 7), 3, random);
    const auto node = tree.find(ObservationTree::root, word);
    ASSERT_EQ(node != ObservationTree::none, prefixes.contains(word));
    if (node == ObservationTree::none) continue;
    EXPECT_EQ(tree.input(node), word.back());
    EXPECT_EQ(tree.output(node), machine.output_word(word).back());
  }
}

TEST(ObservationTree, AContradictionAddsNothing) {
  ObservationTree tree(2);
  tree.insert(Word{0, 1}, Word{5, 6});
  const auto inserted = tree.insert(Word{0, 1, 1}, Word{5, 7, 0});
  EXPECT_TRUE(inserted.conflict);
  EXPECT_EQ(inserted.known, 1U);
  EXPECT_EQ(tree.size(), 3U);
}

TEST(ObservationTree, AWitnessIsAShortestWordThatTellsApart) {
  ObservationTree tree(3);
  tree.insert(Word{0, 0, 0}, Word{0, 0, 1});
  tree.insert(Word{0, 2, 1}, Word{0, 0, 1});
  tree.insert(Word{1, 0, 0}, Word{0, 0, 0});
  tree.insert(Word{1, 2, 1}, Word{0, 0, 0});
  const auto left = tree.child(ObservationTree::root, 0);
  const auto right = tree.child(ObservationTree::root, 1);
  EXPECT_TRUE(tree.are_apart(left, right));
  EXPECT_EQ(tree.find_witness(left, right), (Word{0, 0}));
  EXPECT_FALSE(tree.are_apart(ObservationTree::root, right));
  EXPECT_TRUE(tree.find_witness(ObservationTree::root, right).empty());
}

bool is_complete(const Apartness& apartness, StateId state) {
  for (std::size_t input = 0; input < apartness.input_count(); ++input) {
    const auto at = static_cast<Apartness::Transition>(state * apartness.input_count() + input);
    if (apartness.target_node(at) == ObservationTree::none) return false;
  }
  return true;
}

// Every candidate that is there may be the state, every one that is not was refuted.
void expect_up_to_date(Apartness& apartness) {
  const ObservationTree& tree = apartness.tree();
  bool is_new = false;
  for (Apartness::Transition at = 0; at < apartness.transition_count(); ++at) {
    const auto node = apartness.target_node(at);
    std::vector<StateId> expected;
    bool may_be_old = false;
    const bool is_frontier =
        node != ObservationTree::none && apartness.basis_target(at) == Mealy::no_state;
    for (StateId state = 0; is_frontier && state < apartness.size(); ++state) {
      if (tree.are_apart(node, apartness.node(state))) continue;
      may_be_old = true;
      if (is_complete(apartness, state)) expected.push_back(state);
    }
    ASSERT_EQ(apartness.candidates(at), expected);
    is_new = is_new || (is_frontier && !may_be_old);
  }
  ASSERT_EQ(apartness.has_isolated(), is_new);
  for (StateId left = 0; left < apartness.size(); ++left) {
    for (StateId right = 0; right < left; ++right) {
      ASSERT_TRUE(tree.are_apart(apartness.node(left), apartness.node(right)));
    }
  }
}

TEST(Apartness, KeptUpToDateIsWhatComparingSubtreesFinds) {
  Random random(2);
  for (int round = 0; round < 20; ++round) {
    const Mealy machine = random_mealy({.states = 12, .inputs = 3, .outputs = 2}, random);
    Apartness apartness(3);
    for (int i = 0; i < 150; ++i) {
      const Word word = random_word(random.between(1, 9), 3, random);
      apartness.insert(word, machine.output_word(word));
      expect_up_to_date(apartness);
      if (HasFatalFailure()) FAIL() << "round " << round << ", word " << i;
      while (apartness.has_isolated()) {
        apartness.promote_isolated();
        expect_up_to_date(apartness);
        if (HasFatalFailure()) FAIL() << "round " << round << ", word " << i;
      }
    }
    EXPECT_GT(apartness.size(), 2U);
    EXPECT_LE(apartness.size(), 12U);
  }
}

// What is reported as changed is enough to keep a copy of the candidates up to date.
TEST(Apartness, ReportsEveryChangeOfCandidates) {
  struct Known {
    FrontierClasses::Class at = FrontierClasses::none;
    std::vector<StateId> candidates;
  };
  Random random(7);
  std::size_t lost = 0;  // without a word of their own
  for (int round = 0; round < 20; ++round) {
    const Mealy machine = random_mealy({.states = 12, .inputs = 3, .outputs = 2}, random);
    Apartness apartness(3);
    std::vector<Known> copy;
    const auto compare = [&] {
      const FrontierClasses& classes = apartness.classes();
      const auto [changed, moved] = apartness.classes().take_changes();
      copy.resize(apartness.transition_count());
      for (Apartness::Transition member = 0; member < copy.size(); ++member) {
        const Known now{classes.class_of(member), apartness.candidates(member)};
        if (now.at != FrontierClasses::none && std::ranges::count(moved, member) == 0) {
          ASSERT_EQ(now.at, copy[member].at);
          if (std::ranges::count(changed, now.at) == 0) {
            ASSERT_EQ(now.candidates, copy[member].candidates);
          }
          lost += now.candidates.size() < copy[member].candidates.size() ? 1 : 0;
        }
        copy[member] = now;
      }
    };
    for (int i = 0; i < 150; ++i) {
      const Word word = random_word(random.between(1, 9), 3, random);
      apartness.insert(word, machine.output_word(word));
      ASSERT_NO_FATAL_FAILURE(compare()) << "round " << round << ", word " << i;
      while (apartness.has_isolated()) {
        apartness.promote_isolated();
        ASSERT_NO_FATAL_FAILURE(compare()) << "round " << round << ", word " << i;
      }
    }
  }
  EXPECT_GT(lost, 0U);
}

// Answers from `node` on are those that the hypothesis gives from `state` on.
void expect_agreement(const ObservationTree& tree, ObservationTree::Node node,
                      const Mealy& hypothesis, StateId state) {
  tree.for_each_child(node, [&](ObservationTree::Node child) {
    const Symbol input = tree.input(child);
    EXPECT_EQ(hypothesis.output(state, input), tree.output(child));
    expect_agreement(tree, child, hypothesis, hypothesis.target(state, input));
  });
}

// Conflicts are looked for where something has changed; none must be left anywhere. More states
// than those up to which each transition has a plan of its own.
TEST(LSharpHypothesis, AgreesWithAllThatWasAsked) {
  Random random(4);
  std::size_t hypotheses = 0;
  for (const std::size_t states : {5, 20, 60, 150}) {
    const Mealy machine = random_mealy({.states = states, .inputs = 3, .outputs = 2}, random);
    for (const Separation separation : {Separation::adaptive, Separation::separating_words}) {
      MealyOracle oracle(machine);
      LSharp learner(oracle, separation);
      learner.start();
      while (true) {
        ++hypotheses;
        expect_agreement(learner.knowledge().tree(), ObservationTree::root, learner.hypothesis(),
                         learner.hypothesis().initial());
        const auto word = find_distinguishing_word(learner.hypothesis(), machine);
        if (!word) break;
        learner.refine(*word);
      }
    }
  }
  EXPECT_GT(hypotheses, 30U);
}

// Its states are told apart by words that are longer than plans which are shared.
TEST(LSharpHypothesis, OfALongCounter) {
  constexpr std::size_t size = 340;
  Mealy counter({"tick"}, {"nothing", "full"}, size);
  for (StateId state = 0; state < size; ++state) {
    counter.set_transition(state, 0, state + 1 == size ? 1 : 0,
                           static_cast<StateId>((state + 1) % size));
  }
  for (const Separation separation : {Separation::adaptive, Separation::separating_words}) {
    MealyOracle oracle(counter);
    LSharp learner(oracle, separation);
    learner.start();
    while (const auto word = find_distinguishing_word(learner.hypothesis(), counter)) {
      learner.refine(*word);
    }
    EXPECT_EQ(learner.hypothesis().size(), size);
  }
}

// What is known from a node is as deep as words are long; no recursion goes there.
TEST(LSharpHypothesis, RefinedByAVeryLongWord) {
  Random random(6);
  const Mealy machine = random_mealy({.states = 30, .inputs = 2, .outputs = 2}, random);
  MealyOracle oracle(machine);
  LSharp learner(oracle);
  learner.start();
  const Word word = random_word(100'000, 2, random);
  ASSERT_NE(learner.hypothesis().output_word(word), machine.output_word(word));
  learner.refine(word);
  EXPECT_EQ(learner.hypothesis().output_word(word), machine.output_word(word));
}

TEST(AdaptiveSequence, KeepsToTheNumberOfInputs) {
  Random random(5);
  const Mealy machine = random_mealy({.states = 40, .inputs = 3, .outputs = 2}, random);
  MealyOracle oracle(machine);
  LSharp learner(oracle);
  learner.start();
  while (const auto word = find_distinguishing_word(learner.hypothesis(), machine)) {
    learner.refine(*word);
  }
  const Apartness& apartness = learner.knowledge();
  std::vector<WeightedNode> candidates;
  for (StateId state = 0; state < apartness.size(); ++state) {
    candidates.push_back({apartness.node(state), 1});
  }
  const std::size_t all = find_adaptive_sequence(apartness.tree(), candidates).nodes.size();
  ASSERT_GT(all, 5U);
  EXPECT_EQ(find_adaptive_sequence(apartness.tree(), candidates, 5).nodes.size(), 5U);
  EXPECT_EQ(find_adaptive_sequence(apartness.tree(), candidates, all).nodes.size(), all);
}

TEST(AdaptiveSequence, EveryPathTellsSuspectsApart) {
  Random random(3);
  for (int round = 0; round < 50; ++round) {
    const Mealy machine = random_mealy({.states = 10, .inputs = 3, .outputs = 2}, random);
    Apartness apartness(3);
    for (int i = 0; i < 100; ++i) {
      const Word word = random_word(6, 3, random);
      apartness.insert(word, machine.output_word(word));
      while (apartness.has_isolated()) apartness.promote_isolated();
    }
    std::vector<WeightedNode> candidates;
    for (StateId state = 0; state < apartness.size(); ++state) {
      candidates.push_back({apartness.node(state), random.unit() + 0.1});
    }
    ASSERT_GE(candidates.size(), 2U);
    const DecisionTree sequence = find_adaptive_sequence(apartness.tree(), candidates);
    for (StateId state = 0; state < machine.size(); ++state) {
      MealyAnswer answer;
      StateId at = state;
      play_query(sequence, answer, [&](Symbol input) -> std::optional<Symbol> {
        const Symbol output = machine.output(at, input);
        at = machine.target(at, input);
        return output;
      });
      std::size_t refuted = 0;
      for (const WeightedNode& suspect : candidates) {
        auto node = suspect.node;
        for (std::size_t i = 0; i < answer.inputs.size(); ++i) {
          node = apartness.tree().child(node, answer.inputs[i]);
          if (node == ObservationTree::none) break;
          if (apartness.tree().output(node) == answer.outputs[i]) continue;
          ++refuted;
          break;
        }
      }
      EXPECT_GE(refuted, 1U);
    }
  }
}

}  // namespace
}  // namespace maide
