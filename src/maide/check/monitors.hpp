// What watches a run in the search for a fair cycle (fair_cycle.hpp): the automaton of a formula,
// and a program that never steps again.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "maide/base/bits.hpp"
#include "maide/check/condition.hpp"
#include "maide/check/ltl_automaton.hpp"
#include "maide/check/product_graph.hpp"

namespace maide {

// Under weak fairness each program has a mark: it steps, or cannot.
inline std::uint64_t weakly_fair_marks(std::size_t programs, std::size_t stepping,
                                       std::uint64_t enabled) {
  const std::uint64_t all = low_bits(static_cast<unsigned>(programs));
  return all & (~enabled | (std::uint64_t{1} << stepping));
}

// Runs that the automaton accepts. Reads the letter of a state when it is entered.
class LtlMonitor {
 public:
  // Keeps a reference to `packed`.
  LtlMonitor(const PackedSystem& packed, LtlAutomaton automaton, Fairness fairness)
      : packed_(packed), automaton_(std::move(automaton)), fairness_(fairness) {
    for (const Atom& atom : automaton_.atoms) atoms_.emplace_back(atom, packed.system());
    is_waiting_ = find_waiting(automaton_);
  }

  unsigned marks() const {
    return automaton_.mark_count +
           (fairness_ == Fairness::weak ? static_cast<unsigned>(packed_.program_count()) : 0);
  }
  std::uint32_t universal() const { return automaton_.universal; }
  bool is_strong() const { return fairness_ == Fairness::strong; }
  bool is_waiting(std::uint32_t at) const { return is_waiting_[at]; }
  bool may_wait() const {
    return std::find(is_waiting_.begin(), is_waiting_.end(), true) != is_waiting_.end();
  }

  template <typename State, typename Follow>
  void start(const State& state, Follow&& follow) const {
    for (const std::uint32_t at : automaton_.initial) {
      read(valuation(state, 0, PackedAtom::no_edge), at, 0, follow);
    }
  }
  template <typename State, typename Follow>
  void step(const State& next, std::size_t program, std::uint32_t edge, std::uint64_t enabled,
            std::uint32_t at, Follow&& follow) const {
    std::uint64_t fair = 0;
    if (fairness_ == Fairness::weak) {
      fair = weakly_fair_marks(packed_.program_count(), program, enabled) << automaton_.mark_count;
    }
    read(valuation(next, program, edge), at, fair, follow);
  }
  template <typename State, typename Follow>
  void stay(const State& state, std::uint32_t at, Follow&& follow) const {
    const std::uint64_t fair =
        marks() == automaton_.mark_count ? 0 : ~std::uint64_t{0} << automaton_.mark_count;
    const std::uint64_t all = low_bits(marks());
    read(valuation(state, 0, PackedAtom::no_edge), at, fair & all, follow);
  }

 private:
  template <typename State>
  std::uint64_t valuation(const State& state, std::size_t program, std::uint32_t edge) const {
    std::uint64_t valuation = 0;
    for (std::size_t i = 0; i < atoms_.size(); ++i) {
      if (atoms_[i].is_true(packed_, state, program, edge)) valuation |= std::uint64_t{1} << i;
    }
    return valuation;
  }
  template <typename Follow>
  void read(std::uint64_t valuation, std::uint32_t at, std::uint64_t marks, Follow&& follow) const {
    for (const LtlAutomaton::Transition& transition : automaton_.states[at]) {
      if (transition.letter.allows(valuation)) follow(transition.target, transition.marks | marks);
    }
  }

  const PackedSystem& packed_;
  LtlAutomaton automaton_;
  Fairness fairness_;
  std::vector<PackedAtom> atoms_;
  std::vector<bool> is_waiting_;  // by state
};

// Weakly fair runs on which some program, that has not ended, never steps again while others run
// on. State 0 waits; state 1+p has guessed that program p has made its last step.
class StuckMonitor {
 public:
  // Keeps a reference.
  explicit StuckMonitor(const PackedSystem& packed) : packed_(packed) {}

  std::size_t states() const { return packed_.program_count() + 1; }
  unsigned marks() const { return static_cast<unsigned>(packed_.program_count()); }
  std::uint32_t universal() const { return no_monitor_state; }
  bool is_strong() const { return false; }
  bool is_waiting(std::uint32_t at) const { return at == 0; }
  bool may_wait() const { return true; }

  template <typename State, typename Follow>
  void start(const State& state, Follow&& follow) const {
    follow(0, 0);
    guess(state, follow);
  }
  template <typename State, typename Follow>
  void step(const State& next, std::size_t program, std::uint32_t, std::uint64_t enabled,
            std::uint32_t at, Follow&& follow) const {
    if (at == 0) {
      follow(0, 0);
      guess(next, follow);
    } else if (program != at - 1) {
      follow(at, weakly_fair_marks(packed_.program_count(), program, enabled));
    }
  }
  template <typename State, typename Follow>
  void stay(const State&, std::uint32_t, Follow&&) const {}

 private:
  template <typename State, typename Follow>
  void guess(const State& state, Follow&& follow) const {
    for (std::size_t program = 0; program < packed_.program_count(); ++program) {
      if (!packed_.has_ended(state, program)) follow(static_cast<std::uint32_t>(program + 1), 0);
    }
  }

  const PackedSystem& packed_;
};

}  // namespace maide
