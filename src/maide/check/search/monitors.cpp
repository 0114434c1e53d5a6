#include "maide/check/search/monitors.hpp"

#include <algorithm>
#include <numeric>
#include <stdexcept>

#include "maide/base/invariant.hpp"
#include "maide/check/system/atom_view.hpp"

namespace maide {

namespace {

// Beyond, an atom is evaluated each time.
constexpr std::size_t most_values = std::size_t{1} << 22;

}  // namespace

PackedAtom::PackedAtom(const Atom& atom, const System& system)
    : atom_(atom), system_(&system), is_event_(atom.is_event()) {
  const AtomView view(atom, system);
  if (is_event_) {
    const auto add = [&](std::uint32_t actor, std::size_t actions) {
      std::vector<bool>& values = by_edge_.emplace_back();
      for (std::uint32_t i = 0; i < actions; ++i) values.push_back(view.sees(actor, i));
    };
    for (std::uint32_t index = 0; index < system.programs.size(); ++index) {
      add(index, system.programs[index].edges.size());
    }
    add(nobody, system.nobodys_actions.size());
    return;
  }
  std::vector<std::vector<std::uint32_t>> states;
  for (const AtomField& field : view.fields()) {
    states.emplace_back(count_states(field, system));
    std::iota(states.back().begin(), states.back().end(), 0);
  }
  values_ = view.values(states, most_values).value_or(std::vector<bool>());
  std::size_t stride = values_.size();
  for (std::size_t i = 0; i < states.size(); ++i) {
    const auto& [is_model, index, variables] = view.fields()[i];
    fields_.push_back({is_model, index, stride /= states[i].size()});
  }
  if (fields_.size() == 1 && !fields_.front().is_model && !values_.empty()) {
    owner_ = fields_.front().index;
  }
}

Condition::Condition(const Formula& formula, const System& system) {
  if (!is_boolean(formula)) throw std::invalid_argument("a condition has no temporal operators");
  add(formula, system);
}

bool Condition::has_events() const { return std::ranges::any_of(atoms_, &PackedAtom::is_event); }

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

std::vector<std::uint32_t> find_parts(const LtlAutomaton& automaton,
                                      const std::vector<bool>& is_waiting) {
  const auto states = static_cast<std::uint32_t>(automaton.states.size());
  std::vector<bool> is_root = is_waiting;
  for (std::uint32_t state = 0; state < states; ++state) {
    is_root[state] = is_root[state] && std::ranges::count(automaton.initial, state) > 0;
  }
  for (std::uint32_t state = 0; state < states; ++state) {
    for (const auto& transition : automaton.states[state]) {
      if (transition.target != state) is_root[transition.target] = false;
    }
  }
  std::vector<std::vector<std::uint32_t>> beside(states);
  for (std::uint32_t state = 0; state < states; ++state) {
    for (const auto& transition : automaton.states[state]) {
      if (is_root[state]) continue;
      beside[state].push_back(transition.target);
      beside[transition.target].push_back(state);
    }
  }
  std::vector<std::uint32_t> part_of(states, no_part);
  std::uint32_t parts = 0;
  for (std::uint32_t first = 0; first < states; ++first) {
    if (is_root[first] || part_of[first] != no_part) continue;
    std::vector<std::uint32_t> open{first};
    part_of[first] = parts;
    while (!open.empty()) {
      const std::uint32_t state = open.back();
      open.pop_back();
      for (const std::uint32_t next : beside[state]) {
        if (part_of[next] != no_part) continue;
        part_of[next] = parts;
        open.push_back(next);
      }
    }
    ++parts;
  }
  return part_of;
}

}  // namespace maide
