#include "maide/learn/tree/adt.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "maide/automata/alphabet.hpp"
#include "maide/base/invariant.hpp"
#include "maide/learn/counterexample.hpp"
#include "maide/learn/lsharp/adaptive_experiment.hpp"

namespace maide {
namespace {

using States = std::vector<StateId>;
using Parts = std::map<Symbol, States>;  // where they go, by output

// States that may still be meant, at worst.
std::size_t largest(const Parts& parts) {
  std::size_t result = 0;
  for (const auto& [output, states] : parts) result = std::max(result, states.size());
  return result;
}

class Search {
 public:
  Search(const Mealy& machine, std::size_t effort) : machine_(machine), effort_(effort) {}

  std::optional<DecisionTree> find(const States& states) {
    MAIDE_CHECK(states.size() > 1);
    std::vector<Place> queue{{states, {}, {}}};
    std::set<States> seen{sorted(states)};
    for (std::size_t next = 0; next < queue.size(); ++next) {
      if (effort_ == 0) return std::nullopt;
      --effort_;
      std::vector<Split> splits;
      for (Symbol input = 0; input < machine_.inputs().size(); ++input) {
        auto parts = part(queue[next].states, input);
        if (!parts) continue;
        if (parts->size() > 1) {
          splits.push_back({largest(*parts), input, std::move(*parts)});
        } else if (seen.insert(sorted(parts->begin()->second)).second) {
          Place place{std::move(parts->begin()->second), queue[next].word, queue[next].outputs};
          place.word.push_back(input);
          place.outputs.push_back(parts->begin()->first);
          queue.push_back(std::move(place));
        }
      }
      std::ranges::stable_sort(splits, {}, &Split::largest_part);
      for (const Split& split : splits) {
        if (auto found = find_below(queue[next], split)) return found;
      }
    }
    return std::nullopt;
  }

 private:
  // What a word that parts nothing leads to.
  struct Place {
    States states;
    Word word, outputs;
  };
  struct Split {
    std::size_t largest_part;
    Symbol input;
    Parts parts;
  };

  static States sorted(States states) {
    std::ranges::sort(states);
    return states;
  }

  // Nothing if two of the states become one.
  std::optional<Parts> part(const States& states, Symbol input) const {
    Parts parts;
    for (const StateId state : states) {
      States& targets = parts[machine_.output(state, input)];
      const StateId target = machine_.target(state, input);
      if (std::ranges::find(targets, target) != targets.end()) return std::nullopt;
      targets.push_back(target);
    }
    MAIDE_CHECK(!parts.empty() && largest(parts) <= states.size());
    return parts;
  }

  std::optional<DecisionTree> find_below(const Place& place, const Split& split) {
    Word word = place.word;
    word.push_back(split.input);
    DecisionTree result = chain(word, place.outputs);
    for (const auto& [output, states] : split.parts) {
      if (states.size() == 1) continue;
      const std::optional<DecisionTree> below = find(states);
      if (!below) return std::nullopt;
      graft(result, place.word.size(), output, *below);
    }
    return result;
  }

