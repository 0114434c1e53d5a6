#include "maide/learn/ttt_lambda.hpp"

#include <algorithm>
#include <utility>

#include "maide/automata/words.hpp"
#include "maide/base/error.hpp"
#include "maide/learn/counterexample.hpp"

namespace maide {

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
  while (!tree.is_temporary(tree.parent(tree.leaf(witnesses_.back().state)))) witnesses_.pop_back();
  const auto [newest, suffix, last_output] = witnesses_.back();
  const StateId oldest = tree.representative(tree.parent(tree.leaf(newest)));
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
