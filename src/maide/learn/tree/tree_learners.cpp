#include "maide/learn/tree/tree_learners.hpp"

#include <algorithm>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "maide/automata/alphabet.hpp"
#include "maide/base/error.hpp"
#include "maide/base/invariant.hpp"
#include "maide/learn/counterexample.hpp"
#include "maide/learn/lsharp/adaptive_experiment.hpp"

namespace maide {
namespace {

constexpr Symbol unknown_output = ~Symbol{0};

// Queries asked at once: enough for any number of systems, few enough to stay in a processor's
// cache.
constexpr std::size_t words_in_batch = 4096;

}  // namespace

TreeHypothesis::TreeHypothesis(OutputOracle& oracle) : oracle_(oracle) {
  if (oracle.inputs().empty()) throw UsageError("the system has no inputs to learn from");
  access_.emplace_back();
  spanning_.push_back(no_transition);
  add_transitions();
}

// Of the newest state; they begin at the root.
void TreeHypothesis::add_transitions() {
  for (Symbol input = 0; input < oracle_.inputs().size(); ++input) {
    unsettled_.push_back(static_cast<Transition>(place_.size()));
    place_.push_back(DiscriminationTree::root);
    output_.push_back(unknown_output);
  }
}

StateId TreeHypothesis::add_state(Node parent, Word label, Transition from) {
  const auto state = static_cast<StateId>(size());
  MAIDE_CHECK(output_[from] != unknown_output && !is_spanning(from));
  tree_.add_leaf(parent, std::move(label));
  MAIDE_CHECK(tree_.state(tree_.leaf(state)) == state);
  access_.push_back(word_to(from));
  spanning_.push_back(from);
  add_transitions();
  return state;
}

Word TreeHypothesis::word_to(Transition transition) const {
  const Word& access = access_[transition / oracle_.inputs().size()];
  Word word;
  word.reserve(access.size() + 1);
  word.assign(access.begin(), access.end());
  word.push_back(static_cast<Symbol>(transition % oracle_.inputs().size()));
  return word;
}

void TreeHypothesis::put(Transition transition, Node node) {
  MAIDE_CHECK(tree_.is_leaf(node) || tree_.is_temporary(node));
  place_[transition] = node;
  if (coming_.size() <= node) coming_.resize(node + std::size_t{1});
  coming_[node].push_back(transition);
  changed_.push_back(transition);
}

std::vector<TreeHypothesis::Transition> TreeHypothesis::take_coming(Node node) {
  if (coming_.size() <= node) return {};
  return std::exchange(coming_[node], {});
}

void TreeHypothesis::settle(const RunControl& control) {
  while (!unsettled_.empty()) {
    control.check("learning");
    const std::vector<Transition> asked(
        unsettled_.begin(), unsettled_.begin() + static_cast<std::ptrdiff_t>(
                                                     std::min(words_in_batch, unsettled_.size())));
    std::vector<Query> batch;
    batch.reserve(asked.size());
    for (const Transition transition : asked) batch.push_back(question(transition));
    const std::vector<MealyAnswer> answers = oracle_.ask(batch, control);
    MAIDE_CHECK(answers.size() == asked.size());
    output_queries_ += answers.size();
    unsettled_.erase(unsettled_.begin(),
                     unsettled_.begin() + static_cast<std::ptrdiff_t>(asked.size()));
    for (std::size_t i = 0; i < asked.size(); ++i) {
      follow(asked[i], complete_outputs(answers[i], batch[i]));
    }
    Progress progress;
    progress.phase = "learning";
    progress.states = size();
    progress.words = output_queries_;
    control.report(progress);
  }
}

// The transition's word, and what is asked at its node.
Query TreeHypothesis::question(Transition transition) const {
  const std::size_t inputs = oracle_.inputs().size();
  const auto state = static_cast<StateId>(transition / inputs);
  const auto input = static_cast<Symbol>(transition % inputs);
  const Word& access = access_[state];
  const Node node = place_[transition];
  const Word& suffix = tree_.suffix(node);
  Word word;
  word.reserve(access.size() + 1 + suffix.size());
  word.assign(access.begin(), access.end());
  word.push_back(input);
  word.insert(word.end(), suffix.begin(), suffix.end());
  const DecisionTree& experiment = tree_.experiment(node);
  if (experiment.nodes.empty()) return word;
  DecisionTree query = chain(word, access_outputs(state));
  std::vector<Symbol> outputs{output_[transition]};
  if (outputs.front() == unknown_output) {
    outputs.resize(oracle_.outputs().size());
    std::iota(outputs.begin(), outputs.end(), Symbol{0});
  }
  graft(query, access.size(), outputs, experiment);
  return query;
}

Word TreeHypothesis::access_outputs(StateId state) const {
  Word outputs;
  MAIDE_CHECK(state < size());
  const std::size_t length = access_[state].size();
  for (; spanning_[state] != no_transition;
       state = static_cast<StateId>(spanning_[state] / oracle_.inputs().size())) {
    outputs.push_back(output_[spanning_[state]]);
    MAIDE_CHECK(outputs.back() != unknown_output);
  }
  MAIDE_CHECK(state == 0 && outputs.size() == length);
  return {outputs.rbegin(), outputs.rend()};
}

// The answer to the transition's question; it ends early if its output is a new one.
void TreeHypothesis::follow(Transition transition, const Word& outputs) {
  const Node node = place_[transition];
  const std::size_t prefix = access_[transition / oracle_.inputs().size()].size() + 1;
  MAIDE_CHECK(outputs.size() >= prefix);
  output_[transition] = outputs[prefix - 1];
  Node next = node;
  if (tree_.has_question(node) && outputs.size() > prefix) {
    next = tree_.child(node, std::span(outputs).subspan(prefix));
    if (next == DiscriminationTree::none) {
      next = tree_.leaf(add_state(node, tail(outputs, prefix), transition));
    }
  }
  if (tree_.is_leaf(next) || tree_.is_temporary(next)) {
    put(transition, next);
  } else {
    place_[transition] = next;
    unsettled_.push_back(transition);
  }
}

void TreeHypothesis::update() {
  MAIDE_CHECK(unsettled_.empty());
  if (machine_.size() == 0) machine_ = Mealy(oracle_.inputs(), oracle_.outputs(), 1);
  for (std::size_t i = machine_.outputs().size(); i < oracle_.outputs().size(); ++i) {
    machine_.intern_output(oracle_.outputs().name(static_cast<Symbol>(i)));
  }
  while (machine_.size() < size()) machine_.add_state();
  const std::size_t inputs = oracle_.inputs().size();
  for (const Transition transition : std::exchange(changed_, {})) {
    machine_.set_transition(static_cast<StateId>(transition / inputs),
                            static_cast<Symbol>(transition % inputs), output_[transition],
                            tree_.representative(place_[transition]));
  }
}

Word TreeHypothesis::ask_after(Word prefix, const Word& suffix, const RunControl& control) {
  const std::size_t length = prefix.size();
  ++output_queries_;
  return tail(oracle_.ask(joined(std::move(prefix), suffix), control), length);
}

bool TreeHypothesis::split(StateId state, Transition from, DiscriminationTree::Inner inner,
                           const RunControl& control) {
  Word old_label = ask_after(access_[state], inner.suffix, control);
  Word new_label = ask_after(word_to(from), inner.suffix, control);
  if (old_label == new_label) return false;
  split(state, from, std::move(inner), std::move(old_label), std::move(new_label));
  return true;
}

void TreeHypothesis::split(StateId state, Transition from, DiscriminationTree::Inner inner,
                           Word old_label, Word new_label) {
  const Node node = tree_.leaf(state);
  MAIDE_CHECK(place_[from] == node && old_label != new_label);
  const bool stay = inner.temporary;
  tree_.split(node, std::move(inner), std::move(old_label));
  go_on(node, state, add_state(node, std::move(new_label), from), stay);
}

void TreeHypothesis::go_on(Node inner, StateId state, StateId added, bool stay) {
  MAIDE_CHECK(!stay || tree_.is_temporary(inner));
  [[maybe_unused]] std::size_t spanning = 0;
  for (const Transition transition : take_coming(inner)) {
    if (transition == spanning_[state]) {
      put(transition, tree_.leaf(state));
      ++spanning;
    } else if (added != Mealy::no_state && transition == spanning_[added]) {
      put(transition, tree_.leaf(added));
      ++spanning;
    } else if (stay) {
      put(transition, inner);
    } else {
      unsettled_.push_back(transition);
    }
  }
  // Where these words lead is known: nobody is asked.
  MAIDE_CHECK(spanning == (state != 0 ? 1U : 0U) + (added != Mealy::no_state ? 1U : 0U));
}

void TreeHypothesis::split(StateId state, DiscriminationTree::Inner inner, Word label) {
  const Node node = tree_.leaf(state);
  tree_.split(node, std::move(inner), std::move(label));
  go_on(node, state, Mealy::no_state, false);
}

void TreeHypothesis::promote(Transition from) {
  Node node = place_[from];
  MAIDE_CHECK(!is_spanning(from) && (tree_.is_leaf(node) || !tree_.has_question(node)));
  if (tree_.is_leaf(node)) {
    const StateId state = tree_.state(node);
    tree_.split(node, {.suffix = {}, .temporary = true}, {});
    go_on(node, state, Mealy::no_state, true);
  }
  MAIDE_CHECK(std::ranges::count(coming_[node], from) == 1);
  std::erase(coming_[node], from);
  put(from, tree_.leaf(add_state(node, {}, from)));
}

std::optional<TreeHypothesis::Node> TreeHypothesis::find_disagreement(const Word& word,
                                                                      StateId state,
                                                                      const RunControl& control) {
  std::vector<Node> path{tree_.leaf(state)};
  while (path.back() != DiscriminationTree::root) path.push_back(tree_.parent(path.back()));
  for (std::size_t i = path.size() - 1; i > 0; --i) {
    const Node below = path[i - 1];
    if (ask_after(word, tree_.inputs_to(below), control) != tree_.label(below)) return path[i];
  }
  return std::nullopt;
}

Word TreeHypothesis::known_answer(StateId state, Symbol input, Node node) const {
  const Transition passed = transition(state, input);
  MAIDE_CHECK(output_[passed] != unknown_output);
  MAIDE_CHECK(node == DiscriminationTree::none ||
              tree_.child_towards(node, place_[passed]) != DiscriminationTree::none);
  Word answer{output_[passed]};
  if (node != DiscriminationTree::none) {
    const Word& rest = tree_.label(tree_.child_towards(node, place_[passed]));
    answer.insert(answer.end(), rest.begin(), rest.end());
  }
  return answer;
}

StateId TreeHypothesis::target_in_block(Transition transition, const RunControl& control) {
  Node node = place_[transition];
  while (!tree_.is_leaf(node)) {
    MAIDE_CHECK(tree_.is_temporary(node) && !tree_.suffix(node).empty());
    Word answer = ask_after(word_to(transition), tree_.suffix(node), control);
    Node next = tree_.child(node, answer);
    if (next == DiscriminationTree::none) {
      next = tree_.leaf(add_state(node, std::move(answer), transition));
    }
    std::erase(coming_[node], transition);
    put(transition, next);
    node = next;
  }
  return tree_.state(node);
}

void TreeHypothesis::finalise(Node block, DiscriminationTree::Inner inner) {
  MAIDE_CHECK(tree_.is_temporary(block) && !inner.temporary && tree_.block_of(block) == block);
  MAIDE_CHECK(inner.suffix.size() ==
              1 + (inner.rest == DiscriminationTree::none ? 0 : tree_.suffix(inner.rest).size()));
  Answers answers;
  tree_.for_each_leaf(block, [&](Node leaf) {
    const StateId state = tree_.state(leaf);
    answers.emplace(state, known_answer(state, inner.suffix.front(), inner.rest));
  });
  replace(block, std::move(inner), answers);
}

void TreeHypothesis::replace(Node node, DiscriminationTree::Inner inner, const Answers& answers) {
  const std::vector<Transition> coming = take_coming_below(node);
  tree_.finalise(node, std::move(inner), [&](StateId state) { return answers.at(state); });
  send_back(coming, answers, node);
}

void TreeHypothesis::lengthen(Node node, DecisionTree experiment, const Answers& answers) {
  const Node above = tree_.parent(node);
  const std::vector<Transition> coming = take_coming_below(node);
  tree_.lengthen(node, std::move(experiment), [&](StateId state) { return answers.at(state); });
  send_back(coming, answers, above);
}

std::vector<TreeHypothesis::Transition> TreeHypothesis::take_coming_below(Node node) {
  std::vector<Transition> coming;
  for (std::vector<Node> open{node}; !open.empty();) {
    const Node next = open.back();
    open.pop_back();
    const std::vector<Transition> here = take_coming(next);
    coming.insert(coming.end(), here.begin(), here.end());
    const std::span<const Node> children = tree_.children(next);
    open.insert(open.end(), children.rbegin(), children.rend());
  }
  return coming;
}

// The transitions go on at `node`, but for those by which these states were found.
void TreeHypothesis::send_back(const std::vector<Transition>& transitions, const Answers& states,
                               Node node) {
  std::vector<std::pair<Transition, StateId>> spanning;
  for (const auto& [state, answer] : states) spanning.emplace_back(spanning_[state], state);
  std::ranges::sort(spanning);
  [[maybe_unused]] std::size_t placed = states.contains(0) ? 1 : 0;  // nothing leads to state 0
  for (const Transition transition : transitions) {
    const auto found =
        std::ranges::lower_bound(spanning, transition, {}, &std::pair<Transition, StateId>::first);
    if (found != spanning.end() && found->first == transition) {
      put(transition, tree_.leaf(found->second));
      ++placed;
    } else {
      place_[transition] = node;
      unsettled_.push_back(transition);
    }
  }
  MAIDE_CHECK(placed == states.size());
}

void TreeHypothesis::check_invariants() const {
  tree_.check_invariants();
  const std::size_t inputs = oracle_.inputs().size();
  MAIDE_CHECK_ALWAYS(place_.size() == size() * inputs && output_.size() == place_.size());
  MAIDE_CHECK_ALWAYS(access_[0].empty() && spanning_[0] == no_transition);
  for (StateId state = 1; state < size(); ++state) {
    const Transition entry = spanning_[state];
    MAIDE_CHECK_ALWAYS(entry / inputs < state && access_[state] == word_to(entry));
    MAIDE_CHECK_ALWAYS(place_[entry] == tree_.leaf(state));
  }
  // Each transition waits to be sifted, or has stopped at one node, which knows it.
  std::vector<std::size_t> times(place_.size(), 0);
  for (const Transition transition : unsettled_) ++times.at(transition);
  for (Node node = 0; node < coming_.size(); ++node) {
    for (const Transition transition : coming_[node]) {
      ++times.at(transition);
      MAIDE_CHECK_ALWAYS(place_[transition] == node && output_[transition] != unknown_output);
      MAIDE_CHECK_ALWAYS(tree_.is_leaf(node) || tree_.is_temporary(node));
    }
  }
  MAIDE_CHECK_ALWAYS(std::ranges::count(times, 1U) == static_cast<std::ptrdiff_t>(times.size()));
  if (!unsettled_.empty() || !changed_.empty()) return;
  MAIDE_CHECK_ALWAYS(machine_.size() == size());
  for (Transition transition = 0; transition < place_.size(); ++transition) {
    const auto state = static_cast<StateId>(transition / inputs);
    const auto input = static_cast<Symbol>(transition % inputs);
    MAIDE_CHECK_ALWAYS(machine_.output(state, input) == output_[transition]);
    MAIDE_CHECK_ALWAYS(machine_.target(state, input) == tree_.representative(place_[transition]));
  }
}

void TreeLearner::complete(const RunControl& control) {
  states_.settle(control);
  states_.update();
}

void TreeLearner::check_invariants() const {
  states_.check_invariants();
  const DiscriminationTree& tree = states_.tree();
  MAIDE_CHECK_ALWAYS(hypothesis().size() == states_.size());
  for (StateId state = 0; state < states_.size(); ++state) {
    MAIDE_CHECK_ALWAYS(hypothesis().run(states_.access(state)) == state);
    for (auto node = tree.leaf(state); node != DiscriminationTree::none; node = tree.parent(node)) {
      MAIDE_CHECK_ALWAYS(!tree.is_temporary(node));
    }
  }
}

void TreeLearner::refine(const Word& counterexample, const RunControl& control) {
  ++counterexample_queries_;
  const Word outputs = oracle_.ask(counterexample, control);
  if (first_mismatch(hypothesis(), counterexample, outputs) == 0) {
    throw std::invalid_argument("the hypothesis agrees with the system on this word");
  }
  complete(control);  // what an interruption left
  if (!split_at_mismatch(counterexample, outputs, control)) return;
  complete(control);
  restructure(control);
  while (split_at_mismatch(counterexample, outputs, control)) complete(control);
}

bool TreeLearner::split_at_mismatch(const Word& word, const Word& outputs,
                                    const RunControl& control) {
  const std::size_t length = first_mismatch(hypothesis(), word, outputs);
  if (length == 0) return false;
  const Word cut = head(word, length);
  if (!split(cut, outputs, control)) {
    throw NondeterminismError(to_string(cut, oracle_.inputs()),
                              to_string(hypothesis().output_word(cut), oracle_.outputs()),
                              to_string(std::span(outputs).first(length), oracle_.outputs()));
  }
  return true;
}

bool TreeLearner::split_by_suffix(std::span<const StateId> states, const Word& word,
                                  Symbol last_output, bool temporary, const RunControl& control) {
  if (word.size() < 2) return false;  // an output that the machine was made from
  const Decomposition part =
      decompose(states, states_.access(), word, last_output, oracle_, control);
  counterexample_queries_ += part.output_queries;
  MAIDE_CHECK(part.position + 1 < word.size());  // so the suffix is not empty
  const Word suffix = tail(word, part.position + 1);
  const auto from = states_.transition(states[part.position], word[part.position]);
  return states_.split(states[part.position + 1], from,
                       {suffix, DiscriminationTree::none, temporary}, control);
}

// Invariant: the prefix of length `low` is sifted to the hypothesis' state. That of length `high`
// is not, but disagrees with it at node `apart`; or it is the whole word, whose last output is
// wrong.
bool KearnsVazirani::split(const Word& counterexample, std::span<const Symbol> /*outputs*/,
                           const RunControl& control) {
  const std::vector<StateId> states = states_along(hypothesis(), counterexample);
  std::size_t low = 0, high = counterexample.size();
  TreeHypothesis::Node apart = DiscriminationTree::none;
  while (high - low > 1) {
    const std::size_t middle = low + (high - low) / 2;
    const Word prefix(counterexample.begin(),
                      counterexample.begin() + static_cast<std::ptrdiff_t>(middle));
    if (const auto node = states_.find_disagreement(prefix, states[middle], control)) {
      high = middle;
      apart = *node;
    } else {
      low = middle;
    }
  }
  MAIDE_CHECK(low + 1 == high || counterexample.size() == 1);
  MAIDE_CHECK((apart == DiscriminationTree::none) == (high == counterexample.size()));
  DiscriminationTree::Inner inner{{counterexample[low]}, apart};
  if (apart != DiscriminationTree::none) {
    const Word& rest = states_.tree().suffix(apart);
    inner.suffix.insert(inner.suffix.end(), rest.begin(), rest.end());
  }
  // The prefix and the state agree on all that was asked on the way to the leaf.
  const DiscriminationTree& tree = states_.tree();
  for (auto node = tree.leaf(states[low]); node != DiscriminationTree::none;
       node = tree.parent(node)) {
    if (tree.suffix(node) == inner.suffix) return false;
  }
  Word label = states_.known_answer(states[low], counterexample[low], apart);
  states_.split(states[low], std::move(inner), std::move(label));
  return true;
}

bool ObservationPack::split(const Word& counterexample, std::span<const Symbol> outputs,
                            const RunControl& control) {
  return split_by_suffix(states_along(hypothesis(), counterexample), counterexample,
                         outputs[counterexample.size() - 1], false, control);
}

}  // namespace maide
