#include "maide/learn/observation_pack.hpp"

#include <stdexcept>

#include "maide/base/error.hpp"
#include "maide/learn/counterexample.hpp"

namespace maide {

void ObservationPack::start(const RunControl& control) {
  tree_.settle(control);
  make_hypothesis();
}

// States are numbered breadth first.
void ObservationPack::make_hypothesis() {
  const std::size_t inputs = oracle_.inputs().size();
  hypothesis_ = Mealy(oracle_.inputs(), oracle_.outputs(), tree_.size());
  tree_state_.assign(1, 0);
  access_.clear();
  std::vector<StateId> number(tree_.size(), Mealy::no_state);
  number[0] = 0;
  for (StateId state = 0; state < tree_state_.size(); ++state) {
    access_.push_back(tree_.access(tree_state_[state]));
    for (Symbol input = 0; input < inputs; ++input) {
      const auto transition =
          static_cast<DiscriminationTree::Transition>(tree_state_[state] * inputs + input);
      const StateId target = tree_.target(transition);
      if (number[target] == Mealy::no_state) {
        number[target] = static_cast<StateId>(tree_state_.size());
        tree_state_.push_back(target);
      }
      hypothesis_.set_transition(state, input, tree_.output(transition), number[target]);
    }
  }
}

void ObservationPack::refine(const Word& counterexample, const RunControl& control) {
  ++counterexample_queries_;
  const Word outputs = oracle_.ask(counterexample, control);
  std::size_t length = first_mismatch(hypothesis_, counterexample, outputs);
  if (length == 0) {
    throw std::invalid_argument("the hypothesis agrees with the system on this word");
  }
  tree_.settle(control);  // what an interruption left
  make_hypothesis();
  length = first_mismatch(hypothesis_, counterexample, outputs);
  while (length != 0) {
    const Word cut(counterexample.begin(),
                   counterexample.begin() + static_cast<std::ptrdiff_t>(length));
    const Decomposition part =
        decompose(hypothesis_, access_, cut, outputs[length - 1], oracle_, control);
    counterexample_queries_ += part.output_queries;
    const auto suffix = cut.begin() + static_cast<std::ptrdiff_t>(part.position) + 1;
    const StateId source = hypothesis_.run(std::span(cut).first(part.position));
    const StateId target = hypothesis_.target(source, cut[part.position]);
    const auto transition = static_cast<DiscriminationTree::Transition>(
        tree_state_[source] * oracle_.inputs().size() + cut[part.position]);
    // The suffix tells them apart, unless the system answers now one way, now another.
    if (!tree_.split(tree_state_[target], transition, Word(suffix, cut.end()), control)) {
      throw NondeterminismError(to_string(cut, oracle_.inputs()),
                                to_string(hypothesis_.output_word(cut), oracle_.outputs()),
                                to_string(std::span(outputs).first(length), oracle_.outputs()));
    }
    tree_.settle(control);
    make_hypothesis();
    length = first_mismatch(hypothesis_, counterexample, outputs);
  }
}

}  // namespace maide
