// Adaptive distinguishing sequences out of an observation tree: a decision tree that tells as many
// of several nodes apart as what is known allows (Lee & Yannakakis, "Testing finite-state machines:
// state identification and verification", IEEE ToC 1994; from partial knowledge: Vaandrager,
// Garhewal, Rot & Wissmann, TACAS 2022).
//
// Greedy: the input of least estimated cost comes first, one symbol and for each output the rest,
// which grows with the logarithm of the nodes that are left. Looking further ahead asks no less.
// Nodes that are likely weigh more, as letters do in Huffman's code: what is usual should be quick
// to recognise.
#pragma once

#include <deque>
#include <vector>

#include "maide/learn/observation_tree.hpp"
#include "maide/sul/query.hpp"

namespace maide {

// One of the nodes that may be meant.
struct Suspect {
  ObservationTree::Node node;
  double weight;  // proportional to the probability that it is meant; positive
};

// The decision tree for `suspects`; without nodes if no two of them are apart. Every path through
// it tells at least two suspects apart, if its last output is a known one. It has no more than
// `most_inputs` inputs, those that are likely to be asked, unless it takes more to tell any apart.
// O(inputs x suspects x length), and the trees below the suspects for each input that tells none
// apart.
//
// `witnesses` are words that told some apart before: they are tried where a shortest such word lies
// deep, and those that are found there are added. It may be null.
DecisionTree find_adaptive_sequence(const ObservationTree& tree, std::vector<Suspect> suspects,
                                    std::size_t most_inputs = ~std::size_t{0},
                                    std::deque<Word>* witnesses = nullptr);

}  // namespace maide
