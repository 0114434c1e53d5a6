// Monitors, which watch a run in the search for a fair cycle (fair_cycle.hpp): the automaton of a
// formula, and "this program never steps again". They evaluate atoms and conditions on packed
// states; so do invariants.
#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "maide/base/invariant.hpp"
#include "maide/check/ltl/ltl_automaton.hpp"
#include "maide/check/ltl/streett_automaton.hpp"
#include "maide/check/packed/bits.hpp"
#include "maide/check/packed/packed_system.hpp"
#include "maide/check/search/product_graph.hpp"

namespace maide {

// An atom of a formula on packed states and steps. What it depends on is few of a state's fields,
// or the edge just taken; its value is looked up.
class PackedAtom {
 public:
  // Keeps a reference.
  PackedAtom(const Atom& atom, const System& system);

  // No event: the initial state, or one that repeats for ever.
  static constexpr std::uint32_t no_edge = ~std::uint32_t{0};
  bool is_event() const { return is_event_; }
  // `state` was reached by that actor taking that edge, or action of nobody.
  template <std::size_t words>
  bool is_true(const PackedSystem& system, const PackedState<words>& state, std::size_t program,
               std::uint32_t edge) const {
    if (owner_ != no_owner) [[likely]]
      return values_[system.control(state, owner_)];
    if (is_event_) {
      return edge != no_edge && by_edge_[std::min(program, by_edge_.size() - 1)][edge];
    }
    return is_true_of_fields(system, state);
  }

 private:
  static constexpr std::uint32_t no_owner = ~std::uint32_t{0};

  template <std::size_t words>
  bool is_true_of_fields(const PackedSystem& system, const PackedState<words>& state) const {
    if (values_.empty()) return maide::is_true(atom_, *system_, system.unpack(state), nullptr);
    std::size_t place = 0;
    for (const Field& field : fields_) {
      const std::uint32_t at = field.is_model ? system.model_state(state, field.index)
                                              : system.control(state, field.index);
      place += at * field.stride;
    }
    return values_[place];
  }

  // A component of the state that the atom depends on.
  struct Field {
    bool is_model = false;
    std::uint32_t index = 0;
    std::size_t stride = 0;
  };

  Atom atom_;
  const System* system_;
  bool is_event_;
  std::uint32_t owner_ = no_owner;  // the program on whose control state alone it depends
  std::vector<Field> fields_;
  std::vector<bool> values_;                // by the fields' values; none: too many
  std::vector<std::vector<bool>> by_edge_;  // of an event: by program, nobody last; by edge
};

// A formula without temporal operators, evaluated on packed states. For `always` and for tests of a
// single state. O(formula) an evaluation.
class Condition {
 public:
  // `formula` has no temporal operator (std::invalid_argument).
  Condition(const Formula& formula, const System& system);

  // Whether it depends on the step by which a state was reached.
  bool has_events() const;

  template <std::size_t words>
  bool is_true(const PackedSystem& system, const PackedState<words>& state, std::size_t program,
               std::uint32_t edge) const {
    return evaluate(nodes_.size() - 1, system, state, program, edge);
  }

 private:
  struct Node {
    FormulaNode::Operator op = FormulaNode::Operator::truth;
    std::uint32_t left = 0, right = 0;  // nodes; of an atom: `left` is its index
  };
  std::uint32_t add(const Formula& formula, const System& system);

  template <std::size_t words>
  bool evaluate(std::size_t at, const PackedSystem& system, const PackedState<words>& state,
                std::size_t program, std::uint32_t edge) const {
    using Operator = FormulaNode::Operator;
    const Node& node = nodes_[at];
    MAIDE_CHECK(node.op == Operator::atom ? node.left < atoms_.size()
                                          : at == 0 || (node.left < at && node.right < at));
    const auto left = [&] { return evaluate(node.left, system, state, program, edge); };
    const auto right = [&] { return evaluate(node.right, system, state, program, edge); };
    switch (node.op) {
      case Operator::truth: return true;
      case Operator::falsity: return false;
      case Operator::atom: return atoms_[node.left].is_true(system, state, program, edge);
      case Operator::negation: return !left();
      case Operator::conjunction: return left() && right();
      case Operator::disjunction: return left() || right();
      case Operator::implication: return !left() || right();
      default: return left() == right();  // equivalence
    }
  }

