#include "maide/learn/old_model.hpp"

#include <algorithm>
#include <map>
#include <set>

#include "maide/automata/compare.hpp"
#include "maide/automata/minimize.hpp"
#include "maide/automata/words.hpp"
#include "maide/base/error.hpp"
#include "maide/learn/adaptive_sequence.hpp"
#include "maide/learn/lsharp.hpp"
#include "maide/learn/mealy_oracle.hpp"

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
  basis_state_.resize(machine_.size());
  for (StateId state = 0; state < knowledge_->size(); ++state) {
    basis_state_[machine_.run(knowledge_->access(state))] = state;
  }
}

// States that many transitions lead to are asked for often, so they should be quick to identify.
void OldModel::find_identifying_words() {
  std::vector<Suspect> suspects;
  for (const StateId basis : basis_state_) suspects.push_back({knowledge_->node(basis), 1});
  for (StateId state = 0; state < machine_.size(); ++state) {
    for (Symbol input = 0; input < machine_.inputs().size(); ++input) {
      suspects[machine_.target(state, input)].weight += 1;
    }
  }
  const DecisionTree tree = find_adaptive_sequence(knowledge_->tree(), suspects);
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
  return to_new(knowledge_->tree().find_witness(knowledge_->node(basis_state_[left]),
                                                knowledge_->node(basis_state_[right])));
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
  std::sort(words.begin(), words.end(), [](const Word& left, const Word& right) {
    return std::pair(left.size(), left) < std::pair(right.size(), right);
  });
  return words;
}

}  // namespace maide
