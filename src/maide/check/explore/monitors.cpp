#include "maide/check/explore/monitors.hpp"

#include <algorithm>
#include <stdexcept>

#include "maide/base/invariant.hpp"

namespace maide {

PackedAtom::PackedAtom(const Atom& atom, const System& system)
    : is_event_(atom.is_event()), owner_(atom.owner) {
  if (!is_event_) {
    const Program& program = system.programs[owner_];
    std::vector<bool>& values = values_.emplace_back(program.states.size());
    for (ControlState at = 0; at < program.states.size(); ++at) {
      values[at] =
          atom.kind == Atom::Kind::end ? program.is_end(at) : program.has_label(at, atom.symbol);
    }
    return;
  }
  const auto kind =
      atom.kind == Atom::Kind::input ? ProgramEdge::Kind::give : ProgramEdge::Kind::take;
  for (const Program& program : system.programs) {
    std::vector<bool>& values = values_.emplace_back(program.edges.size());
    for (std::size_t i = 0; i < program.edges.size(); ++i) {
      const ProgramEdge& edge = program.edges[i];
      values[i] = edge.kind == kind && edge.model == atom.owner && edge.symbol == atom.symbol;
    }
  }
}

Condition::Condition(const Formula& formula, const System& system) {
  if (!is_boolean(formula)) throw std::invalid_argument("a condition has no temporal operators");
  add(formula, system);
}

bool Condition::has_events() const {
  return std::any_of(atoms_.begin(), atoms_.end(),
                     [](const PackedAtom& atom) { return atom.is_event(); });
}

std::uint32_t Condition::add(const Formula& formula, const System& system) {
  Node node;
  node.op = formula->op;
  if (formula->op == FormulaNode::Operator::atom) {
    node.left = static_cast<std::uint32_t>(atoms_.size());
    atoms_.emplace_back(formula->atom, system);
  } else {
    if (formula->left) node.left = add(formula->left, system);
    if (formula->right) node.right = add(formula->right, system);
  }
  MAIDE_CHECK(formula->op == FormulaNode::Operator::atom || nodes_.empty() ||
              (node.left < nodes_.size() && node.right < nodes_.size()));
  nodes_.push_back(node);
  return static_cast<std::uint32_t>(nodes_.size() - 1);
}

}  // namespace maide
