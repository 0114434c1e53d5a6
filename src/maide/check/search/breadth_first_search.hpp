// Breadth-first search of a system's states for a step or a state that somebody looks for. It shows
// a shortest run to it, if nothing is left out. Levels are plain lists of packed states. Visited
// states lie in a StateTable, each with the code of the step that led to it (packed_system.hpp). So
// the run is read off backwards, and costs a few bits a state.
//
// A level is searched in rounds (rounds.hpp), by threads. Other processes can take part
// (ranks.hpp). All search one level at a time, so depths are the same, and so are states and
// transitions of a search that comes to its end with nothing left out. While the batches of one
// round are on their way, the next one is expanded.
//
// The search saves work in three ways:
//
//   order   all states are visited, but not every transition is followed (step_order.hpp)
//   sets    only the steps of stubborn sets are taken (stubborn_sets.hpp). Where no step may be put
//           off for ever, a state whose steps lead to no new state is expanded whole, in the next
//           round. Each state then has a way to a later one at which the steps left out are still
//           possible
//   chains  a state with a single step is passed by and not stored, a few in a row at most; the
//           codes of all their steps are kept with the state at the end
//
// Example of a chain: one program computes, and all others have ended. Where a second program can
// step, too, no state is passed by.
//
// Sources for expanding whole: Evangelista & Pajault, "Solving the ignoring problem for partial
// order reduction", STTT 2010; Bosnacki & Holzmann, "Improving Spin's partial-order reduction for
// breadth-first search", SPIN 2005.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

#include "maide/check/packed/packed_system.hpp"
#include "maide/check/packed/state_table.hpp"
#include "maide/check/search/rounds.hpp"
#include "maide/check/search/search.hpp"
#include "maide/check/system/trace.hpp"

namespace maide {

// Compiled for the sizes of states that with_words() tells apart.
template <std::size_t words>
class BreadthFirstSearch {
 public:
  using State = PackedState<words>;

  // By rounds that nobody else has used; their system was made with chain_bits(chain) of payload.
  // Keeps references to the system and `limits`.
  BreadthFirstSearch(std::unique_ptr<SearchRounds<words>> rounds, const SearchLimits& limits);
  // Visits all that can be reached.
  BreadthFirstSearch(const PackedSystem& system, const SearchLimits& limits,
                     const BreadthFirstOptions& options);
  ~BreadthFirstSearch();

  // With ranks: on all of them, which have the same result.
  SearchResult run();

  // ---- behind run(), of this process ----

  const StateTable<words>& table() const;
  std::uint64_t bytes() const;
  // The run by which the search came to a state of the table.
  Trace run_to(const State& state) const;

 private:
  class Search;
  std::unique_ptr<Search> search_;
};

}  // namespace maide
