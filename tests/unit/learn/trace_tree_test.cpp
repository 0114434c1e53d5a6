#include "maide/learn/cache/trace_tree.hpp"

#include <gtest/gtest.h>

#include <map>
#include <span>
#include <vector>

#include "maide/base/error.hpp"
#include "maide/base/random.hpp"

namespace maide {
namespace {

// Random insertions against a map from words to outputs.
TEST(TraceTree, HoldsWhatAMapHolds) {
  for (const std::uint64_t inputs : {1U, 2U, 3U, 5U, 17U, 100U}) {
    Random random(inputs);
    TraceTree tree;
    std::map<Word, Symbol> map;
    for (int i = 0; i < 3000; ++i) {
      TraceTree::Node node = TraceTree::root;
      Word word;
      const std::uint64_t length = random.between(1, 6);
      for (std::uint64_t step = 0; step < length; ++step) {
        const auto input = static_cast<Symbol>(random.below(inputs));
        word.push_back(input);
        TraceTree::Node child = tree.child(node, input);
        const auto known = map.find(word);
        ASSERT_EQ(child == TraceTree::none, known == map.end());
        if (child == TraceTree::none) {
          const auto output = static_cast<Symbol>(random.below(TraceTree::symbol_limit));
          child = tree.add_child(node, input, output);
          map.emplace(word, output);
        }
        ASSERT_EQ(tree.output(child), map.at(word));
        ASSERT_EQ(tree.input(child), input);
        node = child;
      }
    }
    EXPECT_EQ(tree.edge_count(), map.size());
  }
}

// Words that end inside the tree, leave it early, are empty, or are there twice.
TEST(TraceTree, WordsThatAreWalkedTogetherComeWhereEachComesAlone) {
  for (const std::uint64_t inputs : {1U, 2U, 7U, 40U}) {
    Random random(inputs);
    TraceTree tree;
    std::vector<Word> words(1);
    for (int i = 0; i < 500; ++i) {
      Word word(random.below(12));
      for (Symbol& symbol : word) symbol = static_cast<Symbol>(random.below(inputs));
      TraceTree::Node node = TraceTree::root;
      for (std::size_t step = 0; step < word.size() && random.below(9) != 0; ++step) {
        const TraceTree::Node child = tree.child(node, word[step]);
        node = child != TraceTree::none ? child : tree.add_child(node, word[step], 0);
      }
      words.push_back(word);
    }
    const std::vector<std::span<const Symbol>> spans(words.begin(), words.end());
    std::vector<std::vector<TraceTree::Node>> visited(words.size());
    tree.walk_together(spans,
                       [&](std::size_t i, TraceTree::Node node) { visited[i].push_back(node); });
    for (std::size_t i = 0; i < words.size(); ++i) {
      std::vector<TraceTree::Node> alone;
      TraceTree::Node node = TraceTree::root;
      for (const Symbol input : words[i]) {
        node = tree.child(node, input);
        if (node == TraceTree::none) break;
        alone.push_back(node);
      }
      EXPECT_EQ(visited[i], alone) << i;
    }
  }
}

TEST(TraceTree, ChildrenAreSorted) {
  TraceTree tree;
  for (const Symbol input : {9U, 3U, 64U, 1U, 17U, 33U}) {
    tree.add_child(TraceTree::root, input, input + 1);
  }
  std::vector<TraceTree::Node> children;
  tree.children(TraceTree::root, children);
  Word inputs;
  for (const TraceTree::Node child : children) inputs.push_back(tree.input(child));
  EXPECT_EQ(inputs, (Word{1, 3, 9, 17, 33, 64}));
  tree.children(children[0], children);
  EXPECT_TRUE(children.empty());
}

TEST(TraceTree, ACorrectionForgetsWhatIsBehindIt) {
  TraceTree tree;
  const auto first = tree.add_child(TraceTree::root, 0, 1);
  const auto other = tree.add_child(TraceTree::root, 1, 1);
  tree.mark(first);
  for (Symbol input = 0; input < 10; ++input) {
    const auto child = tree.add_child(first, input, 2);
    tree.add_child(child, 3, 4);
  }
  tree.correct(first, 7);
  EXPECT_EQ(tree.output(first), 7U);
  EXPECT_TRUE(tree.is_marked(first));
  EXPECT_EQ(tree.edge_count(), 2U);
  EXPECT_EQ(tree.child(first, 3), TraceTree::none);
  EXPECT_EQ(tree.child(TraceTree::root, 1), other);
  const auto again = tree.add_child(first, 3, 5);
  EXPECT_EQ(tree.child(first, 3), again);
  EXPECT_EQ(tree.edge_count(), 3U);
  tree.unmark_all();
  EXPECT_FALSE(tree.is_marked(first));
  EXPECT_EQ(tree.output(first), 7U);
}

TEST(TraceTree, MarksAreApartFromOutputs) {
  TraceTree tree;
  const auto node = tree.add_child(TraceTree::root, 0, TraceTree::symbol_limit - 1);
  EXPECT_FALSE(tree.is_marked(node));
  tree.mark(node);
  EXPECT_TRUE(tree.is_marked(node));
  EXPECT_EQ(tree.output(node), TraceTree::symbol_limit - 1);
}

TEST(TraceTree, RefusesSymbolsThatDoNotFit) {
  TraceTree tree;
  EXPECT_THROW(tree.add_child(TraceTree::root, TraceTree::symbol_limit, 0), Error);
  EXPECT_THROW(tree.add_child(TraceTree::root, 0, TraceTree::symbol_limit), Error);
  EXPECT_EQ(tree.edge_count(), 0U);
}

// Complete trees, the dearest shape (every node has a block), and random ones.
TEST(TraceTree, AnEdgeTakesAtMost16Bytes) {
  for (const Symbol inputs : {2U, 3U, 5U, 9U, 17U, 78U}) {
    TraceTree tree;
    std::vector<TraceTree::Node> level{TraceTree::root}, next;
    while (tree.edge_count() < 2'000'000) {
      next.clear();
      for (const TraceTree::Node node : level) {
        for (Symbol input = 0; input < inputs; ++input) {
          next.push_back(tree.add_child(node, input, input));
        }
        if (tree.edge_count() > 2'500'000) break;
      }
      level.swap(next);
    }
    const std::uint64_t open_chunks = 5 << 18;  // one of nodes, one of blocks
    EXPECT_LE(tree.bytes(), 16 * tree.edge_count() + open_chunks) << inputs;
  }
}

}  // namespace
}  // namespace maide