  const Mealy& machine_;
  std::size_t effort_;  // sets of states that may still be looked at
};

}  // namespace

std::optional<DecisionTree> find_distinguishing_sequence(const Mealy& machine,
                                                         const std::vector<StateId>& states,
                                                         std::size_t effort) {
  return Search(machine, effort).find(states);
}

namespace {

// Inputs in an experiment, and states that one is looked for: every query carries its experiment.
constexpr std::size_t largest_experiment = 200;
constexpr std::size_t most_states = 100;

// Sets of states to look at for a distinguishing sequence; more finds no more.
constexpr std::size_t effort = 50;

// How many resets must be spared for each query that sparing them costs. Set by the sum over the
// models of bench_learn, which hardly changes between 1.1 and 1.5.
constexpr double least_gain = 1.25;

Word outputs_along(const ObservationTree& tree, ObservationTree::Node node, const Word& word) {
  Word outputs;
  for (const Symbol input : word) {
    node = tree.child(node, input);
    MAIDE_CHECK(node != ObservationTree::none);
    outputs.push_back(tree.output(node));
  }
  return outputs;
}

bool are_all_alike(const TreeHypothesis::Answers& answers) {
  return std::ranges::all_of(
      answers, [&](const auto& answer) { return answer.second == answers.begin()->second; });
}

}  // namespace

void Adt::complete(const RunControl& control) {
  while (true) {
    states_.settle(control);
    states_.update();
    if (waiting_ != DiscriminationTree::none) {
      place_waiting(control);
    } else if (!contradictions_.empty()) {
      const Word word = contradictions_.back();
      if (!split_at_mismatch(word, oracle_.ask(word, control), control)) contradictions_.pop_back();
    } else {
      return;
    }
  }
}

bool Adt::split(const Word& counterexample, std::span<const Symbol> outputs,
                const RunControl& control) {
  if (counterexample.size() < 2) return false;  // an output that the machine was made from
  const std::vector<StateId> states = states_along(hypothesis(), counterexample);
  const std::size_t position = decompose(states, states_.access(), counterexample,
                                         outputs[counterexample.size() - 1], oracle_, control)
                                   .position;
  const StateId state = states[position + 1];
  const auto from = states_.transition(states[position], counterexample[position]);
  const DiscriminationTree& tree = states_.tree();
  const bool is_root = tree.leaf(state) == DiscriminationTree::root;
  const Word before = is_root ? Word{} : tree.inputs_to(tree.leaf(state));
  if (split_by_known_word(state, from, before)) return true;
  const Word suffix = tail(counterexample, position + 1);
  oracle_.ask(joined(states_.access(state), suffix), control);
  oracle_.ask(joined(states_.word_to(from), suffix), control);
  return split_by_known_word(state, from, {});
}

// Splits the leaf of `state` by a shortest word that is known to tell it from word_to(from) after
// `before`; false if there is none. The experiment above goes on with the word if it comes after
// that; else the word is an experiment of its own, to begin with.
bool Adt::split_by_known_word(StateId state, TreeHypothesis::Transition from, const Word& before) {
  const ObservationTree& known = known_.tree();
  const auto old_node = known.find(ObservationTree::root, joined(states_.access(state), before));
  const auto new_node = known.find(ObservationTree::root, joined(states_.word_to(from), before));
  if (old_node == ObservationTree::none || new_node == ObservationTree::none) return false;
  const Word word = known.find_witness(old_node, new_node);
  if (word.empty()) return false;
  MAIDE_CHECK(waiting_ == DiscriminationTree::none);
  const DiscriminationTree& tree = states_.tree();
  const Node node = tree.leaf(state);
  const Word old_answer = outputs_along(known, old_node, word);
  const Word new_answer = outputs_along(known, new_node, word);
  DecisionTree experiment = chain(word, old_answer);
  states_.split(
      state, from,
      {.suffix = {}, .temporary = node != DiscriminationTree::root, .experiment = experiment},
      old_answer, new_answer);
  if (node == DiscriminationTree::root) return true;
  if (before.empty()) {
    waiting_ = node;
    return true;
  }
  const Word label = tree.label(node);
  DecisionTree above = tree.experiment(tree.parent(node));
  maide::lengthen(above, label, experiment);
  states_.lengthen(node, std::move(above),
                   {{state, joined(label, old_answer)},
                    {tree.state(tree.child(node, new_answer)), joined(label, new_answer)}});
  return true;
}

// The transitions of the new state are known, those to the node wait there.
void Adt::place_waiting(const RunControl& control) {
  const DiscriminationTree& tree = states_.tree();
  MAIDE_CHECK(tree.is_temporary(waiting_) && tree.children(waiting_).size() == 2);
  if (!lengthen_over(waiting_, control)) {
    Answers answers;
    for (const StateId state : tree.states_below(waiting_)) {
      answers[state] = tree.label(tree.child_towards(waiting_, tree.leaf(state)));
    }
    states_.replace(waiting_, {.suffix = {}, .experiment = tree.experiment(waiting_)}, answers);
  }
  waiting_ = DiscriminationTree::none;
}

// From the root down; what was restructured is left alone below.
void Adt::restructure(const RunControl& control) {
  const DiscriminationTree& tree = states_.tree();
  std::vector<Node> queue{DiscriminationTree::root};
  for (std::size_t next = 0; next < queue.size(); ++next) {
    const Node node = queue[next];
    if (tree.is_leaf(node)) continue;
    const std::size_t states = tree.states_below(node).size();
    if (tried_.size() <= node) tried_.resize(node + std::size_t{1});
    if (states <= most_states && std::exchange(tried_[node], states) != states) {
      if (node != DiscriminationTree::root && lengthen_over(node, control)) continue;
      if (is_worth_replacing(node) && replace_below(node, control)) continue;
    }
    queue.insert(queue.end(), tree.children(node).begin(), tree.children(node).end());
  }
  complete(control);
}

// The experiment above a node goes on with a sequence that tells the states below apart, instead of
// a reset; false if none was found.
bool Adt::lengthen_over(Node node, const RunControl& control) {
  const DiscriminationTree& tree = states_.tree();
  const Node above = tree.parent(node);
  MAIDE_CHECK(above != DiscriminationTree::none && !tree.experiment(above).nodes.empty());
  if (tree.experiment(above).nodes.size() > largest_experiment) return false;
  const std::vector<StateId> states = tree.states_below(node);
  const Word before = tree.inputs_to(node);
  std::vector<StateId> reached;
  for (const StateId state : states) {
    const StateId target = hypothesis().run(state, before);
    if (std::ranges::find(reached, target) != reached.end()) return false;
    reached.push_back(target);
  }
  const auto sequence = find_distinguishing_sequence(hypothesis(), reached, effort);
  if (!sequence) return false;
  const Word label = tree.label(node);
  Answers answers = ask_states(states, before, label, *sequence, control);
  if (are_all_alike(answers)) return false;
  for (auto& [state, answer] : answers) answer = joined(label, answer);
  DecisionTree experiment = tree.experiment(above);
  maide::lengthen(experiment, label, *sequence);
  states_.lengthen(node, std::move(experiment), answers);
  return true;
}

// The states below a node are told apart by a sequence instead of by what is there; false if none
// was found.
bool Adt::replace_below(Node node, const RunControl& control) {
  const std::vector<StateId> states = states_.tree().states_below(node);
  auto sequence = find_distinguishing_sequence(hypothesis(), states, effort);
  if (!sequence) return false;
  const Answers answers = ask_states(states, {}, {}, *sequence, control);
  if (are_all_alike(answers)) return false;
  states_.replace(node, {.suffix = {}, .experiment = std::move(*sequence)}, answers);
  return true;
}

// As many transitions as have come below the node are expected to come again.
bool Adt::is_worth_replacing(Node node) const {
  const DiscriminationTree& tree = states_.tree();
  std::size_t spared = 0, cost = 0;
  tree.for_each_leaf(node, [&](Node leaf) {
    const std::size_t coming = states_.coming_count(leaf);
    cost += coming + 1;
    for (Node at = tree.parent(leaf); at != node; at = tree.parent(at)) spared += coming;
  });
  return static_cast<double>(spared) >= least_gain * static_cast<double>(cost);
}

// What the system answers to the sequence from each state after `before`, which gets `label`. One
// output query a state; where the hypothesis is wrong, the word is kept.
Adt::Answers Adt::ask_states(const std::vector<StateId>& states, const Word& before,
                             const Word& label, const DecisionTree& sequence,
                             const RunControl& control) {
  std::vector<Query> batch;
  for (const StateId state : states) {
    const Word outputs = joined(states_.access_outputs(state), label);
    DecisionTree query = chain(joined(states_.access(state), before), outputs);
    maide::lengthen(query, outputs, sequence);
    batch.emplace_back(std::move(query));
  }
  const std::vector<MealyAnswer> answers = oracle_.ask(batch, control);
  MAIDE_CHECK(answers.size() == states.size());
  Answers result;
  for (std::size_t i = 0; i < batch.size(); ++i) {
    const Word& outputs = complete_outputs(answers[i], batch[i]);
    const std::size_t length = states_.access(states[i]).size() + before.size();
    result[states[i]] = tail(outputs, length);
    if (first_mismatch(hypothesis(), answers[i].inputs, outputs) > 0) {
      contradictions_.push_back(answers[i].inputs);
    }
  }
  return result;
}

}  // namespace maide
