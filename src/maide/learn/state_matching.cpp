#include "maide/learn/state_matching.hpp"

namespace maide {
namespace {

// Enough to tell states apart; more would make one difference count at every state above it.
constexpr std::size_t most_nodes = 256;
constexpr std::size_t never = ~std::size_t{0};

}  // namespace

void StateMatching::look_below(const ObservationTree& tree, ObservationTree::Node node) {
  below_.assign(1, {});
  std::vector<ObservationTree::Node> nodes{node};
  for (std::size_t next = 0; next < nodes.size() && nodes.size() < most_nodes; ++next) {
    tree.for_each_child(nodes[next], [&](ObservationTree::Node child) {
      if (!old_.has_input(tree.input(child))) return;
      below_.push_back({next, tree.input(child), old_output_[tree.output(child)]});
      nodes.push_back(child);
    });
  }
}

std::size_t StateMatching::count_contradictions(StateId old_state, std::size_t limit) {
  std::size_t count = 0;
  reached_.resize(below_.size());
  reached_[0] = old_state;
  for (std::size_t i = 1; i < below_.size() && count < limit; ++i) {
    const Seen& edge = below_[i];
    const StateId from = reached_[edge.parent];
    if (old_.output(from, edge.input) != edge.output) ++count;
    reached_[i] = old_.target(from, edge.input);
  }
  return count;
}

// The state with the fewest contradictions; of several, `first`, or else the one of least number.
StateId StateMatching::find_best(StateId first) {
  StateId best = first;
  std::size_t least = count_contradictions(first, below_.size() + 1);
  for (StateId state = 0; state < old_.size() && least > 0; ++state) {
    const std::size_t count = count_contradictions(state, least);
    if (count >= least) continue;
    least = count;
    best = state;
  }
  return best;
}

// What the match of the state before a new one says.
StateId StateMatching::guess(const Apartness& apartness, StateId state) const {
  StateId before = 0;
  Apartness::Transition last = 0;
  if (state == 0) return old_.initial();
  for (const Symbol input : apartness.access(state)) {
    last = static_cast<Apartness::Transition>(before * apartness.input_count() + input);
    before = apartness.basis_target(last);
  }
  const StateId target = expected(apartness, last);
  return target == none ? old_.initial() : target;
}

void StateMatching::update(const Apartness& apartness, const Alphabet& outputs) {
  while (old_output_.size() < outputs.size()) {
    const auto known = old_.outputs().find(outputs.name(static_cast<Symbol>(old_output_.size())));
    old_output_.push_back(known.value_or(none));
  }
  const std::size_t known = apartness.tree().size();
  for (StateId state = 0; state < apartness.size(); ++state) {
    if (state == match_.size()) {
      match_.push_back(guess(apartness, state));
      next_look_.push_back(0);
    }
    if (known < next_look_[state]) continue;
    look_below(apartness.tree(), apartness.node(state));
    match_[state] = find_best(match_[state]);
    next_look_[state] = below_.size() < most_nodes ? known + known / 16 : never;
  }
  matched_by_.assign(old_.size(), none);
  for (StateId state = 0; state < match_.size(); ++state) {
    if (matched_by_[match_[state]] == none) matched_by_[match_[state]] = state;
  }
}

StateId StateMatching::expected(const Apartness& apartness,
                                Apartness::Transition transition) const {
  const Symbol input = apartness.input(transition);
  if (!old_.has_input(input)) return none;
  return old_.target(match_[apartness.source(transition)], input);
}

bool StateMatching::agrees(const Apartness& apartness, Apartness::Transition transition,
                           Symbol output) const {
  const Symbol input = apartness.input(transition);
  return old_.has_input(input) && output < old_output_.size() &&
         old_.output(match_[apartness.source(transition)], input) == old_output_[output];
}

}  // namespace maide
