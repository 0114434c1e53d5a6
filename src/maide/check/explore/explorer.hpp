// Breadth-first search of a system's states for a step or a state that somebody looks for. It shows
// a shortest run to it, if nothing is left out. Levels are plain lists of packed states. Visited
// states lie in a StateTable, each with the code of the step that led to it (packed_system.hpp). So
// the run is read off backwards, and costs a few bits a state.
//
// The search saves work in three ways:
//
//   order   all states are visited, but not every transition is followed (step_order.hpp)
//   sets    only the steps of stubborn sets are taken (stubborn_sets.hpp). Where no step may be put
//           off for ever, a state whose steps lead to no new state is expanded whole. Each state
//           then has a way to a later one at which the steps left out are still possible
//   chains  a state with a single step is passed by and not stored, a few in a row at most; the
//           codes of all their steps are kept with the state at the end
//
// Sources for expanding whole: Evangelista & Pajault, "Solving the ignoring problem for partial
// order reduction", STTT 2010; Bosnacki & Holzmann, "Improving Spin's partial-order reduction for
// breadth-first search", SPIN 2005.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <new>
#include <stdexcept>
#include <utility>
#include <vector>

#include "maide/base/invariant.hpp"
#include "maide/base/numbers.hpp"
#include "maide/check/explore/packed_system.hpp"
#include "maide/check/explore/search.hpp"
#include "maide/check/explore/step_order.hpp"
#include "maide/check/explore/stubborn_sets.hpp"

namespace maide {

// How a search saves itself work.
struct BreadthFirstOptions {
  StubbornSets* sets = nullptr;   // not owned; null: every state is visited
  bool puts_nothing_off = false;  // no step is left out for ever; with `sets`
  unsigned chain = 1;             // most steps from one stored state to the next
  // Not owned; null, as with `sets`: every transition is taken. Else the goal must not depend on
  // the step by which a state was reached.
  const StepOrder* order = nullptr;
};

// Bits of payload of a search with chains of that length.
constexpr unsigned chain_bits(unsigned chain, unsigned code_bits) {
  return chain <= 1 ? code_bits : chain * code_bits + bits_for(chain + 1);
}

// A goal says what to look for, in the middle of the innermost loop:
//   bool on_step(const PackedState& from, const PackedState& next, std::size_t program,
//                std::uint32_t edge, bool is_cut)      a step; true: the run up to it is wanted
//   bool on_end(const PackedState& state)              nothing can happen but deaths, and it is no
//                                                      error; true: the run is wanted
template <std::size_t words, typename Goal>
class BreadthFirstSearch {
 public:
  using State = PackedState<words>;

  // `system` was made with chain_bits(chain) of payload.
  BreadthFirstSearch(const PackedSystem& system, Goal& goal, const SearchLimits& limits,
                     const BreadthFirstOptions& options = {})
      : system_(system),
        goal_(goal),
        limits_(limits),
        options_(options),
        initial_(system.pack<words>(initial_state(system.system()))),
        table_(system.address_bits(), chain_bits(options.chain, system.code_bits())) {}

  SearchResult run() {
    try {
      search();
    } catch (const std::bad_alloc&) {
      result_.end = SearchResult::End::out_of_memory;
    }
    result_.states = table_.size();
    result_.bytes = std::max(result_.bytes, bytes());
    return std::move(result_);
  }

 private:
  // Between a state's prefetch and its lookup: long enough for memory to answer.
  static constexpr std::size_t pipeline = 16;
  static constexpr std::uint64_t every_program = ~std::uint64_t{0};

  // The codes of the steps from one stored state to the next: the last step in the lowest bits.
  struct Chain {
    std::uint64_t codes = 0;
    unsigned length = 0;
  };
  struct Pending {
    State state;
    typename StateTable<words>::Address address;
    std::uint64_t payload;
    std::uint32_t last;          // in the order of steps
    bool is_of_reduced = false;  // from a state of which steps are left out
    bool is_last = false;        // of that state's, which is in sources_
  };
  // A state whose other steps have to be taken after all.
  struct Postponed {
    State state;
    std::uint64_t programs;
  };

  std::uint64_t bytes() const {
    return table_.peak_bytes() + (level_.capacity() + next_level_.capacity()) * sizeof(State) +
           (lasts_.capacity() + next_lasts_.capacity()) * sizeof(std::uint32_t);
  }

  void search() {
    table_.insert(initial_, 0);
    next_level_.push_back(initial_);
    if (options_.order != nullptr) next_lasts_.push_back(StepOrder::first_state);
    while (!next_level_.empty() && result_.depth <= limits_.depth) {
      std::swap(level_, next_level_);
      next_level_.clear();
      std::swap(lasts_, next_lasts_);
      next_lasts_.clear();
      ++result_.depth;
      for (std::size_t i = 0; i < level_.size(); ++i) {
        if (++visited_ % limit_interval == 0 && !look_at_limits()) return;
        if (options_.order != nullptr ? expand_in_order(level_[i], (*options_.order)[lasts_[i]])
                                      : expand(level_[i])) {
          return;
        }
      }
      if (finish_level()) return;
      MAIDE_CHECK(next_lasts_.size() == (options_.order != nullptr ? next_level_.size() : 0));
    }
  }

