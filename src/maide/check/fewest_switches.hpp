// The steps of a counterexample in an order that is easier to read: each program goes on as long as
// it can before another one takes its turn. The idea: of the orders in which each program keeps its
// own steps, most are as good a proof as the one that a search happened to find (Mazurkiewicz,
// "Trace theory", 1987); a shortest-path search over how far each program is, where going on with
// another program costs one, finds the order with the fewest turns (as few context switches as
// possible make concurrent traces readable: Musuvathi & Qadeer, PLDI 2007).
#pragma once

#include "maide/check/trace.hpp"

namespace maide {

// How often the trace goes on with another program than the one before.
std::size_t count_switches(const Trace& trace);

// The same steps in another order, with at most as many switches: it ends in the same state, its
// loop begins in the same state, and it is a counterexample (find_flaw) if `trace` is one. Without
// a loop and without a formula no order of these steps that ends there has fewer switches, if no
// more than `most_nodes` places had to be looked at; beyond that, programs go on as long as they
// can without overtaking others at a model. O(nodes x programs x log steps).
Trace with_fewest_switches(const System& system, const Property& property, const Trace& trace,
                           std::size_t most_nodes = 200'000);

}  // namespace maide
