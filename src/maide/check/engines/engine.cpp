#include "maide/check/engines/engine.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <new>
#include <optional>
#include <stdexcept>
#include <type_traits>
#include <utility>
#include <vector>

#include "maide/base/error.hpp"
#include "maide/base/text.hpp"
#include "maide/base/thread_team.hpp"
#include "maide/check/engines/ltsmin_engine.hpp"
#include "maide/check/engines/spin_engine.hpp"
#include "maide/check/reduce/merged_calls.hpp"
#include "maide/check/reduce/reduction.hpp"
#include "maide/check/search/always_possible.hpp"
#include "maide/check/search/fair_cycle.hpp"
#include "maide/check/search/monitors.hpp"
#include "maide/check/search/search_job.hpp"
#include "maide/check/search/short_lasso.hpp"
#include "maide/check/search/shrunk_run.hpp"

namespace maide {

std::uint64_t memory_limit_mib(const EngineOptions& options) {
  if (options.memory_mib) return *options.memory_mib;
  const auto pages = static_cast<std::uint64_t>(::sysconf(_SC_PHYS_PAGES));
  const auto page = static_cast<std::uint64_t>(::sysconf(_SC_PAGE_SIZE));
  const unsigned sharers = options.ranks == nullptr ? 1 : options.ranks->on_this_machine();
  return std::max<std::uint64_t>(256, (pages * page / 4 * 3 >> 20) / sharers);
}

unsigned thread_count(const EngineOptions& options) {
  if (options.threads != 0) return options.threads;
  const unsigned sharers = options.ranks == nullptr ? 1 : options.ranks->on_this_machine();
  return std::max(1U, processor_count() / sharers);
}

std::string why_stopped(const EngineOptions& options) {
  return options.control.stop.stop_requested() ? "interrupted" : "out of time";
}

void require_sound(const std::string& engine, const System& system, const Property& property,
                   const Trace& trace) {
  const std::string flaw = find_flaw(system, property, trace);
  if (flaw.empty()) return;
  throw std::logic_error(
      fmt::format("{}'s counterexample for '{}' does not replay: {}", engine, property.name, flaw));
}

std::unique_ptr<Engine> make_engine(const std::string& name) {
  if (name == "spin") return std::make_unique<SpinEngine>();
  if (name == "ltsmin") return std::make_unique<LtsminEngine>();
  if (name == "native") return std::make_unique<NativeEngine>();
  const std::vector<std::string> known{"native", "spin", "ltsmin"};
  throw UsageError("there is no engine '" + name + "'; there is: " + join(known) +
                   did_you_mean(name, known));
}

void require_fitting(const Engine& engine, const EngineOptions& options) {
  const std::string name = engine.name();
  if (options.threads > 0 && name == "spin") {
    throw UsageError("spin searches with one thread; --threads is for native and ltsmin");
  }
  if (!options.checkpoints.empty() && name != "native") {
    throw UsageError("--checkpoint is for the engine native, not for " + name);
  }
  if (options.ranks != nullptr && name != "native") {
    throw UsageError("mpirun is for the engine native, not for " + name);
  }
}

namespace {

using Clock = std::chrono::steady_clock;

SearchLimits limits_of(const EngineOptions& options) {
  SearchLimits limits;
  limits.bytes = memory_limit_mib(options) << 20;
  limits.states = options.most_states;
  limits.shortens = options.shortens;
  limits.threads = thread_count(options);
  limits.states_a_thread = options.states_a_thread;
  limits.ranks = options.ranks;
  limits.checkpoints = options.checkpoints;
  limits.checkpoint_seconds = options.checkpoint_seconds;
  limits.control = options.control;
  return limits;
}

// Calls `search(system, reduction, limits)`: on the system with merged calls, if `rules` say what
// may be merged and anything is. What it finds is told of the system itself.
template <typename Search>
auto search_with_calls(const System& system, const std::optional<CallRules>& rules,
                       const EngineOptions& options, Search&& search) {
  std::optional<MergedCalls> merged;
  if (rules && merges_calls(options.reduction) && MergedCalls::has_calls(system)) {
    merged.emplace(system, *rules);
  }
  if (!merged || merged->is_empty()) return search(system, options.reduction, limits_of(options));
  auto result = search(merged->system(), options.reduction, limits_of(options));
  const auto expand = [&](SearchResult& found) {
    found.reduction = found.reduction == Reduction::none ? Reduction::calls : Reduction::full;
    if (found.trace) found.trace = merged->expand(*found.trace);
    if (found.remarkable) found.remarkable = merged->expand(*found.remarkable);
  };
  if constexpr (std::is_same_v<decltype(result), SearchResult>) {
    expand(result);
  } else if (result) {
    expand(*result);
  }
  return result;
}

// A reduced search shows some run, not a shortest one: that is looked for among all runs that are
// no longer, unless it takes too many states.
constexpr std::uint64_t shortening_states = std::uint64_t{1} << 22;

// Searches breadth-first by `search(system, reduction, limits)`.
template <typename Search>
SearchResult search_for_shortest(const System& system, const std::optional<CallRules>& rules,
                                 const EngineOptions& options, Search&& search) {
  SearchResult result = search_with_calls(system, rules, options, search);
  if (result.reduction == Reduction::none || result.end != SearchResult::End::found) return result;
  if (!options.shortens) return result;
  SearchLimits limits = limits_of(options);
  limits.depth = result.trace->steps.size();
  limits.states = std::max(shortening_states, 16 * result.states);
  SearchResult shorter = search(system, Reduction::none, limits);
  result.bytes = std::max(result.bytes, shorter.bytes);
  if (shorter.trace && shorter.trace->steps.size() < result.trace->steps.size()) {
    result.trace = std::move(shorter.trace);
  }
  return result;
}

std::string why_incomplete(const SearchResult& search, const EngineOptions& options) {
  const std::string reached =
      fmt::format("after {} states, to depth {}", search.states, search.depth);
  const std::string found = search.has_violation
                                ? "it is violated, but no run that shows it was worked out"
                                : "nothing found so far";
  if (search.end == SearchResult::End::out_of_memory) {
    return fmt::format("the search needs more than {} MiB of memory {}: {}",
                       limits_of(options).bytes >> 20, reached, found);
  }
  return fmt::format("{} {}: {}", why_stopped(options), reached, found);
}

// By several ranks. What they find is a node near a cycle; this one goes on from there.
template <std::size_t words, typename Monitor>
SearchResult find_fair_cycle_on_ranks(const PackedSystem& system, const Monitor& monitor,
                                      const Property& property, const SearchLimits& limits,
                                      const SearchJob::Monitor& job) {
  if (auto small = search_small<words>(system, monitor, limits)) return std::move(*small);
  SearchResult all =
      explore(system.system(), SearchJob::Goal::cycle, property, Reduction::none, limits, job);
  if (!all.near) return all;
  auto node = system.pack<words>(all.near->first);
  system.monitor().set(node, all.near->second);
  SearchResult found = FairCycleSearch<words, Monitor>(system, monitor, limits)
                           .run_from(node, std::move(*all.trace));
  if (found.end == SearchResult::End::complete) {
    throw std::logic_error("there is no fair cycle where the ranks found one");
  }
  found.has_violation = true;
  found.states = all.states;
  found.transitions = all.transitions;
  found.bytes = std::max(found.bytes, all.bytes);
  found.sent_bytes = all.sent_bytes;
  return found;
}

// `job`: the monitor, for other ranks.
template <typename Monitor>
SearchResult find_fair_cycle(const PackedSystem& system, const Monitor& monitor,
                             const Property& property, Reduction reduction,
                             const SearchLimits& limits, const SearchJob::Monitor& job) {
  std::optional<ReductionRules> rules;
  if (leaves_out_orders(reduction) && system.actor_count() <= most_actors_in_a_word) {
    rules = rules_for_cycle(system.system(), property);
  }
  std::optional<StubbornSets> sets;
  if (rules) sets.emplace(system, std::move(rules->sets));
  SearchResult search = with_words_for<Monitor>(system, [&](auto words) {
    if (!sets && limits.ranks != nullptr) {
      return find_fair_cycle_on_ranks<words.value>(system, monitor, property, limits, job);
    }
    PartsSearch<words.value, Monitor> parts(system, monitor, limits);
    if (!sets && limits.threads > 1 && parts.pays()) return parts.run();
    return FairCycleSearch<words.value, Monitor>(system, monitor, limits, sets ? &*sets : nullptr)
        .run();
  });
  if (rules) search.reduction = Reduction::order;
  return search;
}

// Nodes that a search for the nearest run may take. It is a fixed number, for that run is to depend
// on the system alone.
constexpr std::uint64_t nearest_nodes = std::uint64_t{1} << 18;

// The first position of the run from which on some program that is stuck could not step.
std::size_t stuck_from(const System& system, const Trace& trace) {
  const std::vector<GlobalState> states = replay(system, trace);
  std::size_t earliest = trace.steps.size();
  for (std::uint32_t index = 0; index < system.programs.size(); ++index) {
    const Program& program = system.programs[index];
    const ControlState last = states.back().programs[index];
    if (program.is_end(last) || program.may_rest(last) || !program.flags.is_fair) continue;
    std::size_t from = states.size();
    for (; from > 0; --from) {
      if (from <= trace.steps.size() && trace.steps[from - 1].actor == index) break;
      const auto steps = enabled_steps(system, states[from - 1], index);
      if (std::ranges::any_of(steps, [&](const Step& step) { return is_progress(system, step); })) {
        break;
      }
    }
    // Position `from` is reached by the program's own step, or the first behind one where it could.
    earliest = std::min(earliest, from);
  }
  return earliest;
}

// Looks for a run that is shorter than the one that was found, near the start; and for one that
// leaves the nodes in which the monitor waits as early as any: where a program can be stuck first.
// Ways round are not compared with wide sets, for there are too many needs.
template <typename Monitor>
class ShorterRun {
 public:
  ShorterRun(const PackedSystem& system, const Monitor& monitor, const Property& property,
             const SearchLimits& limits)
      : system_(system), monitor_(monitor), property_(property), limits_(limits) {
    limits_.control.progress = nullptr;
    limits_.ranks = nullptr;
  }

