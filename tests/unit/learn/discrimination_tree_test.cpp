#include "maide/learn/tree/discrimination_tree.hpp"

#include <gtest/gtest.h>

namespace maide {
namespace {

using Node = DiscriminationTree::Node;

std::vector<StateId> states_below(const DiscriminationTree& tree, Node node) {
  std::vector<StateId> states;
  tree.for_each_leaf(node, [&](Node leaf) { states.push_back(tree.state(leaf)); });
  return states;
}

// States 0 | 1 2 | 3 by the suffix {0}, and then, temporarily, 1 | 2 by {1, 1} and 2 | 4 by {1, 0}.
struct Example {
  Example() {
    tree.split(tree.leaf(0), {{0}}, {0});
    tree.add_leaf(DiscriminationTree::root, {1});
    block = tree.leaf(1);
    tree.split(block, {{1, 1}, DiscriminationTree::none, true}, {5, 5});
    tree.add_leaf(block, {5, 6});
    tree.add_leaf(DiscriminationTree::root, {2});
    inner = tree.leaf(2);
    tree.split(inner, {{1, 0}, DiscriminationTree::none, true}, {7, 7});
    tree.add_leaf(inner, {7, 8});
  }
  DiscriminationTree tree;
  Node block, inner;
};

TEST(DiscriminationTree, FindsChildrenByTheirLabels) {
  const Example example;
  const DiscriminationTree& tree = example.tree;
  EXPECT_EQ(tree.child(DiscriminationTree::root, Word{0}), tree.leaf(0));
  EXPECT_EQ(tree.child(DiscriminationTree::root, Word{1}), example.block);
  EXPECT_EQ(tree.child(DiscriminationTree::root, Word{3}), DiscriminationTree::none);
  EXPECT_EQ(tree.child(example.block, Word{5, 6}), example.inner);
  EXPECT_EQ(states_below(tree, DiscriminationTree::root), (std::vector<StateId>{0, 1, 2, 4, 3}));
}

TEST(DiscriminationTree, KnowsWhoIsAbove) {
  const Example example;
  const DiscriminationTree& tree = example.tree;
  EXPECT_EQ(tree.common_ancestor(tree.leaf(4), tree.leaf(1)), example.block);
  EXPECT_EQ(tree.common_ancestor(tree.leaf(4), tree.leaf(3)), DiscriminationTree::root);
  EXPECT_EQ(tree.common_ancestor(example.inner, tree.leaf(2)), example.inner);
  EXPECT_EQ(tree.child_towards(example.block, tree.leaf(4)), example.inner);
  EXPECT_EQ(tree.child_towards(example.inner, tree.leaf(1)), DiscriminationTree::none);
  EXPECT_EQ(tree.block_of(tree.leaf(4)), example.block);
  EXPECT_EQ(tree.block_of(tree.leaf(3)), tree.leaf(3));
}

// 1 and 4 answer alike: they stay apart by what told them apart before, the node above both.
TEST(DiscriminationTree, ABlockThatIsFinalisedKeepsWhatTheNewSuffixDoesNotTellApart) {
  Example example;
  DiscriminationTree& tree = example.tree;
  tree.finalise(example.block, {{1}}, [](StateId state) { return Word{state == 2 ? 9U : 3U}; });
  EXPECT_FALSE(tree.is_temporary(example.block));
  EXPECT_EQ(tree.suffix(example.block), Word{1});
  EXPECT_EQ(tree.child(example.block, Word{9}), tree.leaf(2));
  const Node rest = tree.child(example.block, Word{3});
  EXPECT_TRUE(tree.is_temporary(rest));
  EXPECT_EQ(tree.suffix(rest), (Word{1, 1}));
  EXPECT_EQ(tree.child(rest, Word{5, 5}), tree.leaf(1));
  EXPECT_EQ(tree.child(rest, Word{5, 6}), tree.leaf(4));
  EXPECT_EQ(tree.block_of(tree.leaf(4)), rest);
  EXPECT_EQ(states_below(tree, DiscriminationTree::root), (std::vector<StateId>{0, 1, 4, 2, 3}));
}

}  // namespace
}  // namespace maide
