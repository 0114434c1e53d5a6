// A formula without temporal operators, ready to be evaluated very often: what each atom is depends
// on one program's control state, or on the edge just taken, and is looked up.
#pragma once

#include <cstdint>
#include <vector>

#include "maide/check/packed_system.hpp"

namespace maide {

// One atom as a look-up table.
class PackedAtom {
 public:
  PackedAtom(const Atom& atom, const System& system);

  // No event: the initial state, or one that repeats for ever.
  static constexpr std::uint32_t no_edge = ~std::uint32_t{0};
  bool is_event() const { return is_event_; }
  // `state` was reached by `program` taking `edge`.
  template <std::size_t words>
  bool is_true(const PackedSystem& system, const PackedState<words>& state, std::size_t program,
               std::uint32_t edge) const {
    if (!is_event_) return values_[0][system.control(state, owner_)];
    return edge != no_edge && values_[program][edge];
  }

 private:
  bool is_event_;
  std::uint32_t owner_;                    // the program, of a state's atom
  std::vector<std::vector<bool>> values_;  // [0]: by control state; of an event: by program, edge
};

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

}  // namespace maide
