// L# with a model of an earlier version: the words that come first, and the rules `rebuild` and
// `doubt`; see lsharp.hpp.
#include <algorithm>
#include <numeric>
#include <set>
#include <utility>
#include <variant>

#include "maide/automata/alphabet.hpp"
#include "maide/learn/lsharp/lsharp.hpp"

namespace maide {

LSharp::LSharp(OutputOracle& oracle, const Mealy& old_model, Separation separation,
               const RunControl& control, std::span<const Word> first_words)
    : LSharp(oracle, separation) {
  matching_.emplace(OldModel(old_model, oracle.inputs(), control));
  first_words_.assign(first_words.rbegin(), first_words.rend());
}

// Few at once as long as little speaks for the old model.
void LSharp::verify(const RunControl& control) {
  constexpr std::size_t most_at_once = 64;
  const ObservationTree& tree = apartness_.tree();
  for (std::size_t at_once = 1; !first_words_.empty();
       at_once = std::min(2 * at_once, most_at_once)) {
    std::vector<Query> batch;
    while (!first_words_.empty() && batch.size() < at_once) {
      const Word word = std::move(first_words_.back());
      first_words_.pop_back();
      if (tree.find(ObservationTree::root, word) == ObservationTree::none) batch.emplace_back(word);
    }
    if (batch.empty()) return;
    ask(batch, control);
    if (!std::all_of(batch.begin(), batch.end(),
                     [&](const Query& query) { return is_old_output(std::get<Word>(query)); })) {
      first_words_.clear();
    }
  }
}

// Of a word in the tree: whether all its outputs are those of the old model.
bool LSharp::is_old_output(const Word& word) const {
  const OldModel& old = matching_->old_model();
  StateId state = old.initial();
  Node node = ObservationTree::root;
  for (const Symbol input : word) {
    node = apartness_.tree().child(node, input);
    if (oracle_.outputs().name(apartness_.tree().output(node)) !=
        old.outputs().name(old.output(state, input))) {
      return false;
    }
    state = old.target(state, input);
  }
  return true;
}

// Asks for old states that no state of the basis is matched with, where the old model expects them;
// false if there are none.
bool LSharp::rebuild(const RunControl& control) {
  if (!matching_ || rebuilt_ == apartness_.size()) return false;
  matching_->update(apartness_, oracle_.outputs());
  std::vector<Query> batch;
  std::set<StateId> asked;  // old states
  for (Transition transition = 0; transition < apartness_.transition_count(); ++transition) {
    if (apartness_.target_node(transition) != ObservationTree::none) continue;
    const StateId expected = matching_->expected(apartness_, transition);
    if (expected == StateMatching::none) continue;
    if (matching_->matched_by(expected) != StateMatching::none) continue;
    if (!asked.insert(expected).second) continue;
    batch.emplace_back(
        joined(apartness_.word_to(transition), matching_->old_model().identifying_word(expected)));
    if (batch.size() == batch_size) break;
  }
  if (batch.empty()) {
    rebuilt_ = apartness_.size();
    return false;
  }
  ask(batch, control);
  return true;
}

// Every transition has one candidate. Asks one that should be another state, and its candidate,
// what told them apart in the old model; false if nothing is in doubt.
bool LSharp::doubt(const RunControl& control) {
  if (!matching_ || doubts_left_ <= 0) return false;
  matching_->update(apartness_, oracle_.outputs());
  const ObservationTree& tree = apartness_.tree();
  for (Transition transition = 0; transition < apartness_.transition_count(); ++transition) {
    if (apartness_.basis_target(transition) != Mealy::no_state) continue;
    const StateId expected = matching_->expected(apartness_, transition);
    if (expected == StateMatching::none) continue;
    if (matching_->matched_by(expected) != StateMatching::none) continue;
    const StateId candidate = apartness_.candidates(transition).front();
    if (matching_->match(candidate) == expected) continue;
    const Word suffix =
        matching_->old_model().separating_word(expected, matching_->match(candidate));
    std::vector<Query> batch;
    const Word here = joined(apartness_.word_to(transition), suffix);
    const Word there = joined(apartness_.access(candidate), suffix);
    const auto is_new = [&](const Word& word) {
      return tree.find(ObservationTree::root, word) == ObservationTree::none;
    };
    if (is_new(here)) batch.emplace_back(here);
    // What is asked here may begin with what is asked there.
    if (is_new(there) && !is_prefix(there, here)) batch.emplace_back(there);
    if (batch.empty()) continue;
    ask(batch, control);
    doubts_left_ += apartness_.has_isolated() ? 1 : -1;
    return true;
  }
  return false;
}

// A transition whose output is the old model's leads where that says, probably.
void LSharp::weigh_expected(Transition transition, Symbol output,
                            std::vector<double>& weights) const {
  if (!matching_ || !matching_->agrees(apartness_, transition, output)) return;
  const StateId expected = matching_->matched_by(matching_->expected(apartness_, transition));
  if (expected == StateMatching::none) return;
  weights[expected] += 4 * std::accumulate(weights.begin(), weights.end(), 0.0);
}

}  // namespace maide