  Trace find(Trace found) const {
    try {
      return with_words_for<Monitor>(system_,
                                     [&](auto words) { return find_in<words.value>(found); });
    } catch (const std::bad_alloc&) {  // the longer one is a violation, too
    } catch (const Interrupted&) {
    }
    return found;
  }

 private:
  bool is_good(const Trace& trace) const {
    return find_flaw(system_.system(), property_, trace).empty();
  }

  template <std::size_t words>
  Trace find_in(const Trace& found) const {
    Trace best = found;
    if constexpr (!uses_wide_bits<Monitor>) {
      auto shorter =
          ShortLasso<words, Monitor>(system_, monitor_, limits_.control)
              .find(best.steps.size() + 1, [this](const Trace& trace) { return is_good(trace); });
      if (shorter) best = std::move(*shorter);
    }
    if (monitor_.may_wait()) {
      if (auto nearest = find_nearest<words>(best)) best = std::move(*nearest);
    }
    return best;
  }

  // Nothing if it is no better.
  template <std::size_t words>
  std::optional<Trace> find_nearest(const Trace& best) const {
    const bool is_stuck = property_.kind == Property::Kind::stuck;
    const std::size_t from = is_stuck ? stuck_from(system_.system(), best) : 0;
    if (is_stuck && from <= 1) return std::nullopt;
    FairCycleSearch<words, Monitor> search(system_, monitor_, limits_, nullptr, nearest_nodes);
    SearchResult result = search.run_nearest();
    if (!result.trace || !is_good(*result.trace)) return std::nullopt;
    const std::size_t way = search.way().steps.size();
    Trace nearest = std::move(*result.trace);
    if constexpr (!uses_wide_bits<Monitor>) {
      const auto whole = [&](const Trace& rest) {
        Trace trace = search.way();
        if (rest.loop_start) trace.loop_start = way + *rest.loop_start;
        trace.steps.insert(trace.steps.end(), rest.steps.begin(), rest.steps.end());
        return trace;
      };
      auto shorter =
          ShortLasso<words, Monitor>(system_, monitor_, limits_.control)
              .find(nearest.steps.size() - way,
                    [&](const Trace& rest) { return is_good(whole(rest)); }, {search.entry()});
      if (shorter) nearest = whole(*shorter);
    }
    const bool is_nearer = is_stuck && 2 * from > 3 * way;
    if (!is_nearer && nearest.steps.size() >= best.steps.size()) return std::nullopt;
    return nearest;
  }

