// Adaptive experiments as they are put together from parts: decision trees (sul/query.hpp) whose
// *outcomes* are the outputs up to one without a branch. Outcomes of one experiment are no prefixes
// of each other.
#pragma once

#include <span>
#include <vector>

#include "maide/automata/mealy.hpp"
#include "maide/sul/query.hpp"

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

}  // namespace maide
