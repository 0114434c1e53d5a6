#include "maide/learn/discrimination_tree.hpp"

#include <utility>

#include "maide/base/error.hpp"

namespace maide {
namespace {

constexpr Symbol unknown_output = ~Symbol{0};

Word tail(const Word& word, std::size_t from) {
  return {word.begin() + static_cast<std::ptrdiff_t>(from), word.end()};
}

Word joined(Word word, const Word& suffix) {
  word.insert(word.end(), suffix.begin(), suffix.end());
  return word;
}

}  // namespace

DiscriminationTree::DiscriminationTree(OutputOracle& oracle) : oracle_(oracle) {
  if (oracle.inputs().empty()) throw UsageError("the system has no inputs to learn from");
  add_leaf(none, add_state({}, none));
}

DiscriminationTree::Node DiscriminationTree::add_leaf(Node parent, StateId state) {
  const auto node = static_cast<Node>(nodes_.size());
  nodes_.push_back({parent, {}, {}, {}});
  state_.push_back(state);
  leaf_[state] = node;
  return node;
}

// Its transitions begin at the root.
StateId DiscriminationTree::add_state(Word access, Transition from) {
  const auto state = static_cast<StateId>(access_.size());
  access_.push_back(std::move(access));
  spanning_.push_back(from);
  leaf_.push_back(none);
  for (Symbol input = 0; input < oracle_.inputs().size(); ++input) {
    unsettled_.push_back(static_cast<Transition>(place_.size()));
    place_.push_back(root);
    output_.push_back(unknown_output);
  }
  return state;
}

Word DiscriminationTree::word_to(Transition transition) const {
  Word word = access_[transition / oracle_.inputs().size()];
  word.push_back(static_cast<Symbol>(transition % oracle_.inputs().size()));
  return word;
}

void DiscriminationTree::settle(const RunControl& control) {
  while (!unsettled_.empty()) {
    control.check("learning");
    std::vector<Query> batch;
    std::vector<Transition> asked;
    for (const Transition transition : unsettled_) {
      const Inner& node = nodes_[place_[transition]];
      if (node.suffix.empty() && output_[transition] != unknown_output) continue;
      batch.emplace_back(joined(word_to(transition), node.suffix));
      asked.push_back(transition);
    }
    const std::vector<MealyAnswer> answers = oracle_.ask(batch, control);
    output_queries_ += answers.size();
    unsettled_.clear();
    for (std::size_t i = 0; i < asked.size(); ++i) {
      const Word& outputs = complete_outputs(answers[i], std::get<Word>(batch[i]));
      const std::size_t access = access_[asked[i] / oracle_.inputs().size()].size();
      follow(asked[i], outputs, access + 1);
    }
    Progress progress;
    progress.phase = "learning";
    progress.states = size();
    progress.words = output_queries_;
    control.report(progress);
  }
}

// The answer to the word that leads to the transition's target, of length `prefix`, and the suffix
// of its node.
void DiscriminationTree::follow(Transition transition, const Word& outputs, std::size_t prefix) {
  output_[transition] = outputs[prefix - 1];
  const Node node = place_[transition];
  if (!nodes_[node].suffix.empty()) {
    Word value = tail(outputs, prefix);
    const auto found = nodes_[node].branches.find(value);
    if (found == nodes_[node].branches.end()) {
      const Node leaf = add_leaf(node, add_state(word_to(transition), transition));
      nodes_[node].branches.emplace(std::move(value), leaf);
      place_[transition] = leaf;
    } else {
      place_[transition] = found->second;
    }
  }
  Inner& place = nodes_[place_[transition]];
  if (place.suffix.empty()) {
    place.coming.push_back(transition);
  } else {
    unsettled_.push_back(transition);
  }
}

bool DiscriminationTree::split(StateId state, Transition from, const Word& suffix,
                               const RunControl& control) {
  const std::vector<Query> batch{joined(access_[state], suffix), joined(word_to(from), suffix)};
  const std::vector<MealyAnswer> answers = oracle_.ask(batch, control);
  output_queries_ += answers.size();
  Word old_value =
      tail(complete_outputs(answers[0], std::get<Word>(batch[0])), access_[state].size());
  Word new_value = tail(complete_outputs(answers[1], std::get<Word>(batch[1])),
                        std::get<Word>(batch[1]).size() - suffix.size());
  if (old_value == new_value) return false;
  const Node node = leaf_[state];
  const Node old_leaf = add_leaf(node, state);
  const Node new_leaf = add_leaf(node, add_state(word_to(from), from));
  Inner& inner = nodes_[node];
  inner.suffix = suffix;
  inner.branches.emplace(std::move(old_value), old_leaf);
  inner.branches.emplace(std::move(new_value), new_leaf);
  for (const Transition transition : std::exchange(inner.coming, {})) {
    if (transition == from || transition == spanning_[state]) {
      place_[transition] = transition == from ? new_leaf : old_leaf;
      nodes_[place_[transition]].coming.push_back(transition);
    } else {
      unsettled_.push_back(transition);
    }
  }
  return true;
}

}  // namespace maide
