#include "maide/learn/apartness.hpp"

#include <algorithm>
#include <utility>

namespace maide {

Apartness::Apartness(std::size_t inputs) : tree_(inputs) { add_state(ObservationTree::root, {}); }

Word Apartness::word_to(Transition transition) const {
  Word word = access_[source(transition)];
  word.push_back(input(transition));
  return word;
}

// Puts a node into the basis that is apart from all of it.
void Apartness::add_state(Node node, Word access) {
  const auto state = static_cast<StateId>(basis_.size());
  tree_.make_table(node);
  basis_.push_back(node);
  access_.push_back(std::move(access));
  watchers_.emplace_back();
  const std::size_t first = basis_target_.size();
  for (Transition transition = 0; transition < first; ++transition) {
    if (basis_target_[transition] != Mealy::no_state) continue;
    const Node target = target_node(transition);
    if (target == ObservationTree::none || tree_.are_apart(target, node)) continue;
    candidates_[transition].push_back(state);
    watchers_[state].push_back(transition);
  }
  basis_target_.resize(first + input_count(), Mealy::no_state);
  candidates_.resize(first + input_count());
  for (std::size_t i = first; i < basis_target_.size(); ++i) {
    find_candidates(static_cast<Transition>(i));
  }
}

// Of a transition to a new frontier node, or to none.
void Apartness::find_candidates(Transition transition) {
  const Node target = target_node(transition);
  if (target == ObservationTree::none) return;
  for (StateId state = 0; state < basis_.size(); ++state) {
    if (tree_.are_apart(target, basis_[state])) continue;
    candidates_[transition].push_back(state);
    watchers_[state].push_back(transition);
  }
  if (candidates_[transition].empty()) isolated_.push_back(transition);
}

bool Apartness::are_apart_by(Node node, std::span<const Symbol> inputs,
                             std::span<const Symbol> outputs) const {
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    node = tree_.child(node, inputs[i]);
    if (node == ObservationTree::none) return false;
    if (tree_.output(node) != outputs[i]) return true;
  }
  return false;
}

void Apartness::remove_candidate(Transition transition, StateId state) {
  std::erase(candidates_[transition], state);
  if (candidates_[transition].empty()) isolated_.push_back(transition);
}

ObservationTree::Inserted Apartness::insert(const Word& inputs, const Word& outputs) {
  const ObservationTree::Inserted result = tree_.insert(inputs, outputs);
  if (result.conflict || result.known == inputs.size()) return result;
  const auto inputs_from = [&](std::size_t i) { return std::span(inputs).subspan(i); };
  const auto outputs_from = [&](std::size_t i) { return std::span(outputs).subspan(i); };
  StateId state = 0;
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    // Frontier nodes that this basis state is a candidate of.
    std::vector<Transition>& watchers = watchers_[state];
    std::erase_if(watchers, [&](Transition transition) {
      const auto& candidates = candidates_[transition];
      if (!std::binary_search(candidates.begin(), candidates.end(), state)) return true;
      if (!are_apart_by(target_node(transition), inputs_from(i), outputs_from(i))) return false;
      remove_candidate(transition, state);
      return true;
    });
    const auto transition = static_cast<Transition>(state * input_count() + inputs[i]);
    if (basis_target_[transition] != Mealy::no_state) {
      state = basis_target_[transition];
      continue;
    }
    if (i >= result.known) {
      find_candidates(transition);
    } else {
      const std::vector<StateId> candidates = candidates_[transition];
      for (const StateId candidate : candidates) {
        if (are_apart_by(basis_[candidate], inputs_from(i + 1), outputs_from(i + 1))) {
          remove_candidate(transition, candidate);
        }
      }
    }
    break;
  }
  return result;
}

StateId Apartness::promote_isolated() {
  const auto first = static_cast<StateId>(basis_.size());
  std::vector<Transition> isolated = std::exchange(isolated_, {});
  std::stable_sort(isolated.begin(), isolated.end(), [&](Transition left, Transition right) {
    return access_[source(left)].size() < access_[source(right)].size();
  });
  for (const Transition transition : isolated) {
    if (!candidates_[transition].empty()) continue;  // one of the new states has become one
    basis_target_[transition] = static_cast<StateId>(basis_.size());
    add_state(target_node(transition), word_to(transition));
  }
  return first;
}

}  // namespace maide