  std::vector<Node> nodes_;  // the root is the last
  std::vector<PackedAtom> atoms_;
};

// Under weak fairness each program has a mark: it steps, or cannot, or nothing asks it to. The
// actor who steps may be nobody.
template <typename Bits>
Bits weakly_fair_marks(std::size_t programs, const Bits& fair, std::size_t stepping,
                       const Bits& enabled) {
  return first_bits<Bits>(programs) & (~(enabled & fair) | bit_of<Bits>(stepping));
}

// By state of the automaton: no_part if it waits (`is_waiting`), may begin there and comes there
// from nowhere else. Of the others, the number of its part: nothing leads from one part to another.
std::vector<std::uint32_t> find_parts(const LtlAutomaton& automaton,
                                      const std::vector<bool>& is_waiting);

// Runs that the automaton accepts. Reads the letter of a state when it is entered. Marks of
// programs come behind those of the automaton, and those of pairs come last.
template <typename BitSet = std::uint64_t>
class LtlMonitor {
 public:
  using Bits = BitSet;

  // Keeps a reference to `packed`.
  LtlMonitor(const PackedSystem& packed, StreettAutomaton automaton, Fairness fairness)
      : packed_(packed),
        automaton_(std::move(automaton.buchi)),
        pairs_of_(std::move(automaton.pairs_of)),
        fairness_(fairness) {
    for (const auto& list : automaton.pairs) {
      auto& conditions = pairs_.emplace_back();
      for (const StreettPair& pair : list) {
        conditions.push_back(
            {Condition(pair.asked, packed.system()), Condition(pair.answered, packed.system())});
      }
      most_pairs_ = std::max(most_pairs_, static_cast<unsigned>(list.size()));
    }
    pairs_of_.resize(automaton_.states.size(), 0);
    MAIDE_CHECK(automaton_.atoms.size() <= 64);  // a letter is a word of bits
    MAIDE_CHECK(automaton_.mark_count <= 64);
    for (const Atom& atom : automaton_.atoms) atoms_.emplace_back(atom, packed.system());
    is_waiting_ = find_waiting(automaton_);
    part_of_ = find_parts(automaton_, is_waiting_);
    for (const std::uint32_t part : part_of_) {
      if (part != no_part) parts_ = std::max(parts_, part + 1);
    }
    fair_ = packed.template fair_programs<Bits>();
    if (fairness == Fairness::weak) groups_ = packed.template groups_on_weak_runs<Bits>();
    if (fairness == Fairness::strong) groups_ = first_bits<Bits>(packed.group_count());
  }

  unsigned marks() const {
    return automaton_.mark_count +
           (fairness_ == Fairness::weak ? static_cast<unsigned>(packed_.program_count()) : 0);
  }
  unsigned pairs() const { return most_pairs_; }
  std::uint32_t universal() const { return automaton_.universal; }
  bool is_strong() const { return fairness_ == Fairness::strong; }
  const Bits& fair_programs() const { return fair_; }
  const Bits& groups() const { return groups_; }
  bool is_waiting(std::uint32_t at) const { return is_waiting_[at]; }
  bool may_wait() const { return std::ranges::find(is_waiting_, true) != is_waiting_.end(); }
  bool is_root(std::uint32_t at) const { return part_of_[at] == no_part; }
  std::uint32_t states() const { return static_cast<std::uint32_t>(part_of_.size()); }
  std::uint32_t parts() const { return parts_; }
  std::uint32_t part_of(std::uint32_t at) const { return part_of_[at]; }

