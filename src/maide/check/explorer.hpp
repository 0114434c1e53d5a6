// Breadth-first search of a system's states for a step or a state that somebody looks for: found
// with a shortest run to it. Levels are kept as plain lists of packed states, visited states in a
// StateTable together with the code of the step that led to each (packed_system.hpp), so that the
// run is read off backwards and costs a few bits a state.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <new>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "maide/base/run_control.hpp"
#include "maide/check/packed_system.hpp"
#include "maide/check/trace.hpp"

namespace maide {

struct SearchLimits {
  std::uint64_t bytes = ~std::uint64_t{0};
  RunControl control;
};

struct SearchResult {
  enum class End : std::uint8_t {
    complete,  // everything was visited
    found,
    out_of_memory,  // the limit, or the machine's
    stopped,        // by the control
  };
  End end = End::complete;
  std::uint64_t states = 0;
  std::uint64_t transitions = 0;
  std::uint64_t depth = 0;     // of the last level that was begun
  std::uint64_t bytes = 0;     // the most that table and levels had
  std::optional<Trace> trace;  // of what was found
};

// A goal says what to look for, in the middle of the innermost loop:
//   bool on_step(const PackedState& from, const PackedState& next, std::size_t program,
//                std::uint32_t edge, bool is_cut)      a step; true: the run up to it is wanted
//   bool on_end(const PackedState& state)              nothing can happen; true: the run is wanted
template <std::size_t words, typename Goal>
class BreadthFirstSearch {
 public:
  using State = PackedState<words>;

  BreadthFirstSearch(const PackedSystem& system, Goal& goal, const SearchLimits& limits)
      : system_(system),
        goal_(goal),
        limits_(limits),
        initial_(system.pack<words>(initial_state(system.system()))),
        table_(system.address_bits(), system.code_bits()) {}

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
  static constexpr std::size_t check_interval = 1 << 14;  // states between looks at the limits

  struct Pending {
    State state;
    typename StateTable<words>::Address address;
    std::uint64_t code;
  };

  std::uint64_t bytes() const {
    return table_.peak_bytes() + (level_.capacity() + next_level_.capacity()) * sizeof(State);
  }

  void search() {
    table_.insert(initial_, 0);
    next_level_.push_back(initial_);
    while (!next_level_.empty()) {
      std::swap(level_, next_level_);
      next_level_.clear();
      ++result_.depth;
      for (const State& state : level_) {
        if (++visited_ % check_interval == 0 && !may_go_on()) return;
        if (expand(state)) return;
      }
      flush();
    }
  }

  bool may_go_on() {
    result_.bytes = std::max(result_.bytes, bytes());
    limits_.control.report({"checking", table_.size(), 0, 0, 0, 0});
    if (limits_.control.should_stop()) {
      result_.end = SearchResult::End::stopped;
      return false;
    }
    if (bytes() + table_.growth_bytes() > limits_.bytes) {
      result_.end = SearchResult::End::out_of_memory;
      return false;
    }
    return true;
  }

  // True if the goal is met.
  bool expand(const State& state) {
    bool is_end = true;
    for (std::size_t program = 0; program < system_.program_count(); ++program) {
      bool is_found = false;
      system_.for_each_step(
          state, program,
          [&](const State& next, std::uint32_t edge, bool is_cut, std::uint64_t code) {
            is_end = false;
            if (is_found) return;
            ++result_.transitions;
            if (goal_.on_step(state, next, program, edge, is_cut)) {
              is_found = true;
              found(next, code);
            } else if (!is_cut) {
              push(next, code);
            }
          });
      if (is_found) return true;
    }
    if (!is_end || !goal_.on_end(state)) return false;
    result_.end = SearchResult::End::found;
    result_.trace = trace_to(system_.unpack(state));
    return true;
  }

  void push(const State& state, std::uint64_t code) {
    Pending& slot = pending_[pending_next_];
    if (pending_count_ == pipeline) {
      enter(slot);
    } else {
      ++pending_count_;
    }
    slot = {state, table_.address_of(state), code};
    table_.prefetch(slot.address);
    pending_next_ = (pending_next_ + 1) % pipeline;
  }

  void enter(const Pending& pending) {
    if (table_.insert(pending.state, pending.address, pending.code).is_new) {
      next_level_.push_back(pending.state);
    }
  }

  void flush() {
    const std::size_t first = (pending_next_ + pipeline - pending_count_) % pipeline;
    for (std::size_t i = 0; i < pending_count_; ++i) enter(pending_[(first + i) % pipeline]);
    pending_count_ = 0;
  }

  void found(const State& next, std::uint64_t code) {
    result_.end = SearchResult::End::found;
    const PackedSystem::Origin origin = system_.undo(system_.unpack(next), code);
    result_.trace = trace_to(origin.before);
    result_.trace->steps.push_back(origin.step);
  }

  // The run by which the search came to a visited state.
  Trace trace_to(GlobalState state) const {
    Trace trace;
    const GlobalState first = system_.unpack(initial_);
    while (!(state == first)) {
      std::uint64_t code = 0;
      if (!table_.find(system_.pack<words>(state), code)) {
        throw std::logic_error("the search lost a state");
      }
      PackedSystem::Origin origin = system_.undo(state, code);
      trace.steps.push_back(origin.step);
      state = std::move(origin.before);
    }
    std::reverse(trace.steps.begin(), trace.steps.end());
    return trace;
  }

  const PackedSystem& system_;
  Goal& goal_;
  const SearchLimits& limits_;
  State initial_;
  StateTable<words> table_;
  std::vector<State> level_, next_level_;
  std::array<Pending, pipeline> pending_;
  std::size_t pending_next_ = 0, pending_count_ = 0;
  std::uint64_t visited_ = 0;
  SearchResult result_;
};

}  // namespace maide
