#include "maide/learn/lsharp/old_model.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <span>
#include <string>

#include "maide/automata/alphabet.hpp"
#include "maide/automata/compare.hpp"
#include "maide/automata/minimize.hpp"
#include "maide/base/error.hpp"
#include "maide/base/invariant.hpp"
#include "maide/learn/lsharp/adaptive_experiment.hpp"
#include "maide/learn/lsharp/lsharp.hpp"
#include "maide/learn/oracle/mealy_oracle.hpp"

namespace maide {

Mealy restrict_inputs(const Mealy& machine, const Alphabet& inputs) {
  std::vector<std::string> common;
  for (const std::string& name : inputs.names()) {
    if (machine.inputs().find(name)) common.push_back(name);
  }
  Mealy result(Alphabet(std::span<const std::string>(common)), machine.outputs(), machine.size());
  result.set_initial(machine.initial());
  for (Symbol input = 0; input < common.size(); ++input) {
    const Symbol old = machine.inputs().at(common[input]);
    for (StateId state = 0; state < machine.size(); ++state) {
      result.set_transition(state, input, machine.output(state, old), machine.target(state, old));
    }
  }
  return result;
}

OldModel::OldModel(const Mealy& machine, const Alphabet& inputs, const RunControl& control)
    : machine_(restrict_inputs(machine, inputs)), to_old_(inputs.size(), unknown) {
  for (Symbol input = 0; input < machine_.inputs().size(); ++input) {
    const Symbol now = inputs.at(machine_.inputs().name(input));
    to_old_[now] = input;
    to_new_.push_back(now);
  }
  if (to_new_.empty()) {
    machine_ = Mealy(Alphabet(), machine.outputs(), 1);
    identifying_.resize(1);
    return;
  }
  machine_ = minimize(machine_);
  learn_itself(control);
  find_identifying_words();
}

OldModel::~OldModel() = default;
OldModel::OldModel(OldModel&&) noexcept = default;
OldModel& OldModel::operator=(OldModel&&) noexcept = default;

void OldModel::learn_itself(const RunControl& control) {
  MealyOracle oracle(machine_);
  LSharp learner(oracle);
  learner.start(control);
  while (const auto word = find_distinguishing_word(learner.hypothesis(), machine_)) {
    learner.refine(*word, control);
  }
  knowledge_ = std::make_unique<Apartness>(learner.knowledge());
  MAIDE_CHECK(knowledge_->size() == machine_.size());  // it is minimal
  basis_state_.resize(machine_.size());
  for (StateId state = 0; state < knowledge_->size(); ++state) {
    basis_state_[machine_.run(knowledge_->access(state))] = state;
  }
}

// States that many transitions lead to are asked for often, so they should be quick to identify.
void OldModel::find_identifying_words() {
  std::vector<WeightedNode> candidates;
  for (const StateId basis : basis_state_) candidates.push_back({knowledge_->node(basis), 1});
  for (StateId state = 0; state < machine_.size(); ++state) {
    for (Symbol input = 0; input < machine_.inputs().size(); ++input) {
      candidates[machine_.target(state, input)].weight += 1;
    }
  }
  const DecisionTree tree = find_adaptive_sequence(knowledge_->tree(), candidates);
  MealyOracle oracle(machine_);
  for (StateId state = 0; state < machine_.size(); ++state) {
    machine_.set_initial(state);
    identifying_.emplace_back();
    if (tree.nodes.empty()) continue;
    const std::vector<Query> query{tree};
    identifying_.back() = to_new(static_cast<OutputOracle&>(oracle).ask(query)[0].inputs);
  }
  machine_.set_initial(0);
}

Word OldModel::to_new(const Word& word) const {
  Word result;
  for (const Symbol input : word) result.push_back(to_new_[input]);
  return result;
}

Word OldModel::separating_word(StateId left, StateId right) const {
  MAIDE_CHECK(left != right && left < size() && right < size());
  Word word = to_new(knowledge_->tree().find_witness(knowledge_->node(basis_state_[left]),
                                                     knowledge_->node(basis_state_[right])));
  MAIDE_CHECK(!word.empty());
  return word;
}

std::vector<Word> OldModel::test_words() const {
  std::vector<Word> words;
  if (size() < 2) return words;
  // States that answer their identifying word alike.
  std::map<std::pair<Word, Word>, std::vector<StateId>> alike;
  for (StateId state = 0; state < size(); ++state) {
    Word outputs;
    StateId now = state;
    for (const Symbol input : identifying_[state]) {
      outputs.push_back(output(now, input));
      now = target(now, input);
    }
    alike[{identifying_[state], outputs}].push_back(state);
  }
  for (const auto& [answer, states] : alike) {
    for (const StateId state : states) {
      const Word access = to_new(knowledge_->access(basis_state_[state]));
      std::set<Word> suffixes{answer.first};
      for (const StateId other : states) {
        if (other != state) suffixes.insert(separating_word(state, other));
      }
      for (const Word& suffix : suffixes) words.push_back(joined(access, suffix));
    }
  }
  std::ranges::sort(words, [](const Word& left, const Word& right) {
    return std::pair(left.size(), left) < std::pair(right.size(), right);
  });
  return words;
}

namespace {

// Enough to tell states apart; more would make one difference count at every state above it.
constexpr std::size_t most_nodes = 256;
constexpr std::size_t never = ~std::size_t{0};

}  // namespace

void StateMatching::look_below(const ObservationTree& tree, ObservationTree::Node node) {
  below_.assign(1, {});
  std::vector<ObservationTree::Node> nodes{node};
  for (std::size_t next = 0; next < nodes.size() && nodes.size() < most_nodes; ++next) {
    tree.for_each_child(nodes[next], [&](ObservationTree::Node child) {
      if (!old_.has_input(tree.input(child))) return;
      below_.push_back({next, tree.input(child), old_output_[tree.output(child)]});
      nodes.push_back(child);
    });
  }
}

std::size_t StateMatching::count_contradictions(StateId old_state, std::size_t limit) {
  std::size_t count = 0;
  reached_.resize(below_.size());
  reached_[0] = old_state;
  for (std::size_t i = 1; i < below_.size() && count < limit; ++i) {
    const Seen& edge = below_[i];
    MAIDE_CHECK(edge.parent < i);  // so its state is reached already
    const StateId from = reached_[edge.parent];
    if (old_.output(from, edge.input) != edge.output) ++count;
    reached_[i] = old_.target(from, edge.input);
  }
  return count;
}

// The state with the fewest contradictions; of several, `first`, or else the one of least number.
StateId StateMatching::find_best(StateId first) {
  MAIDE_CHECK(first < old_.size());
  StateId best = first;
  std::size_t least = count_contradictions(first, below_.size() + 1);
  for (StateId state = 0; state < old_.size() && least > 0; ++state) {
    const std::size_t count = count_contradictions(state, least);
    if (count >= least) continue;
    least = count;
    best = state;
  }
  return best;
}

// What the match of the state before a new one says.
StateId StateMatching::guess(const Apartness& apartness, StateId state) const {
  StateId before = 0;
  Apartness::Transition last = 0;
  if (state == 0) return old_.initial();
  for (const Symbol input : apartness.access(state)) {
    last = static_cast<Apartness::Transition>(before * apartness.input_count() + input);
    before = apartness.basis_target(last);
    MAIDE_CHECK(before <= state);
  }
  MAIDE_CHECK(before == state);
  const StateId target = expected(apartness, last);
  return target == none ? old_.initial() : target;
}

void StateMatching::update(const Apartness& apartness, const Alphabet& outputs) {
  while (old_output_.size() < outputs.size()) {
    const auto known = old_.outputs().find(outputs.name(static_cast<Symbol>(old_output_.size())));
    old_output_.push_back(known.value_or(none));
  }
  const std::size_t known = apartness.tree().size();
  for (StateId state = 0; state < apartness.size(); ++state) {
    if (state == match_.size()) {
      match_.push_back(guess(apartness, state));
      next_look_.push_back(0);
    }
    if (known < next_look_[state]) continue;
    look_below(apartness.tree(), apartness.node(state));
    match_[state] = find_best(match_[state]);
    MAIDE_CHECK(match_[state] < old_.size());
    next_look_[state] = below_.size() < most_nodes ? known + known / 16 : never;
  }
  matched_by_.assign(old_.size(), none);
  for (StateId state = 0; state < match_.size(); ++state) {
    if (matched_by_[match_[state]] == none) matched_by_[match_[state]] = state;
  }
}

StateId StateMatching::expected(const Apartness& apartness,
                                Apartness::Transition transition) const {
  const Symbol input = apartness.input(transition);
  if (!old_.has_input(input)) return none;
  return old_.target(match_[apartness.source(transition)], input);
}

bool StateMatching::agrees(const Apartness& apartness, Apartness::Transition transition,
                           Symbol output) const {
  const Symbol input = apartness.input(transition);
  return old_.has_input(input) && output < old_output_.size() &&
         old_.output(match_[apartness.source(transition)], input) == old_output_[output];
}

}  // namespace maide