  template <typename State, typename Follow>
  void start(const State& state, Follow&& follow) const {
    for (const std::uint32_t at : automaton_.initial) {
      read(valuation(state, 0, PackedAtom::no_edge), at, Bits{}, follow);
    }
  }
  template <typename State, typename Follow>
  void step(const State& next, std::size_t program, std::uint32_t edge, const Bits& enabled,
            std::uint32_t at, Follow&& follow) const {
    Bits fair{};
    if (fairness_ == Fairness::weak) {
      fair = moved_up(weakly_fair_marks(packed_.program_count(), fair_, program, enabled),
                      automaton_.mark_count);
    }
    if (most_pairs_ > 0) fair |= pair_marks(next, program, edge, at);
    read(valuation(next, program, edge), at, fair, follow);
  }
  template <typename State, typename Follow>
  void stay(const State& state, std::uint32_t at, Follow&& follow) const {
    Bits fair = first_bits<Bits>(marks()) & ~first_bits<Bits>(automaton_.mark_count);
    if (most_pairs_ > 0) fair |= pair_marks(state, 0, PackedAtom::no_edge, at);
    read(valuation(state, 0, PackedAtom::no_edge), at, fair, follow);
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
  // What the pairs of that state of the automaton are asked and answered.
  template <typename State>
  Bits pair_marks(const State& state, std::size_t program, std::uint32_t edge,
                  std::uint32_t at) const {
    Bits result{};
    std::size_t bit = marks();
    for (const Pair& pair : pairs_[pairs_of_[at]]) {
      if (pair.answered.is_true(packed_, state, program, edge)) result |= bit_of<Bits>(bit);
      if (pair.asked.is_true(packed_, state, program, edge)) result |= bit_of<Bits>(bit + 1);
      bit += 2;
    }
    return result;
  }
  template <typename Follow>
  void read(std::uint64_t valuation, std::uint32_t at, const Bits& marks, Follow&& follow) const {
    MAIDE_CHECK(at < automaton_.states.size());
    for (const LtlAutomaton::Transition& transition : automaton_.states[at]) {
      if (transition.letter.allows(valuation)) follow(transition.target, transition.marks | marks);
    }
  }

  struct Pair {
    Condition asked, answered;
  };

  const PackedSystem& packed_;
  LtlAutomaton automaton_;
  std::vector<std::vector<Pair>> pairs_;
  std::vector<std::uint32_t> pairs_of_;  // by state: in pairs_
  unsigned most_pairs_ = 0;
  Fairness fairness_;
  Bits fair_{}, groups_{};
  std::vector<PackedAtom> atoms_;
  std::vector<bool> is_waiting_;        // by state
  std::vector<std::uint32_t> part_of_;  // by state
  std::uint32_t parts_ = 0;
};

// Runs on which programs may be stuck.
enum class StuckRuns : std::uint8_t {
  weakly_fair,  // to programs
  weakly_fair_with_groups,
  strongly_fair,  // to programs and all groups
};

// Fair runs on which some program, that has not ended and may not rest, never steps again while
// others, or nobody, run on. A program that no fairness asks for a step is not stuck. State 0
// waits; state 1+p has guessed that program p has made its last step, and on strongly fair runs,
// that it can never step again.
template <typename BitSet = std::uint64_t>
class StuckMonitor {
 public:
  using Bits = BitSet;

  // Keeps a reference.
  StuckMonitor(const PackedSystem& packed, StuckRuns runs)
      : packed_(packed), runs_(runs), fair_(packed.template fair_programs<Bits>()) {
    if (runs == StuckRuns::weakly_fair_with_groups) {
      groups_ = packed.template groups_on_weak_runs<Bits>();
    }
    if (is_strong()) groups_ = first_bits<Bits>(packed.group_count());
  }

  std::size_t states() const { return packed_.program_count() + 1; }
  unsigned marks() const {
    return is_strong() ? 0 : static_cast<unsigned>(packed_.program_count());
  }
  unsigned pairs() const { return 0; }
  std::uint32_t universal() const { return no_monitor_state; }
  bool is_strong() const { return runs_ == StuckRuns::strongly_fair; }
  const Bits& fair_programs() const { return fair_; }
  const Bits& groups() const { return groups_; }
  bool is_waiting(std::uint32_t at) const { return at == 0; }
  bool may_wait() const { return true; }
  bool is_root(std::uint32_t at) const { return at == 0; }
  std::uint32_t parts() const { return static_cast<std::uint32_t>(packed_.program_count()); }
  std::uint32_t part_of(std::uint32_t at) const { return at == 0 ? no_part : at - 1; }

  template <typename State, typename Follow>
  void start(const State& state, Follow&& follow) const {
    follow(0, 0);
    guess(state, follow);
  }
  template <typename State, typename Follow>
  void step(const State& next, std::size_t program, std::uint32_t edge, const Bits& enabled,
            std::uint32_t at, Follow&& follow) const {
    const bool is_watched = program == at - 1 && packed_.is_own(program, edge);
    if (at == 0) {
      follow(0, 0);
      guess(next, follow);
    } else if (is_strong()) {
      if (!is_watched && !has_bit(enabled, at - 1)) follow(at, 0);
    } else if (!is_watched) {
      follow(at, weakly_fair_marks(packed_.program_count(), fair_, program, enabled));
    }
  }
  template <typename State, typename Follow>
  void stay(const State&, std::uint32_t, Follow&&) const {}

 private:
  template <typename State, typename Follow>
  void guess(const State& state, Follow&& follow) const {
    for (std::size_t program = 0; program < packed_.program_count(); ++program) {
      if (packed_.is_at_rest(state, program) || !has_bit(fair_, program)) continue;
      if (is_strong() && packed_.can_step(state, program)) continue;
      follow(static_cast<std::uint32_t>(program + 1), 0);
    }
  }

  const PackedSystem& packed_;
  StuckRuns runs_;
  Bits fair_, groups_{};
};

}  // namespace maide