  bool look_at_limits() {
    // The next level may have to move to a larger place.
    const std::uint64_t growth =
        next_level_.size() + limit_interval > next_level_.capacity()
            ? 2 * next_level_.capacity() * (sizeof(State) + sizeof(std::uint32_t))
            : 0;
    return may_go_on(limits_, table_.size(), bytes(), table_.growth_bytes() + growth, result_);
  }

  // True if the goal is met.
  bool expand(const State& state) {
    MAIDE_CHECK(!is_of_reduced_);
    if (system_.is_error(state)) return false;
    if (options_.sets == nullptr) return take_steps(state, every_program);
    const std::uint64_t programs = options_.sets->select(state);
    if (!options_.puts_nothing_off || !options_.sets->is_reduced()) {
      return take_steps(state, programs);
    }
    is_of_reduced_ = true;
    if (take_steps(state, programs)) return true;
    is_of_reduced_ = false;
    const std::size_t last = (pending_next_ + pipeline - 1) % pipeline;
    pending_[last].is_last = true;
    sources_[last] = {state, programs};
    return expand_postponed();
  }

  bool expand_postponed() {
    while (!postponed_.empty()) {
      const Postponed postponed = postponed_.back();
      postponed_.pop_back();
      if (take_steps(postponed.state, ~postponed.programs)) return true;
    }
    return false;
  }

  // All steps, of which those that `last` leaves out are only counted. True if the goal is met.
  bool expand_in_order(const State& state, const StepOrder::Last& last) {
    if (system_.is_error(state)) return false;
    const StepOrder& order = *options_.order;
    bool is_end = true;
    for (std::size_t program = 0; program < system_.program_count(); ++program) {
      const auto is_left_out = [&](std::uint32_t edge) {
        return program < last.program && order.leaves_out(last, program, edge);
      };
      if (take_steps(state, program, is_left_out, is_end)) return true;
    }
    return is_end && ends_at(state);
  }

  // The steps of those programs. True if the goal is met.
  bool take_steps(const State& state, std::uint64_t programs) {
    bool is_end = true;
    const auto is_left_out = [](std::uint32_t) { return false; };
    for (std::size_t program = 0; program < system_.program_count(); ++program) {
      if (program < most_reduced_programs && (programs >> program & 1) == 0) continue;
      if (take_steps(state, program, is_left_out, is_end)) return true;
    }
    return is_end && ends_at(state);
  }

  // The steps of a program, but those of edges that are left out. True if the goal is met; where
  // there is a step other than a death, left out or not, is no end.
  template <typename IsLeftOut>
  bool take_steps(const State& state, std::size_t program, IsLeftOut&& is_left_out, bool& is_end) {
    bool is_found = false;
    system_.for_each_step(
        state, program,
        [&](const State& next, std::uint32_t edge, bool is_cut, std::uint64_t code) {
          is_end = is_end && system_.is_death(program, edge);
          if (is_found) return;
          ++result_.transitions;
          result_.has_cut = result_.has_cut || is_cut;
          if (is_left_out(edge)) return;
          if (goal_.on_step(state, next, program, edge, is_cut)) {
            is_found = true;
            found(next, {code, 1});
          } else if (is_cut) {
            return;
          } else if (options_.order != nullptr) {
            push(next, code, options_.order->behind(system_, state, program, edge));
          } else {
            is_found = follow(next, {code, 1});
          }
        });
    return is_found;
  }

  // At a state in which nothing can happen. True if the goal is met.
  bool ends_at(const State& state) {
    if (!goal_.on_end(state)) return false;
    result_.end = SearchResult::End::found;
    result_.trace = trace_to(system_.unpack(state));
    return true;
  }

  // Passes by states that have one step alone. True if the goal is met.
  bool follow(State state, Chain chain) {
    while (chain.length < options_.chain && !system_.is_error(state)) {
      const std::uint64_t programs = options_.sets->select(state);
      if (programs == 0 || (programs & (programs - 1)) != 0) break;
      const auto program = static_cast<std::size_t>(std::countr_zero(programs));
      std::size_t count = 0;
      State after{};
      std::uint32_t taken = 0;
      std::uint64_t step_code = 0;
      bool cuts = false;
      system_.for_each_step(
          state, program,
          [&](const State& next, std::uint32_t edge, bool is_cut, std::uint64_t code) {
            ++count;
            after = next;
            taken = edge;
            step_code = code;
            cuts = is_cut;
          });
      if (count != 1 || cuts) break;
      MAIDE_CHECK(step_code <= low_bits(system_.code_bits()));
      ++result_.transitions;
      chain = {(chain.codes << system_.code_bits()) | step_code, chain.length + 1};
      if (goal_.on_step(state, after, program, taken, false)) {
        found(after, chain);
        return true;
      }
      state = after;
    }
    push(state, payload_of(chain), StepOrder::first_state);
    return false;
  }

