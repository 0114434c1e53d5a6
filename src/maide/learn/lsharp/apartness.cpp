#include "maide/learn/lsharp/apartness.hpp"

#include <algorithm>
#include <utility>

#include "maide/base/invariant.hpp"

namespace maide {

Apartness::Apartness(std::size_t inputs) : tree_(inputs) {
  add_state(ObservationTree::root, {}, 0);
}

Word Apartness::word_to(Transition transition) const {
  Word word = access_[source(transition)];
  word.push_back(input(transition));
  return word;
}

// Puts a node into the basis that is apart from all of it.
void Apartness::add_state(Node node, Word access, Transition entry) {
  MAIDE_CHECK(node == tree_.find(ObservationTree::root, access));
  MAIDE_CHECK(basis_.empty() || basis_target_[entry] == basis_.size());
  tree_.make_table(node);
  basis_.push_back(node);
  access_.push_back(std::move(access));
  entry_.push_back(entry);
  const std::size_t first = basis_target_.size();
  basis_target_.resize(first + input_count(), Mealy::no_state);
  waiting_.emplace_back();
  unasked_.push_back(0);
  for (std::size_t i = first; i < basis_target_.size(); ++i) {
    const auto transition = static_cast<Transition>(i);
    if (target_node(transition) == ObservationTree::none) {
      ++unasked_.back();
    } else {
      find_class(transition);
    }
  }
  const auto state = static_cast<StateId>(basis_.size() - 1);
  if (unasked_.back() > 0) {
    incomplete_.push_back(state);
  } else {
    classes_.add_state(state, node, tree_);
  }
}

// Of a transition from a new state: the words below are those asked from its node, in this order.
void Apartness::find_class(Transition transition) {
  struct Place {
    Node node;
    std::size_t above;  // in `places`
  };
  std::vector<Place> places{{target_node(transition), 0}};
  std::vector<std::size_t> ends;
  for (std::size_t place = 0; place < places.size(); ++place) {
    const std::size_t known = places.size();
    tree_.for_each_child(places[place].node, [&](Node child) { places.push_back({child, place}); });
    if (places.size() == known) ends.push_back(place);
  }
  std::ranges::sort(ends, {}, [&](std::size_t end) { return places[end].node; });
  for (const std::size_t end : ends) {
    Word inputs, outputs;
    for (std::size_t place = end; place != 0; place = places[place].above) {
      inputs.push_back(tree_.input(places[place].node));
      outputs.push_back(tree_.output(places[place].node));
    }
    std::ranges::reverse(inputs);
    std::ranges::reverse(outputs);
    classes_.move(transition, inputs, outputs, tree_);
  }
  MAIDE_CHECK(classes_.class_of(transition) != FrontierClasses::none);
}

ObservationTree::Inserted Apartness::insert(const Word& inputs, const Word& outputs) {
  const ObservationTree::Inserted result = tree_.insert(inputs, outputs);
  if (result.conflict || result.known == inputs.size()) return result;
  const std::span<const Symbol> all_inputs(inputs), all_outputs(outputs);
  StateId state = 0;
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    MAIDE_CHECK(access_[state].size() == i);  // the word is in the basis so far
    if (unasked_[state] == 0) {
      const std::size_t known = result.known < i ? 0 : result.known - i;
      classes_.refute(state, all_inputs.subspan(i), all_outputs.subspan(i), known);
    } else {
      look_at_waiting(state);
    }
    const auto transition = static_cast<Transition>(state * input_count() + inputs[i]);
    const StateId target = basis_target_[transition];
    if (target != Mealy::no_state) {
      state = target;
      continue;
    }
    classes_.move(transition, all_inputs.subspan(i + 1), all_outputs.subspan(i + 1), tree_);
    MAIDE_CHECK(i < result.known || unasked_[state] > 0);
    if (i >= result.known && --unasked_[state] == 0) {
      MAIDE_CHECK(waiting_[state].empty());  // looked at above
      std::erase(incomplete_, state);
      classes_.add_state(state, basis_[state], tree_);
    }
    break;
  }
  return result;
}

