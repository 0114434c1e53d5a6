// Adaptive distinguishing sequences of some states of a machine (Lee & Yannakakis, "Testing
// finite-state machines: state identification and verification", IEEE ToC 1994): a decision tree
// that each of them answers in its own way. Few sets of states have one: no two of them may become
// one before they have answered differently.
//
// A shortest word that parts the states comes first, of several the one whose largest part is
// smallest; then what parts each part; if one of them cannot be parted, the next word. That search
// is exponential, so it ends after some effort: what it does not find may still be there.
#pragma once

#include <optional>
#include <vector>

#include "maide/automata/mealy.hpp"
#include "maide/sul/query.hpp"

namespace maide {

// For at least two states, none twice, of a complete machine. `effort`: sets of states to look at,
// O(inputs states) each.
std::optional<DecisionTree> find_distinguishing_sequence(const Mealy& machine,
                                                         const std::vector<StateId>& states,
                                                         std::size_t effort);

}  // namespace maide
