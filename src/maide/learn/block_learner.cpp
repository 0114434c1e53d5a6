#include "maide/learn/block_learner.hpp"

#include <algorithm>

namespace maide {

void BlockLearner::add_block_of_newest_state() {
  const DiscriminationTree& tree = states_.tree();
  const Node block = tree.block_of(tree.leaf(static_cast<StateId>(states_.size() - 1)));
  if (std::ranges::find(blocks_, block) == blocks_.end()) blocks_.push_back(block);
}

// The shortest suffix that tells states of the block apart and of which all is known.
std::optional<DiscriminationTree::Inner> BlockLearner::find_splitter(Node block) const {
  const DiscriminationTree& tree = states_.tree();
  const std::vector<StateId> members = tree.states_below(block);
  std::optional<DiscriminationTree::Inner> best;
  for (Symbol input = 0; input < oracle_.inputs().size(); ++input) {
    const auto first = states_.transition(members.front(), input);
    Node common = tree.block_of(states_.place(first));
    const Node first_place = common;
    bool outputs_differ = false, places_differ = false;
    for (const StateId member : members) {
      const auto transition = states_.transition(member, input);
      outputs_differ = outputs_differ || states_.output(transition) != states_.output(first);
      const Node place = tree.block_of(states_.place(transition));
      if (place == first_place) continue;
      places_differ = true;
      common = tree.common_ancestor(common, place);
    }
    if (outputs_differ) return DiscriminationTree::Inner{{input}};
    if (!places_differ) continue;
    const Word& rest = tree.suffix(common);
    if (best && best->suffix.size() <= rest.size() + 1) continue;
    best = DiscriminationTree::Inner{{input}, common};
    best->suffix.insert(best->suffix.end(), rest.begin(), rest.end());
  }
  return best;
}

bool BlockLearner::finalise_some_block() {
  for (std::size_t i = 0; i < blocks_.size(); ++i) {
    const Node block = blocks_[i];
    auto splitter = find_splitter(block);
    if (!splitter) continue;
    states_.finalise(block, std::move(*splitter));
    blocks_.erase(blocks_.begin() + static_cast<std::ptrdiff_t>(i));
    for (const Node child : states_.tree().children(block)) {
      if (states_.tree().is_temporary(child)) blocks_.push_back(child);
    }
    return true;
  }
  return false;
}

}  // namespace maide
