#include "maide/learn/tree/ttt.hpp"

#include <algorithm>
#include <span>
#include <utility>

#include "maide/automata/alphabet.hpp"
#include "maide/base/error.hpp"
#include "maide/base/invariant.hpp"
#include "maide/learn/counterexample.hpp"

namespace maide {

void FinalizingLearner::add_block_of_newest_state() {
  const DiscriminationTree& tree = states_.tree();
  const Node block = tree.block_of(tree.leaf(static_cast<StateId>(states_.size() - 1)));
  if (std::ranges::find(blocks_, block) == blocks_.end()) blocks_.push_back(block);
}

// The shortest suffix that tells states of the block apart and of which all is known.
std::optional<DiscriminationTree::Inner> FinalizingLearner::find_splitter(Node block) const {
  const DiscriminationTree& tree = states_.tree();
  const std::vector<StateId> members = tree.states_below(block);
  MAIDE_CHECK(members.size() > 1 && tree.is_temporary(block));
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
    MAIDE_CHECK(!rest.empty() && !tree.is_temporary(common));
    if (best && best->suffix.size() <= rest.size() + 1) continue;
    best = DiscriminationTree::Inner{{input}, common};
    best->suffix.insert(best->suffix.end(), rest.begin(), rest.end());
  }
  return best;
}

bool FinalizingLearner::finalise_some_block() {
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

void FinalizingLearner::check_invariants() const {
  TreeLearner::check_invariants();
  MAIDE_CHECK_ALWAYS(blocks_.empty());
  const DiscriminationTree& tree = states_.tree();
  for (StateId state = 0; state < states_.size(); ++state) {
    for (Node node = tree.parent(tree.leaf(state)); node != DiscriminationTree::none;
         node = tree.parent(node)) {
      // Closed under suffixes.
      MAIDE_CHECK_ALWAYS(tree.suffix(node).size() == 1 ||
                         tree.rest(node) != DiscriminationTree::none);
    }
  }
}

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
  MAIDE_CHECK(tree.is_temporary(block) && tree.children(block).size() > 1);
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

bool TttLambda::split(const Word& counterexample, std::span<const Symbol> outputs,
                      const RunControl& control) {
  return promote_along({hypothesis().initial(), counterexample, outputs[counterexample.size() - 1]},
                       control);
}

void TttLambda::complete(const RunControl& control) {
  while (true) {
    states_.settle(control);
    if (finalise_some_block()) continue;
    states_.update();
    if (blocks_.empty()) break;
    follow_witness(control);
  }
  witnesses_.clear();
}

std::optional<TttLambda::Mistake> TttLambda::find_mistake_after(StateId state, const Word& word,
                                                                const RunControl& control) {
  const Word& access = states_.access(state);
  ++counterexample_queries_;
  const Word outputs = oracle_.ask(joined(access, word), control);
  const auto after = std::span(outputs).subspan(access.size());
  const std::size_t length = first_mismatch(hypothesis(), state, word, after);
  if (length == 0) return std::nullopt;
  return Mistake{state, head(word, length), after[length - 1]};
}

// The same, after one of the states in the leaf of `state`.
std::optional<TttLambda::Mistake> TttLambda::find_mistake(StateId state, const Word& word,
                                                          const RunControl& control) {
  const DiscriminationTree& tree = states_.tree();
  for (const StateId member : tree.states_below(tree.block_of(tree.leaf(state)))) {
    if (auto mistake = find_mistake_after(member, word, control)) return mistake;
  }
  return std::nullopt;
}

// Finds the transition where it comes from, and makes its word an access word; false if the system
// answers otherwise now.
//
// Invariant: `wrong` is in the leaf of states[low], and what the hypothesis says last about the
// word from `low` on is wrong after it. It is right about the word from `high` on after all states
// in the leaf of states[high], for outputs of transitions are facts.
// NOLINTNEXTLINE(performance-unnecessary-value-param): changed by its parts
bool TttLambda::promote_along(Mistake mistake, const RunControl& control) {
  auto& [wrong, word, last_output] = mistake;
  const std::vector<StateId> states = states_along(hypothesis(), wrong, word);
  std::size_t low = 0, high = word.size() - 1;
  while (low < high && states_.is_spanning(states_.transition(wrong, word[low]))) {
    wrong = states_.tree().state(states_.place(states_.transition(wrong, word[low])));
    ++low;
  }
  while (high > low + 1) {
    const std::size_t middle = low + (high - low) / 2;
    const auto found = find_mistake(states[middle], tail(word, middle), control);
    if (!found) {
      high = middle;
      continue;
    }
    low = middle;
    wrong = found->state;
    last_output = found->last_output;
    word.resize(middle + found->word.size());
    high = std::min(high, word.size() - 1);
  }
  MAIDE_CHECK(high < word.size() && (low == high || low + 1 == high));
  const auto from = states_.transition(wrong, word[low]);
  if (high == low || states_.is_spanning(from)) return false;
  const bool is_alone = states_.tree().is_leaf(states_.place(from));
  if (is_alone && high + 1 == word.size()) {  // a suffix of one input is as short as can be
    states_.split(states[high], from, {{word[high]}},
                  states_.known_answer(states[high], word[high], DiscriminationTree::none),
                  {last_output});
    return true;
  }
  states_.promote(from);
  add_block_of_newest_state();
  witnesses_.push_back({static_cast<StateId>(states_.size() - 1), tail(word, high), last_output});
  return true;
}

// No input leads the states of any block apart, so the hypothesis predicts the same after all of
// them; but after the newest of a block the system answers otherwise than after the older ones.
void TttLambda::follow_witness(const RunControl& control) {
  const DiscriminationTree& tree = states_.tree();
  while (!tree.is_temporary(tree.parent(tree.leaf(witnesses_.back().state)))) {
    witnesses_.pop_back();
    MAIDE_CHECK(!witnesses_.empty());  // each block has one
  }
  const auto [newest, suffix, last_output] = witnesses_.back();
  const StateId oldest = tree.representative(tree.parent(tree.leaf(newest)));
  MAIDE_CHECK(oldest != newest);
  for (const StateId state : {newest, oldest}) {
    auto mistake = find_mistake_after(state, suffix, control);
    if (mistake && promote_along(std::move(*mistake), control)) return;
  }
  const Word word = joined(states_.access(newest), suffix);
  const Word now = hypothesis().output_word(word);
  Word before = now;
  before.back() = last_output;
  throw NondeterminismError(to_string(word, oracle_.inputs()), to_string(before, oracle_.outputs()),
                            to_string(now, oracle_.outputs()));
}

}  // namespace maide
