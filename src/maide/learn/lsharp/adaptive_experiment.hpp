// Adaptive experiments: decision trees (sul/sul.hpp) put together from parts, and adaptive
// distinguishing sequences out of an observation tree. The *outcomes* of an experiment are the
// outputs up to one without a branch; no outcome is a prefix of another.
#pragma once

#include <cstdint>
#include <deque>
#include <span>
#include <unordered_map>
#include <vector>

#include "maide/automata/alphabet.hpp"
#include "maide/automata/mealy.hpp"
#include "maide/learn/lsharp/observation_tree.hpp"
#include "maide/sul/sul.hpp"

namespace maide {

// Asks `inputs` one after the other for as long as `outputs` come; all of these but the last are
// needed.
DecisionTree chain(std::span<const Symbol> inputs, std::span<const Symbol> outputs);

// Makes `subtree` what follows after `output` at `node`. O(subtree).
void graft(DecisionTree& tree, std::size_t node, Symbol output, const DecisionTree& subtree);
// The same after each of `outputs`.
void graft(DecisionTree& tree, std::size_t node, std::span<const Symbol> outputs,
           const DecisionTree& subtree);

// Makes `subtree` what follows after an outcome. O(outcome + subtree).
void lengthen(DecisionTree& tree, std::span<const Symbol> outcome, const DecisionTree& subtree);

// The inputs that an outcome answers. O(outcome).
Word inputs_along(const DecisionTree& tree, std::span<const Symbol> outcome);

// ---- Adaptive distinguishing sequences ----
//
// A decision tree that tells as many of several nodes of an observation tree apart as what is known
// allows (Lee & Yannakakis, "Testing finite-state machines: state identification and verification",
// IEEE ToC 1994; from partial knowledge: Vaandrager, Garhewal, Rot & Wissmann, TACAS 2022).
//
// The choice is greedy: the input of least estimated cost comes first. The cost is one symbol and,
// for each output, the rest, which grows with the logarithm of the nodes that are left. Looking
// further ahead asks no less. Likely nodes weigh more, as letters do in Huffman's code: what is
// usual is quick to recognise.

// One of the nodes that may be meant, and how likely it is.
struct WeightedNode {
  ObservationTree::Node node;
  double weight;  // proportional to the probability that it is meant; positive
};

// What the plans for one observation tree have in common.
struct KnownWitnesses {
  // Words that told some candidates apart: they are tried where a shortest such word lies deep.
  std::deque<Word> deep;
  // What the search for a shortest one came to, by the candidates' nodes. Valid as long as the tree
  // has `tree_size` nodes: plans for the queries of one batch split into the same groups.
  struct Search {
    Word witness;
    bool was_cut = false;  // too many nodes were left to look at
  };
  std::unordered_map<std::vector<ObservationTree::Node>, Search, WordHash> searches;
  std::size_t tree_size = 0;
};

// The decision tree for `candidates`; without nodes if no two of them are apart. Every path through
// it tells at least two candidates apart, if its last output is a known one. It has no more than
// `most_inputs` inputs, those that are likely to be asked, unless it takes more to tell any apart.
// O(inputs x candidates x length), and the trees below the candidates for each input that tells
// none apart.
//
// `known` is used and added to; null: nothing is kept.
DecisionTree find_adaptive_sequence(const ObservationTree& tree,
                                    std::vector<WeightedNode> candidates,
                                    std::size_t most_inputs = ~std::size_t{0},
                                    KnownWitnesses* known = nullptr);

}  // namespace maide
