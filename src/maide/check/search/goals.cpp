// What breadth-first searches look for, and how each is run: alone, or by several ranks, the first
// of which tells the others. So are searches for cycles by ranks.
#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <exception>
#include <memory>
#include <new>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "maide/base/error.hpp"
#include "maide/base/invariant.hpp"
#include "maide/base/log.hpp"
#include "maide/check/reduce/reduction.hpp"
#include "maide/check/search/breadth_first_search.hpp"
#include "maide/check/search/checkpoint.hpp"
#include "maide/check/search/fair_hull.hpp"
#include "maide/check/search/goal_rounds.hpp"
#include "maide/check/search/monitors.hpp"
#include "maide/check/search/ranks.hpp"
#include "maide/check/search/search_job.hpp"

namespace maide {
namespace {

// Goals: see goal_rounds.hpp. `depends_on_step()`: on more than the states that are
// visited.

// A state in which nothing can happen and some program has not ended and may not rest.
struct DeadlockGoal {
  const PackedSystem& system;
  static bool depends_on_step() { return false; }
  template <typename State>
  bool on_step(const State&, const State&, std::size_t, std::uint32_t, bool) const {
    return false;
  }
  template <std::size_t words>
  bool on_end(const PackedState<words>& state) const {
    return !system.is_at_rest(state);
  }
};

// A step into an error.
struct ErrorGoal {
  const PackedSystem& system;
  static bool depends_on_step() { return false; }
  template <std::size_t words>
  bool on_step(const PackedState<words>&, const PackedState<words>& next, std::size_t,
               std::uint32_t, bool is_cut) const {
    return !is_cut && system.is_error(next);
  }
  template <typename State>
  bool on_end(const State&) const {
    return false;
  }
};

// A step that commutes with the one before it is cut in either order, so the shortest run to a cut
// ends with one that no order leaves out.
struct CutGoal {
  static bool depends_on_step() { return false; }
  template <typename State>
  bool on_step(const State&, const State&, std::size_t, std::uint32_t, bool is_cut) const {
    return is_cut;
  }
  template <typename State>
  bool on_end(const State&) const {
    return false;
  }
};

// A position at which the condition does not hold; one at which the run is cut, or comes to an
// error, does not count.
struct InvariantGoal {
  const PackedSystem& system;
  Condition condition;
  bool depends_on_step() const { return condition.has_events(); }
  template <std::size_t words>
  bool on_step(const PackedState<words>&, const PackedState<words>& next, std::size_t program,
               std::uint32_t edge, bool is_cut) const {
    return !is_cut && !system.is_error(next) && !condition.is_true(system, next, program, edge);
  }
  template <std::size_t words>
  bool on_end(const PackedState<words>& state) const {
    return !condition.is_true(system, state, 0, PackedAtom::no_edge);
  }
};

// With chains a state carries more bits: worth it up to this many.
constexpr unsigned most_chain_bits = 24;
constexpr unsigned longest_chain = 8;

// The longest chain for which states of the system stay as small as they can be.
unsigned chain_length(const PackedSystem& system) {
  const unsigned state_bits = system.state_bits();
  const unsigned room = state_bits <= 64
                            ? std::min(most_chain_bits, most_bits_together - state_bits)
                            : most_chain_bits;
  unsigned chain = longest_chain;
  while (chain > 1 && chain_bits(chain, system.code_bits()) > room) --chain;
  return chain;
}

// As the search for that goal packs it.
PackedSystem pack(const System& plain, SearchJob::Goal goal, const Property& property,
                  const SearchJob::Monitor& monitor) {
  if (goal != SearchJob::Goal::cycle) return PackedSystem(plain);
  const bool is_stuck = property.kind == Property::Kind::stuck;
  return PackedSystem(plain, node_number_bits,
                      is_stuck ? plain.programs.size() + 1 : monitor.automaton.buchi.states.size());
}

// Codes that are kept mean nothing to another process, or to a later one.
void refuse_kept_codes(const PackedSystem& system, SearchJob::Goal goal,
                       const SearchLimits& limits) {
  const bool is_shared = limits.ranks != nullptr && limits.ranks->size() > 1;
  const bool is_saved = !limits.checkpoints.empty() && goal != SearchJob::Goal::cycle;
  if (!system.has_kept_codes() || (!is_shared && !is_saved)) return;
  throw UsageError(fmt::format(
      "{}: its steps forget too much for {}: a reader's death, with all that is on its way to it",
      system.system().file, is_shared ? "several processes" : "a checkpoint"));
}

// Searches breadth-first for what `make_goal(packed system)` looks for; `rules`: none takes every
// step.
template <typename MakeGoal>
SearchResult explore_for(PackedSystem system, std::optional<ReductionRules> rules,
                         Reduction reduction, const SearchLimits& limits, Checkpoint* checkpoint,
                         MakeGoal&& make_goal) {
  if (!leaves_out_orders(reduction) || system.actor_count() > most_actors_in_a_word) rules.reset();
  const unsigned chain = rules && reduction == Reduction::full ? chain_length(system) : 1;
  if (chain > 1) system = PackedSystem(system.system(), chain_bits(chain, system.code_bits()));
  std::optional<StubbornSets> sets;
  BreadthFirstOptions options(limits);
  options.checkpoint = checkpoint;
  if (rules) {
    options.sets = &sets.emplace(system, rules->sets);
    options.puts_nothing_off = rules->puts_nothing_off;
    options.chain = chain;
  }
  auto goal = make_goal(system);
  std::optional<StepOrder> order;
  if (!rules && !goal.depends_on_step()) options.order = &order.emplace(system);
  SearchResult search = with_words(system.words(), [&](auto words) {
    auto rounds = std::make_unique<GoalRounds<words.value, decltype(goal)>>(system, goal, options);
    return BreadthFirstSearch<words.value>(std::move(rounds), limits).run();
  });
  if (rules) search.reduction = chain > 1 ? Reduction::full : Reduction::order;
  return search;
}

// Searches by all ranks for a cycle that is accepted by a monitor of that type.
template <typename Monitor, typename... Arguments>
SearchResult find_cycle(const PackedSystem& system, const SearchLimits& limits,
                        Arguments&&... arguments) {
  const Monitor monitor(system, std::forward<Arguments>(arguments)...);
  return with_words_for<Monitor>(
      system, [&](auto words) { return search_hull<words.value>(system, monitor, limits); });
}
template <typename Bits>
SearchResult find_cycle(const PackedSystem& system, const Property& property,
                        const SearchJob::Monitor& monitor, const SearchLimits& limits) {
  if (property.kind == Property::Kind::stuck) {
    return find_cycle<StuckMonitor<Bits>>(system, limits, monitor.stuck);
  }
  return find_cycle<LtlMonitor<Bits>>(system, limits, monitor.automaton, property.fairness);
}

// Searches for that goal.
SearchResult explore_for_goal(PackedSystem packed, SearchJob::Goal goal, const Property& property,
                              Reduction reduction, const SearchLimits& limits,
                              const SearchJob::Monitor& monitor, Checkpoint* checkpoint) {
  using Goal = SearchJob::Goal;
  const System& plain = packed.system();
  switch (goal) {
    case Goal::deadlock:
      return explore_for(std::move(packed), rules_for_deadlock(), reduction, limits, checkpoint,
                         [](const PackedSystem& system) { return DeadlockGoal{system}; });
    case Goal::error:
      return explore_for(std::move(packed), rules_for_error(), reduction, limits, checkpoint,
                         [](const PackedSystem& system) { return ErrorGoal{system}; });
    case Goal::cut:
      return explore_for(std::move(packed), rules_for_cut(), reduction, limits, checkpoint,
                         [](const PackedSystem&) { return CutGoal{}; });
    case Goal::invariant:
      return explore_for(std::move(packed), rules_for_invariant(plain, property), reduction, limits,
                         checkpoint, [&](const PackedSystem& system) {
                           return InvariantGoal{system, Condition(invariant_of(property), plain)};
                         });
    case Goal::cycle:
      return monitor.has_wide_bits ? find_cycle<WideBits>(packed, property, monitor, limits)
                                   : find_cycle<std::uint64_t>(packed, property, monitor, limits);
    case Goal::none: break;
  }
  throw std::logic_error("a search without a goal");
}

// The others wait for what a rank does not send any more, so they end, too.
void end_all_ranks(Ranks& ranks, const std::string& why, ExitStatus status) {
  log_warning(fmt::format("the search of rank {} failed: {}", ranks.rank(), why));
  ranks.abort(static_cast<int>(status));
}

// What `work` returns. If it fails, all ranks end.
template <typename Work>
auto end_together(Ranks& ranks, Work&& work) {
  try {
    return work();
  } catch (const Error& error) {
    end_all_ranks(ranks, error.what(), error.status());
    throw;
  } catch (const std::bad_alloc&) {
    end_all_ranks(ranks, "out of memory", ExitStatus::inconclusive);
    throw;
  } catch (const std::exception& error) {
    end_all_ranks(ranks, describe_internal_error(error.what()), ExitStatus::internal);
    throw;
  }
}

}  // namespace

SearchResult explore(const System& plain, SearchJob::Goal goal, const Property& property,
                     Reduction reduction, const SearchLimits& limits,
                     const SearchJob::Monitor& monitor) {
  const auto job = [&] { return SearchJob{goal, plain, property, reduction, limits, monitor}; };
  std::optional<PackedSystem> packed;
  const auto prepare = [&] {
    packed.emplace(pack(plain, goal, property, monitor));
    refuse_kept_codes(*packed, goal, limits);
  };
  std::optional<Checkpoint> saved;
  const auto search = [&] {
    if (!limits.checkpoints.empty() && goal != SearchJob::Goal::cycle) {
      saved.emplace(limits.checkpoints, key_of(job()), limits.checkpoint_seconds);
    }
    return explore_for_goal(std::move(*packed), goal, property, reduction, limits, monitor,
                            saved ? &*saved : nullptr);
  };
  // What is refused here is refused before another rank hears of it.
  if (limits.ranks == nullptr || limits.ranks->rank() == 0) prepare();
  if (limits.ranks == nullptr) return search();
  return end_together(*limits.ranks, [&] {
    if (limits.ranks->rank() == 0) {
      Ranks::Bytes bytes = encode(job());
      limits.ranks->broadcast(bytes, 0);
    } else {
      prepare();
    }
    return search();
  });
}

void serve_searches(Ranks& ranks) {
  MAIDE_CHECK_ALWAYS(ranks.rank() != 0);
  while (true) {
    Ranks::Bytes bytes;
    ranks.broadcast(bytes, 0);
    SearchJob job = end_together(ranks, [&] { return decode(bytes); });
    if (job.goal == SearchJob::Goal::none) return;
    job.limits.ranks = &ranks;
    explore(job.system, job.goal, job.property, job.reduction, job.limits, job.monitor);
  }
}

void end_searches(Ranks& ranks) {
  Ranks::Bytes bytes = encode(SearchJob{});
  ranks.broadcast(bytes, 0);
}

}  // namespace maide
