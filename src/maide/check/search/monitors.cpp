#include "maide/check/search/monitors.hpp"

#include <algorithm>
#include <stdexcept>

#include "maide/base/invariant.hpp"

namespace maide {

namespace {

// Beyond, an atom is evaluated each time.
constexpr std::size_t most_values = std::size_t{1} << 22;

}  // namespace

PackedAtom::PackedAtom(const Atom& atom, const System& system)
    : atom_(atom), system_(&system), is_event_(atom.is_event()) {
  if (is_event()) {
    for (std::uint32_t index = 0; index < system.programs.size(); ++index) {
      const Program& program = system.programs[index];
      std::vector<bool>& values = by_edge_.emplace_back(program.edges.size());
      for (std::size_t i = 0; i < program.edges.size(); ++i) {
        values[i] = is_event_of(atom, index, program.events_of(program.edges[i]));
      }
    }
    std::vector<bool>& nobodys = by_edge_.emplace_back();
    for (const NobodysAction& action : system.nobodys_actions) {
      nobodys.push_back(is_event_of(atom, nobody, action.what.events));
    }
    return;
  }
  if (atom.kind != Atom::Kind::expression) {
    add_field(false, atom.owner);
  } else {
    for_each_variable(system.expressions[atom.owner], [&](const Expression& leaf) {
      if (leaf.op == Expression::Operator::local) return add_field(false, leaf.owner);
      for (std::uint32_t i = 0; i < element_count(leaf); ++i) add_field(true, leaf.index + i);
    });
  }
  fill_values();
  if (fields_.size() == 1 && !fields_.front().is_model && !values_.empty()) {
    owner_ = fields_.front().index;
  }
}

void PackedAtom::add_field(bool is_model, std::uint32_t index) {
  for (const Field& field : fields_) {
    if (field.is_model == is_model && field.index == index) return;
  }
  fields_.push_back(
      {is_model, index,
       is_model ? system_->models[index].automaton.size() : system_->programs[index].states.size(),
       0});
}

void PackedAtom::fill_values() {
  std::size_t count = 1;
  for (Field& field : fields_) {
    field.stride = count;
    if (field.size > most_values / count) return;
    count *= field.size;
  }
  GlobalState state = initial_state(*system_);
  values_.resize(count);
  for (std::size_t place = 0; place < count; ++place) {
    for (const Field& field : fields_) {
      const auto at = static_cast<std::uint32_t>(place / field.stride % field.size);
      (field.is_model ? state.models : state.programs)[field.index] = at;
    }
    values_[place] = maide::is_true(atom_, *system_, state, nullptr);
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

std::vector<std::uint32_t> find_parts(const LtlAutomaton& automaton,
                                      const std::vector<bool>& is_waiting) {
  const auto states = static_cast<std::uint32_t>(automaton.states.size());
  std::vector<bool> is_root = is_waiting;
  for (std::uint32_t state = 0; state < states; ++state) {
    is_root[state] =
        is_root[state] && std::count(automaton.initial.begin(), automaton.initial.end(), state) > 0;
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
