#include "maide/learn/ttt.hpp"

#include "maide/automata/words.hpp"
#include "maide/base/error.hpp"
#include "maide/learn/counterexample.hpp"

namespace maide {

bool Ttt::split(const Word& counterexample, std::span<const Symbol> outputs,
                const RunControl& control) {
  return split_for_a_time(states_along(hypothesis(), counterexample), counterexample,
                          outputs[counterexample.size() - 1], control);
}

bool Ttt::split_for_a_time(std::span<const StateId> states, const Word& word, Symbol last_output,
                           const RunControl& control) {
  if (!split_by_suffix(states, word, last_output, true, control)) return false;
  add_block_of_newest_state();
  return true;
}

void Ttt::complete(const RunControl& control) {
  while (true) {
    states_.settle(control);
    if (finalise_some_block()) continue;
    if (!blocks_.empty()) {
      split_block(blocks_.front(), control);
      continue;
    }
    states_.update();
    if (!split_where_a_claim_fails(control)) return;
  }
}

// No input tells states of any block apart. If the transitions were right about the suffix of this
// block for two states that answer it differently, they would part somewhere, and that would be a
// splitter. So they are wrong about one of them.
void Ttt::split_block(Node block, const RunControl& control) {
  const DiscriminationTree& tree = states_.tree();
  const std::size_t known_states = states_.size();
  for (const std::size_t side : {0, 1}) {
    Node leaf = tree.children(block)[side];
    while (!tree.is_leaf(leaf)) leaf = tree.children(leaf).front();
    const Word word = tree.suffix(block);
    const Word answer = tree.label(tree.children(block)[side]);
    std::vector<StateId> states{tree.state(leaf)};
    for (std::size_t i = 0; i < word.size(); ++i) {
      const auto transition = states_.transition(states.back(), word[i]);
      if (states_.output(transition) != answer[i]) {
        const Word cut = head(word, i + 1);
        if (split_for_a_time(states, cut, answer[i], control)) return;
        break;
      }
      states.push_back(states_.target_in_block(transition, control));
      if (states_.size() > known_states) return;  // that was a transition to a new state
    }
  }
  throw NondeterminismError(to_string(tree.suffix(block), oracle_.inputs()),
                            to_string(tree.label(tree.children(block)[0]), oracle_.outputs()),
                            to_string(tree.label(tree.children(block)[1]), oracle_.outputs()));
}

// The transition by the first input of the node's suffix has passed the node with the rest of it.
bool Ttt::is_certain(const Claim& claim) const {
  const DiscriminationTree& tree = states_.tree();
  const Node rest = tree.rest(claim.node);
  if (rest == DiscriminationTree::none) return true;
  const auto transition = states_.transition(claim.state, tree.suffix(claim.node).front());
  return tree.child_towards(rest, states_.place(transition)) != DiscriminationTree::none;
}

bool Ttt::split_where_a_claim_fails(const RunControl& control) {
  const DiscriminationTree& tree = states_.tree();
  for (; examined_ < states_.size(); ++examined_) {
    Node node = tree.leaf(examined_);
    while ((node = tree.parent(node)) != DiscriminationTree::none) {
      claims_.push_back({examined_, node});
    }
  }
  std::erase_if(claims_, [&](const Claim& claim) { return is_certain(claim); });
  for (const auto& [state, node] : claims_) {
    const Word& suffix = tree.suffix(node);
    const Word& answer = tree.label(tree.child_towards(node, tree.leaf(state)));
    std::vector<StateId> states{state};
    for (std::size_t i = 0; i < suffix.size(); ++i) {
      const StateId now = states.back();
      if (hypothesis().output(now, suffix[i]) != answer[i]) {
        const Word cut = head(suffix, i + 1);
        if (split_for_a_time(states, cut, answer[i], control)) return true;
        const Word word = joined(states_.access(state), suffix);
        throw NondeterminismError(
            to_string(word, oracle_.inputs()),
            to_string(joined(states_.access_outputs(state), answer), oracle_.outputs()),
            to_string(hypothesis().output_word(word), oracle_.outputs()));
      }
      states.push_back(hypothesis().target(now, suffix[i]));
    }
  }
  return false;
}

}  // namespace maide