  // ---- lookups, a little later than asked for ----

  void push(const State& state, std::uint64_t payload, std::uint32_t last) {
    Pending& slot = pending_[pending_next_];
    if (pending_count_ == pipeline) {
      enter(pending_next_);
    } else {
      MAIDE_CHECK(pending_count_ < pipeline);
      ++pending_count_;
    }
    slot = {state, table_.address_of(state), payload, last, is_of_reduced_, false};
    table_.prefetch(slot.address);
    pending_next_ = (pending_next_ + 1) % pipeline;
  }

  void enter(std::size_t slot) {
    const Pending& pending = pending_[slot];
    const bool is_new = table_.insert(pending.state, pending.address, pending.payload).is_new;
    if (is_new) {
      next_level_.push_back(pending.state);
      if (options_.order != nullptr) next_lasts_.push_back(pending.last);
    }
    if (!pending.is_of_reduced) return;
    leads_on_ = leads_on_ || is_new;
    if (!pending.is_last) return;
    if (!leads_on_) postponed_.push_back(sources_[slot]);
    leads_on_ = false;
  }

  bool finish_level() {
    do {
      const std::size_t first = (pending_next_ + pipeline - pending_count_) % pipeline;
      for (std::size_t i = 0; i < pending_count_; ++i) enter((first + i) % pipeline);
      pending_count_ = 0;
      if (expand_postponed()) return true;
    } while (pending_count_ > 0);
    MAIDE_CHECK(postponed_.empty() && !leads_on_);  // each state's last step was entered
    return false;
  }

  // ---- the run that was found ----

  std::uint64_t payload_of(const Chain& chain) const {
    if (options_.chain <= 1) return chain.codes;
    MAIDE_CHECK(chain.length <= options_.chain);
    MAIDE_CHECK(chain.codes <= low_bits(options_.chain * system_.code_bits()));
    return chain.codes | (std::uint64_t{chain.length} << (options_.chain * system_.code_bits()));
  }
  Chain chain_of(std::uint64_t payload) const {
    if (options_.chain <= 1) return {payload, 1};
    const unsigned bits = options_.chain * system_.code_bits();
    return {payload & low_bits(bits), static_cast<unsigned>(payload >> bits)};
  }

  // Puts the steps of the chain into `trace`, the last one first; the state before them.
  GlobalState undo(GlobalState state, Chain chain, Trace& trace) const {
    for (; chain.length > 0; --chain.length) {
      PackedSystem::Origin origin =
          system_.undo(state, chain.codes & low_bits(system_.code_bits()));
      chain.codes >>= system_.code_bits();
      trace.steps.push_back(origin.step);
      state = std::move(origin.before);
    }
    return state;
  }

  void found(const State& next, const Chain& chain) {
    result_.end = SearchResult::End::found;
    Trace last;
    result_.trace = trace_to(undo(system_.unpack(next), chain, last));
    result_.trace->steps.insert(result_.trace->steps.end(), last.steps.rbegin(), last.steps.rend());
  }

  // The run by which the search came to a visited state.
  Trace trace_to(GlobalState state) const {
    Trace trace;
    const GlobalState first = system_.unpack(initial_);
    while (!(state == first)) {
      std::uint64_t payload = 0;
      if (!table_.find(system_.pack<words>(state), payload)) {
        throw std::logic_error("the search lost a state");
      }
      state = undo(std::move(state), chain_of(payload), trace);
      MAIDE_CHECK(trace.steps.size() <= table_.size() * options_.chain);  // no way goes in circles
    }
    std::reverse(trace.steps.begin(), trace.steps.end());
    return trace;
  }

  const PackedSystem& system_;
  Goal& goal_;
  const SearchLimits& limits_;
  BreadthFirstOptions options_;
  State initial_;
  StateTable<words> table_;
  std::vector<State> level_, next_level_;
  std::vector<std::uint32_t> lasts_, next_lasts_;  // by state of a level, with an order of steps
  std::array<Pending, pipeline> pending_;
  std::array<Postponed, pipeline> sources_;  // of the last one of each
  std::size_t pending_next_ = 0, pending_count_ = 0;
  bool is_of_reduced_ = false;  // the state that is expanded now
  bool leads_on_ = false;       // one of the steps that were entered led to a new state
  std::vector<Postponed> postponed_;
  std::uint64_t visited_ = 0;
  SearchResult result_;
};

}  // namespace maide
