// Whether from every state that the system comes to some run comes to a state in which an
// expression holds: AG EF of branching-time logic (Clarke, Emerson, Sistla, TOPLAS 1986).
//
// One search visits all states, and one goes backward from the steps and states in which the
// expression holds. Nothing is left out: an order that makes no difference to a run may make one to
// what is possible from a state. Behind the bounds of what was learned, and behind an error, nobody
// knows; states from which runs come there, and not to the expression, leave it open.
// Invariant: a state's number is its place in the order of the search, so the first state from
// which the expression is out of reach has a shortest run.
//
// O(states + steps) time; some 8 bytes a step, and 100 a state.
#pragma once

#include "maide/check/search/search.hpp"
#include "maide/check/system/system.hpp"

namespace maide {

struct AlwaysPossible {
  // `found`: the trace comes to where the expression is out of reach.
  SearchResult search;
  bool depends_on_bounds = false;  // it holds if what lies behind the bounds comes to it
};

// `property.formula` is the expression.
AlwaysPossible search_always_possible(const System& system, const Property& property,
                                      const SearchLimits& limits);

}  // namespace maide
