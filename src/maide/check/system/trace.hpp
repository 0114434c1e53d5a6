// Traces: runs of a system that an engine shows as proof of an alarm. No trace is shown before it
// was replayed on the system's own semantics. Here are that replay, the test whether a trace is
// what it claims to be, and an order of its steps that is easier to read.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "maide/check/system/components.hpp"
#include "maide/check/system/system.hpp"

namespace maide {

// A run of a system, which may repeat a part for ever.
struct Trace {
  std::vector<Step> steps;  // from the initial state
  // Steps from here on repeat for ever (closed()). None: the run ends there, is cut, or need not be
  // shown any further because whatever comes violates the property.
  std::optional<std::size_t> loop_start;
  bool operator==(const Trace&) const = default;
};

// A run of the part as one of the whole system, and back.
Trace to_whole(const SystemPart& part, Trace trace);
Trace from_whole(const SystemPart& part, Trace trace);

// That step, or else the first that does the same, in a state in which models may be elsewhere.
std::optional<Step> step_like(const System& system, const GlobalState& at, const Step& as_told);

// The states along the trace, one more than steps. Throws std::logic_error if a step is not
// possible where it is taken, or the loop cannot repeat for ever.
std::vector<GlobalState> replay(const System& system, const Trace& trace);

// The same run with a loop that closes: its last state is the one in which it begins. A loop need
// not close after one round: a queue that nobody empties fills in it, and only when it is full, the
// states come again. Then each round has the same steps, and looks like the first: at each step the
// same programs and their fair groups can go on, and the same `atoms` are true. So what is true of
// one round is true of all. Without atoms a later round may lack a step of nobody that is not
// possible any more, where the last rounds are as fair to nobody as the first. Nothing if there is
// no such run, or it takes more than 4,096 further steps. `looked_at`: those steps are added.
// O(those x programs).
std::optional<Trace> closed(const System& system, const Trace& trace,
                            const std::vector<GlobalState>& states,
                            const std::vector<Atom>& atoms = {},
                            std::uint64_t* looked_at = nullptr);
// The models whose state is another one after the loop's first round. `states` are replay()'s.
std::vector<std::uint32_t> models_that_change(const Trace& trace,
                                              const std::vector<GlobalState>& states);

// Whether the formula holds at each position of the run: position 0 is the initial state, position
// i the state after i steps; a run that ends has one more, at which it repeats its last state
// without the event that led there. `states` are replay()'s.
std::vector<bool> evaluate_on_run(const System& system, const Formula& formula, const Trace& trace,
                                  const std::vector<GlobalState>& states);

// Whether the loop of a run is one of the runs that count under that fairness. `states` are
// replay()'s.
bool is_fair(const System& system, const Trace& trace, const std::vector<GlobalState>& states,
             Fairness fairness);

// Whether the trace is what it claims to be: it replays and shows that `property` does not hold - a
// deadlock, a fair run that violates the formula, or a prefix that no run can make good. Returns
// what is wrong with it, "" if nothing is.
std::string find_flaw(const System& system, const Property& property, const Trace& trace);

// ---- The order of the steps ----
//
// A counterexample is easier to read if each actor goes on as long as it can before another one
// takes its turn. The idea: of the orders in which each actor keeps its own steps, most are as
// good a proof as the one that a search happened to find (Mazurkiewicz, "Trace theory", 1987). A
// shortest-path search over how far each program is finds the order with the fewest turns; going on
// with another program costs one. (Few context switches make concurrent traces readable: Musuvathi
// & Qadeer, PLDI 2007.)

// How often the trace goes on with another actor than the one before.
std::size_t count_switches(const Trace& trace);

// The same steps in another order, with at most as many switches: it ends in the same state, its
// loop begins in the same state, and it is a counterexample (find_flaw) if `trace` is one. Without
// a loop and without a formula no order of these steps that ends there has fewer switches, if no
// more than `most_nodes` places had to be looked at; beyond that, programs go on as long as they
// can without overtaking others at a model. O(nodes x programs x log steps).
Trace with_fewest_switches(const System& system, const Property& property, const Trace& trace,
                           std::size_t most_nodes = 200'000);

}  // namespace maide
