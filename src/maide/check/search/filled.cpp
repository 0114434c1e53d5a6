#include "maide/check/search/filled.hpp"

#include <algorithm>
#include <memory>
#include <utility>

#include "maide/check/search/breadth_first_search.hpp"
#include "maide/check/search/goal_rounds.hpp"

namespace maide {
namespace {

// A step into a state in which one of the queues is full.
struct FilledGoal {
  const PackedSystem& system;
  const std::vector<FillableQueue>& queues;
  static bool depends_on_step() { return false; }
  template <std::size_t words>
  bool on_step(const PackedState<words>&, const PackedState<words>& next, std::size_t,
               std::uint32_t, bool is_cut) const {
    return !is_cut && std::ranges::any_of(queues, [&](const FillableQueue& queue) {
      std::uint32_t held = 0;
      for (const FillableQueue::Part& part : queue.parts) {
        held += part.held[system.model_state(next, part.model)];
      }
      return held >= queue.room;
    });
  }
  template <typename State>
  bool on_end(const State&) const {
    return false;
  }
};

}  // namespace

SearchResult find_filled(const System& system, const std::vector<FillableQueue>& queues,
                         const SearchLimits& limits) {
  const PackedSystem packed(system);
  const BreadthFirstOptions options(limits);
  return with_words(packed.words(), [&](auto words) {
    auto rounds = std::make_unique<GoalRounds<words.value, FilledGoal>>(
        packed, FilledGoal{packed, queues}, options);
    return BreadthFirstSearch<words.value>(std::move(rounds), limits).run();
  });
}

}  // namespace maide