// More is known of the state since: they may have to wait no longer.
void Apartness::look_at_waiting(StateId state) {
  for (const Transition transition : std::exchange(waiting_[state], {})) {
    if (is_new(transition)) isolated_.push_back(transition);
  }
}

// The node is apart from all candidates; but from an incomplete state it may not be.
bool Apartness::must_wait(Transition transition) {
  MAIDE_CHECK(is_new(transition) && target_node(transition) != ObservationTree::none);
  const Node node = target_node(transition);
  const auto found = std::ranges::find_if(
      incomplete_, [&](StateId state) { return !tree_.are_apart(node, basis_[state]); });
  if (found == incomplete_.end()) return false;
  waiting_[*found].push_back(transition);
  return true;
}

bool Apartness::has_isolated() {
  for (const Transition transition : classes_.take_isolated()) isolated_.push_back(transition);
  std::erase_if(isolated_, [&](Transition transition) {
    return !is_new(transition) || must_wait(transition);
  });
  return !isolated_.empty();
}

void Apartness::promote_isolated() {
  if (!has_isolated()) return;
  std::vector<Transition> isolated = std::exchange(isolated_, {});
  std::ranges::stable_sort(isolated, [&](Transition left, Transition right) {
    return access_[source(left)].size() < access_[source(right)].size();
  });
  for (const Transition transition : isolated) {
    // One of the new states may have become a candidate.
    if (!is_new(transition) || must_wait(transition)) continue;
    basis_target_[transition] = static_cast<StateId>(basis_.size());
    classes_.remove(transition);
    add_state(target_node(transition), word_to(transition), transition);
    MAIDE_CHECK(candidates(transition).empty());
  }
}

void Apartness::check_invariants() const {
  classes_.check_invariants(tree_);
  const std::size_t inputs = input_count();
  MAIDE_CHECK_ALWAYS(basis_target_.size() == size() * inputs);
  MAIDE_CHECK_ALWAYS(basis_.front() == ObservationTree::root && access_.front().empty());
  for (StateId state = 0; state < size(); ++state) {
    if (state > 0) {
      const Transition entry = entry_[state];
      MAIDE_CHECK_ALWAYS(source(entry) < state && basis_target_[entry] == state);
      MAIDE_CHECK_ALWAYS(access_[state] == word_to(entry) && basis_[state] == target_node(entry));
    }
    for (StateId other = 0; other < state; ++other) {
      MAIDE_CHECK_ALWAYS(tree_.are_apart(basis_[state], basis_[other]));
    }
    std::size_t unasked = 0;
    for (Symbol input = 0; input < inputs; ++input) {
      const auto transition = static_cast<Transition>(state * inputs + input);
      unasked += target_node(transition) == ObservationTree::none ? 1 : 0;
      check_transition(transition);
    }
    MAIDE_CHECK_ALWAYS(unasked == unasked_[state]);
    MAIDE_CHECK_ALWAYS((unasked > 0) == (std::ranges::count(incomplete_, state) == 1));
  }
}

// It leads nowhere yet, to the basis, or to a frontier node with the candidates that it should
// have.
void Apartness::check_transition(Transition transition) const {
  const Node node = target_node(transition);
  const bool is_frontier = classes_.class_of(transition) != FrontierClasses::none;
  const StateId target = basis_target_[transition];
  if (node == ObservationTree::none || target != Mealy::no_state) {
    MAIDE_CHECK_ALWAYS(!is_frontier);
    MAIDE_CHECK_ALWAYS(target == Mealy::no_state || basis_[target] == node);
    return;
  }
  MAIDE_CHECK_ALWAYS(is_frontier);
  std::vector<StateId> fitting;
  for (StateId state = 0; state < size(); ++state) {
    if (unasked_[state] == 0 && !tree_.are_apart(node, basis_[state])) fitting.push_back(state);
  }
  MAIDE_CHECK_ALWAYS(candidates(transition) == fitting);
}

}  // namespace maide