  const PackedSystem& system_;
  const Monitor& monitor_;
  const Property& property_;
  SearchLimits limits_;
};

template <typename Monitor>
void shorten(const PackedSystem& system, const Monitor& monitor, const Property& property,
             const SearchLimits& limits, SearchResult& search) {
  if (!limits.shortens || search.end != SearchResult::End::found || !search.trace) return;
  search.trace =
      ShorterRun<Monitor>(system, monitor, property, limits).find(std::move(*search.trace));
}

// Whoever is stuck starves on runs that are weakly fair, too, and those are found faster. So they
// are looked for first, and strong fairness matters only where there are some. If strongly fair
// runs leave nobody stuck, one that starves on weakly fair runs is only remarked.
template <typename Bits>
SearchResult search_for_stuck(const System& plain, const Property& property, Reduction reduction,
                              const SearchLimits& limits) {
  const PackedSystem system(plain, node_number_bits, plain.programs.size() + 1);
  if constexpr (!std::is_same_v<Bits, WideBits>) {
    if (system.words() > most_own_words) {
      return search_for_stuck<WideBits>(plain, property, reduction, limits);
    }
  }
  const auto search = [&](StuckRuns runs) {
    Property wanted = property;
    wanted.fairness = runs == StuckRuns::strongly_fair ? Fairness::strong : Fairness::weak;
    SearchJob::Monitor job;
    job.stuck = runs;
    job.has_wide_bits = std::is_same_v<Bits, WideBits>;
    return find_fair_cycle(system, StuckMonitor<Bits>(system, runs), wanted, reduction, limits,
                           job);
  };
  const auto shortened = [&](SearchResult found) {
    const StuckMonitor<Bits> monitor(system, StuckRuns::strongly_fair);
    shorten(system, monitor, property, limits, found);
    return found;
  };
  SearchResult weak = search(StuckRuns::weakly_fair);
  const bool is_shown = weak.end == SearchResult::End::found;
  // Where somebody starves on a weakly fair run that was not worked out, strong fairness decides.
  if (!is_shown && !weak.has_violation) return weak;
  if (is_shown && find_flaw(plain, property, *weak.trace).empty()) {
    return shortened(std::move(weak));
  }
  SearchResult strong = search(StuckRuns::strongly_fair);
  if (strong.end != SearchResult::End::complete) return shortened(std::move(strong));
  if (system.has_groups_on_weak_runs()) weak = search(StuckRuns::weakly_fair_with_groups);
  strong.bytes = std::max(strong.bytes, weak.bytes);
  if (weak.end == SearchResult::End::found) strong.remarkable = std::move(weak.trace);
  return strong;
}

template <typename Bits>
SearchResult search_for_run(const System& plain, const Property& property,
                            StreettAutomaton automaton, Reduction reduction,
                            const SearchLimits& limits) {
  const PackedSystem system(plain, node_number_bits, automaton.buchi.states.size());
  if constexpr (!std::is_same_v<Bits, WideBits>) {
    if (system.words() > most_own_words) {
      return search_for_run<WideBits>(plain, property, std::move(automaton), reduction, limits);
    }
  }
  SearchJob::Monitor job;
  job.automaton = automaton;
  job.has_wide_bits = std::is_same_v<Bits, WideBits>;
  const LtlMonitor<Bits> monitor(system, std::move(automaton), property.fairness);
  SearchResult search = find_fair_cycle(system, monitor, property, reduction, limits, job);
  shorten(system, monitor, property, limits, search);
  return search;
}

// The automaton of the runs that violate the property; nothing if the control says to stop.
std::optional<StreettAutomaton> violating_runs(const Property& property,
                                               const RunControl& control) {
  if (property.kind == Property::Kind::never) return StreettAutomaton{*property.never, {}, {}};
  try {
    return translate_with_pairs(make_formula(FormulaNode::Operator::negation, property.formula),
                                control);
  } catch (const Interrupted&) {
    return std::nullopt;
  }
}

// Nothing if the system is too large for it.
std::optional<SearchResult> search_for_cycle(const System& plain, const Property& property,
                                             Reduction reduction, const SearchLimits& limits) {
  const std::size_t programs = plain.programs.size();
  std::size_t bits = actor_count(plain);
  std::size_t groups = 0;
  for (const Program& program : plain.programs) {
    groups += std::max<std::size_t>(program.fair_groups.size(), 1) - 1;
  }
  groups += std::max<std::size_t>(plain.nobodys_groups.size(), 1) - 1;
  bits = std::max(bits, groups);
  if (property.kind == Property::Kind::stuck) {
    if (bits <= bit_count_of<std::uint64_t>) {
      return search_for_stuck<std::uint64_t>(plain, property, reduction, limits);
    }
    if (bits > bit_count_of<WideBits>) return std::nullopt;
    return search_for_stuck<WideBits>(plain, property, reduction, limits);
  }
  std::optional<StreettAutomaton> automaton = violating_runs(property, limits.control);
  if (!automaton) {
    SearchResult stopped;
    stopped.end = SearchResult::End::stopped;
    return stopped;
  }
  const std::size_t marks = automaton->buchi.mark_count + 2 * automaton->most_pairs() +
                            (property.fairness == Fairness::weak ? programs : 0);
  bits = std::max(bits, marks);
  if (bits <= bit_count_of<std::uint64_t>) {
    return search_for_run<std::uint64_t>(plain, property, std::move(*automaton), reduction, limits);
  }
  // The automaton's own marks are bits of a word.
  if (bits > bit_count_of<WideBits> || automaton->buchi.mark_count >= 64) return std::nullopt;
  return search_for_run<WideBits>(plain, property, std::move(*automaton), reduction, limits);
}

bool needs_cycle(const Property& property) {
  if (property.kind == Property::Kind::stuck) return true;
  if (property.kind == Property::Kind::never) return true;
  return property.kind == Property::Kind::ltl && !invariant_of(property);
}

// The initial state shows the violation.
SearchResult find_at_start() {
  SearchResult search;
  search.end = SearchResult::End::found;
  search.states = 1;
  search.trace.emplace();
  return search;
}

SearchResult search_for(const System& plain, const Property& property, Reduction reduction,
                        const SearchLimits& limits) {
  if (property.kind == Property::Kind::deadlock) {
    return explore(plain, SearchJob::Goal::deadlock, property, reduction, limits);
  }
  const bool begins_at_error = is_error(plain, initial_state(plain));
  if (property.kind == Property::Kind::error) {
    if (begins_at_error) return find_at_start();
    return explore(plain, SearchJob::Goal::error, property, reduction, limits);
  }
  const Condition condition(invariant_of(property), plain);
  const PackedSystem packed(plain);
  const bool holds_first = with_words(packed.words(), [&](auto words) {
    const auto initial = packed.pack<words.value>(initial_state(plain));
    return condition.is_true(packed, initial, 0, PackedAtom::no_edge);
  });
  if (!holds_first) return find_at_start();
  if (begins_at_error) {
    SearchResult search;
    search.states = 1;
    return search;
  }
  return explore(plain, SearchJob::Goal::invariant, property, reduction, limits);
}

}  // namespace

std::string NativeEngine::obstacle(const System& /*system*/, const Property& /*property*/) const {
  return "";
}

PropertyResult NativeEngine::check(const System& system, const Property& property,
                                   const EngineOptions& options) {
  const auto start = Clock::now();
  PropertyResult result;
  result.name = property.name;
  SearchResult search;
  bool depends_on_bounds = false;
  const bool is_always_possible = property.is_always_possible;
  const std::optional<CallRules> rules =
      is_always_possible ? std::nullopt : rules_for_calls(system, property);
  if (is_always_possible) {
    AlwaysPossible found = search_always_possible(system, property, limits_of(options));
    search = std::move(found.search);
    depends_on_bounds = found.depends_on_bounds;
  } else if (needs_cycle(property)) {
    std::optional<SearchResult> cycle = search_with_calls(
        system, rules, options,
        [&](const System& reduced, Reduction reduction, const SearchLimits& limits) {
          return search_for_cycle(reduced, property, reduction, limits);
        });
    if (!cycle) {
      result.reason = fmt::format(
          "the engine native takes at most {} programs, together with the formula's "
          "eventualities, and as many arms and fair choices",
          bit_count_of<WideBits>);
      return result;
    }
    search = std::move(*cycle);
    if (search.trace && options.shortens) {
      search.trace = shrink(system, property, std::move(*search.trace), options.control);
    }
  } else {
    search = search_for_shortest(
        system, rules, options,
        [&](const System& reduced, Reduction reduction, const SearchLimits& limits) {
          return search_for(reduced, property, reduction, limits);
        });
  }
  result.states = search.states;
  result.transitions = search.transitions;
  result.peak_bytes = search.bytes;
  result.sent_bytes = search.sent_bytes;
  result.reduction = search.reduction;
  result.remarkable = std::move(search.remarkable);
  result.stays_within_learned = !needs_cycle(property) && !is_always_possible && !search.has_cut &&
                                search.reduction == Reduction::none &&
                                search.end == SearchResult::End::complete;
  result.seconds = std::chrono::duration<double>(Clock::now() - start).count();
  switch (search.end) {
    case SearchResult::End::complete:
      result.verdict = depends_on_bounds ? Verdict::inconclusive : Verdict::holds;
      if (depends_on_bounds) {
        result.reason = "from some state it is possible only behind what was learned, or an error";
      }
      break;
    case SearchResult::End::found: {
      require_sound(name(), system, property, *search.trace);
      result.verdict = Verdict::violated;
      result.trace = std::move(search.trace);
      break;
    }
    default: result.reason = why_incomplete(search, options); break;
  }
  return result;
}

CutResult NativeEngine::find_cut(const System& system, const EngineOptions& options) {
  if (!PackedSystem(system).has_cuts()) return {Verdict::holds, "", std::nullopt};
  SearchResult search = search_for_shortest(
      system, CallRules{}, options,
      [&](const System& reduced, Reduction reduction, const SearchLimits& limits) {
        return explore(reduced, SearchJob::Goal::cut, Property{}, reduction, limits);
      });
  CutResult result;
  switch (search.end) {
    case SearchResult::End::complete: result.verdict = Verdict::holds; break;
    case SearchResult::End::found:
      if (!replay(system, *search.trace).back().is_cut) {
        throw std::logic_error("the run to the bound does not replay");
      }
      result.verdict = Verdict::violated;
      result.trace = std::move(search.trace);
      break;
    default: result.reason = why_incomplete(search, options); break;
  }
  return result;
}

}  // namespace maide
