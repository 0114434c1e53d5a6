#include "maide/learn/lsharp/frontier_hypothesis.hpp"

#include <algorithm>
#include <utility>

#include "maide/automata/alphabet.hpp"
#include "maide/base/invariant.hpp"

namespace maide {

void FrontierHypothesis::update(Apartness& apartness, const Alphabet& inputs,
                                const Alphabet& outputs) {
  if (machine_.size() == 0) machine_ = Mealy(inputs, outputs, 1);
  for (std::size_t i = machine_.outputs().size(); i < outputs.size(); ++i) {
    machine_.intern_output(outputs.name(static_cast<Symbol>(i)));
  }
  users_.resize(apartness.transition_count());
  is_unchecked_.resize(apartness.classes().size());
  const std::size_t before = machine_.size();
  while (machine_.size() < apartness.size()) machine_.add_state();
  for (std::size_t state = before; state < machine_.size(); ++state) {
    set_target(apartness.entry(static_cast<StateId>(state)), apartness);
  }
  const FrontierClasses::Changes changes = apartness.classes().take_changes();
  for (const Transition transition : changes.members) set_target(transition, apartness);
  for (const Class at : changes.classes) {
    apartness.classes().for_each_member(
        at, [&](Transition transition) { set_target(transition, apartness); });
    check_again(at);
  }
  MAIDE_CHECK(machine_.size() == apartness.size());
}

void FrontierHypothesis::set_target(Transition transition, const Apartness& apartness) {
  const StateId source = apartness.source(transition);
  const Symbol input = apartness.input(transition);
  const StateId target = apartness.target(transition);
  MAIDE_CHECK(target != Mealy::no_state && target < machine_.size());
  if (machine_.target(source, input) == target) return;
  const Symbol output = apartness.tree().output(apartness.target_node(transition));
  machine_.set_transition(source, input, output, target);
  for (const Class at : std::exchange(users_[transition], {})) check_again(at);
}

void FrontierHypothesis::check_again(Class at) {
  if (is_unchecked_[at]) return;
  is_unchecked_[at] = true;
  unchecked_.push_back(at);
}

void FrontierHypothesis::note_use(Transition transition, Class at) {
  std::vector<Class>& users = users_[transition];
  if (users.size() == users.capacity()) {  // before it grows
    std::ranges::sort(users);
    users.erase(std::unique(users.begin(), users.end()), users.end());
    users.reserve(std::max<std::size_t>(4, 2 * users.size()));
  }
  users.push_back(at);
}

// The length of a shortest word known of the class whose last output is not the hypothesis', or 0.
std::size_t FrontierHypothesis::check(Class at, const Apartness& apartness) {
  MAIDE_CHECK(apartness.classes().candidates(at).size() == 1);
  std::size_t shortest = 0;
  for (const auto& [inputs, outputs] : apartness.classes().observations(at)) {
    StateId state = apartness.classes().candidates(at).front();
    for (std::size_t i = 0; i < inputs.size(); ++i) {
      if (machine_.output(state, inputs[i]) != outputs[i]) {
        if (shortest == 0 || i + 1 < shortest) shortest = i + 1;
        break;
      }
      const auto transition = static_cast<Transition>(state * apartness.input_count() + inputs[i]);
      state = machine_.target(state, inputs[i]);
      if (apartness.basis_target(transition) == Mealy::no_state) note_use(transition, at);
    }
  }
  return shortest;
}

std::optional<Word> FrontierHypothesis::find_conflict(const Apartness& apartness) {
  struct Conflict {
    std::size_t length = 0;
    Transition transition = 0;
    std::size_t below = 0;  // of the length, what follows the transition
    Class at = FrontierClasses::none;
  };
  std::optional<Conflict> shortest;
  const FrontierClasses& classes = apartness.classes();
  std::erase_if(unchecked_, [&](Class at) {
    const std::size_t below = classes.has_members(at) ? check(at, apartness) : 0;
    is_unchecked_[at] = below > 0;
    if (below == 0) return true;
    classes.for_each_member(at, [&](Transition transition) {
      const std::size_t length = apartness.access(apartness.source(transition)).size() + 1 + below;
      if (!shortest ||
          std::pair(length, transition) < std::pair(shortest->length, shortest->transition)) {
        shortest = {length, transition, below, at};
      }
    });
    return false;
  });
  if (!shortest) return std::nullopt;
  const StateId candidate = classes.candidates(shortest->at).front();
  for (const auto& [inputs, outputs] : classes.observations(shortest->at)) {
    if (inputs.size() < shortest->below) continue;
    Word word = head(inputs, shortest->below);
    if (machine_.output_word(candidate, word) == head(outputs, shortest->below)) continue;
    word = joined(apartness.word_to(shortest->transition), word);
    MAIDE_CHECK(apartness.tree().find(ObservationTree::root, word) != ObservationTree::none);
    return word;
  }
  MAIDE_CHECK(!shortest);  // the class knows the word that it was said to
  return std::nullopt;
}

void FrontierHypothesis::check_invariants(const Apartness& apartness) const {
  MAIDE_CHECK_ALWAYS(machine_.size() == apartness.size());
  // The hypothesis answers every word as the tree does.
  const ObservationTree& tree = apartness.tree();
  std::vector<std::pair<ObservationTree::Node, StateId>> open{{ObservationTree::root, 0}};
  while (!open.empty()) {
    const auto [node, state] = open.back();
    open.pop_back();
    tree.for_each_child(node, [&, at = state](ObservationTree::Node child) {
      const Symbol input = tree.input(child);
      MAIDE_CHECK_ALWAYS(machine_.output(at, input) == tree.output(child));
      open.emplace_back(child, machine_.target(at, input));
    });
  }
  for (Transition transition = 0; transition < apartness.transition_count(); ++transition) {
    MAIDE_CHECK_ALWAYS(machine_.target(apartness.source(transition), apartness.input(transition)) ==
                       apartness.target(transition));
  }
}

}  // namespace maide
