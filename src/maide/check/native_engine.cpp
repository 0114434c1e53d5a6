#include "maide/check/native_engine.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <optional>
#include <stdexcept>
#include <utility>

#include "maide/check/condition.hpp"
#include "maide/check/explorer.hpp"
#include "maide/check/monitors.hpp"

namespace maide {
namespace {

using Clock = std::chrono::steady_clock;

// Three quarters of the machine's memory.
std::uint64_t default_memory() {
  const auto pages = static_cast<std::uint64_t>(::sysconf(_SC_PHYS_PAGES));
  const auto page = static_cast<std::uint64_t>(::sysconf(_SC_PAGE_SIZE));
  return pages * page / 4 * 3;
}

SearchLimits limits_of(const EngineOptions& options) {
  SearchLimits limits;
  limits.bytes = options.memory_mib ? *options.memory_mib << 20 : default_memory();
  limits.control = options.control;
  return limits;
}

// Goals: see explorer.hpp.

// A state in which nothing can happen and some program has not ended.
struct DeadlockGoal {
  const PackedSystem& system;
  template <typename State>
  bool on_step(const State&, const State&, std::size_t, std::uint32_t, bool) const {
    return false;
  }
  template <std::size_t words>
  bool on_end(const PackedState<words>& state) const {
    return !system.has_ended(state);
  }
};

struct CutGoal {
  template <typename State>
  bool on_step(const State&, const State&, std::size_t, std::uint32_t, bool is_cut) const {
    return is_cut;
  }
  template <typename State>
  bool on_end(const State&) const {
    return false;
  }
};

// A position at which the condition does not hold; one at which the run is cut does not count.
struct InvariantGoal {
  const PackedSystem& system;
  Condition condition;
  template <std::size_t words>
  bool on_step(const PackedState<words>&, const PackedState<words>& next, std::size_t program,
               std::uint32_t edge, bool is_cut) const {
    return !is_cut && !condition.is_true(system, next, program, edge);
  }
  template <std::size_t words>
  bool on_end(const PackedState<words>& state) const {
    return !condition.is_true(system, state, 0, PackedAtom::no_edge);
  }
};

template <typename Goal>
SearchResult explore(const PackedSystem& system, Goal goal, const EngineOptions& options) {
  const SearchLimits limits = limits_of(options);
  return with_words(system.words(), [&](auto words) {
    return BreadthFirstSearch<words.value, Goal>(system, goal, limits).run();
  });
}

std::string why_incomplete(const SearchResult& search, const EngineOptions& options) {
  const std::string reached =
      fmt::format("after {} states, to depth {}", search.states, search.depth);
  if (search.end == SearchResult::End::out_of_memory) {
    return fmt::format("the search needs more than {} MiB of memory: nothing found {}",
                       limits_of(options).bytes >> 20, reached);
  }
  return fmt::format("{} {}: nothing found so far",
                     options.control.stop.stop_requested() ? "interrupted" : "out of time",
                     reached);
}

// `G condition`: the condition; null if the formula is no such.
Formula invariant_of(const Property& property) {
  if (property.kind != Property::Kind::ltl) return nullptr;
  const Formula& formula = property.formula;
  if (formula->op != FormulaNode::Operator::globally) return nullptr;
  return is_boolean(formula->left) ? formula->left : nullptr;
}

Formula negation_of(const Formula& formula) {
  FormulaNode node;
  node.op = FormulaNode::Operator::negation;
  node.left = formula;
  return std::make_shared<const FormulaNode>(std::move(node));
}

template <typename Monitor>
SearchResult find_fair_cycle(const PackedSystem& system, const Monitor& monitor,
                             const EngineOptions& options) {
  const SearchLimits limits = limits_of(options);
  return with_words(system.words(), [&](auto words) {
    return FairCycleSearch<words.value, Monitor>(system, monitor, limits).run();
  });
}

// Programs, and marks, are bits of a word in the search for fair cycles.
bool is_within_words(const System& system, unsigned marks) {
  return system.programs.size() <= most_marks && marks <= most_marks;
}

// Nothing if the system is too large for it.
std::optional<SearchResult> search_for_cycle(const System& plain, const Property& property,
                                             const EngineOptions& options) {
  const auto programs = static_cast<unsigned>(plain.programs.size());
  if (property.kind == Property::Kind::stuck) {
    if (!is_within_words(plain, programs)) return std::nullopt;
    const PackedSystem system(plain, node_number_bits, plain.programs.size() + 1);
    return find_fair_cycle(system, StuckMonitor(system), options);
  }
  LtlAutomaton automaton = property.kind == Property::Kind::never
                               ? *property.never
                               : translate(negation_of(property.formula));
  const bool is_weak = property.fairness == Fairness::weak;
  if (!is_within_words(plain, automaton.mark_count + (is_weak ? programs : 0))) {
    return std::nullopt;
  }
  const PackedSystem system(plain, node_number_bits, automaton.states.size());
  return find_fair_cycle(system, LtlMonitor(system, std::move(automaton), property.fairness),
                         options);
}

bool needs_cycle(const Property& property) {
  if (property.kind == Property::Kind::stuck) return true;
  if (property.kind == Property::Kind::never) return true;
  return property.kind == Property::Kind::ltl && !invariant_of(property);
}

SearchResult search_for(const System& plain, const Property& property,
                        const EngineOptions& options) {
  const PackedSystem system(plain);
  if (property.kind == Property::Kind::deadlock) {
    return explore(system, DeadlockGoal{system}, options);
  }
  const Condition condition(invariant_of(property), system.system());
  const bool holds_first = with_words(system.words(), [&](auto words) {
    const auto initial = system.pack<words.value>(initial_state(system.system()));
    return condition.is_true(system, initial, 0, PackedAtom::no_edge);
  });
  if (holds_first) return explore(system, InvariantGoal{system, condition}, options);
  SearchResult search;
  search.end = SearchResult::End::found;
  search.states = 1;
  search.trace.emplace();
  return search;
}

}  // namespace

std::string NativeEngine::obstacle(const Property& property) const {
  static_cast<void>(property);
  return "";
}

PropertyResult NativeEngine::check(const System& system, const Property& property,
                                   const EngineOptions& options) {
  const auto start = Clock::now();
  PropertyResult result;
  result.name = property.name;
  SearchResult search;
  if (needs_cycle(property)) {
    std::optional<SearchResult> cycle = search_for_cycle(system, property, options);
    if (!cycle) {
      result.reason = fmt::format(
          "the engine native takes at most {} programs, together with the formula's "
          "eventualities, where fairness matters",
          most_marks);
      return result;
    }
    search = std::move(*cycle);
  } else {
    search = search_for(system, property, options);
  }
  result.states = search.states;
  result.transitions = search.transitions;
  result.peak_bytes = search.bytes;
  result.seconds = std::chrono::duration<double>(Clock::now() - start).count();
  switch (search.end) {
    case SearchResult::End::complete: result.verdict = Verdict::holds; break;
    case SearchResult::End::found: {
      const std::string flaw = find_flaw(system, property, *search.trace);
      if (!flaw.empty()) {
        throw std::logic_error("the counterexample for '" + property.name +
                               "' does not replay: " + flaw);
      }
      result.verdict = Verdict::violated;
      result.trace = std::move(search.trace);
      break;
    }
    default: result.reason = why_incomplete(search, options); break;
  }
  return result;
}

CutResult NativeEngine::find_cut(const System& system, const EngineOptions& options) {
  const PackedSystem packed(system);
  SearchResult search = explore(packed, CutGoal{}, options);
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
