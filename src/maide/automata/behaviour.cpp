#include "maide/automata/behaviour.hpp"

#include <algorithm>
#include <functional>
#include <iterator>
#include <unordered_map>

#include "maide/automata/partition.hpp"
#include "maide/base/invariant.hpp"
#include "maide/base/text.hpp"

namespace maide {

// ---- Sets of states ----

StateSets::Id StateSets::intern(Set set) {
  MAIDE_CHECK(!set.empty() && set.back() < automaton_.size());
  MAIDE_CHECK(std::ranges::adjacent_find(set, std::greater_equal<>()) == set.end());
  const auto [place, is_new] = numbers_.try_emplace(set, static_cast<Id>(sets_.size()));
  if (is_new) sets_.push_back(std::move(set));
  return place->second;
}

ActionStatus StateSets::status(Id id, Action::Kind kind, Symbol symbol) const {
  ActionStatus status;
  if (symbol == no_symbol) {
    status.refused = true;
    status.is_known = false;
    return status;
  }
  for (const StateId state : sets_[id]) {
    bool enabled = false;
    bool untried = kind == Action::Kind::input && automaton_.is_unexplored(state, symbol);
    for (const auto& transition : transitions(state, {kind, symbol})) {
      (transition.absorbed ? untried : enabled) = true;
    }
    status.enabled |= enabled;
    status.untried |= untried;
    status.refused |= !enabled && !untried;
  }
  return status;
}

std::pair<bool, bool> StateSets::quiescence(Id id) const {
  std::pair<bool, bool> result{false, false};
  for (const StateId state : sets_[id]) {
    (automaton_.is_quiescent(state) ? result.first : result.second) = true;
  }
  return result;
}

StateSets::Id StateSets::successor(Id id, Action action) {
  Set next;
  for (const StateId state : sets_[id]) {
    for (const auto& transition : transitions(state, action)) {
      if (!transition.absorbed) next.push_back(transition.target);
    }
  }
  std::ranges::sort(next);
  next.erase(std::unique(next.begin(), next.end()), next.end());
  return intern(std::move(next));
}

std::span<const InterfaceAutomaton::Transition> StateSets::transitions(StateId state,
                                                                       Action action) const {
  const auto all = automaton_.transitions(state);
  const auto begin =
      std::lower_bound(all.begin(), all.end(), action,
                       [](const auto& entry, Action wanted) { return entry.action < wanted; });
  auto end = begin;
  while (end != all.end() && end->action == action) ++end;
  // An automaton keeps the transitions of a state in order, or the search above misses some.
  MAIDE_CHECK(begin == all.begin() || std::prev(begin)->action < action);
  MAIDE_CHECK(std::none_of(end, all.end(), [&](const auto& way) { return way.action == action; }));
  return {begin, end};
}

namespace {

// ---- Reading models ----

// All names of both alphabets, left's first, with the symbols in each.
struct JointSymbol {
  std::string name;
  Symbol left, right;  // StateSets::no_symbol where there is none
};

std::vector<JointSymbol> join_alphabets(const Alphabet& left, const Alphabet& right) {
  std::vector<JointSymbol> symbols;
  for (Symbol symbol = 0; symbol < left.size(); ++symbol) {
    const std::string& name = left.name(symbol);
    symbols.push_back({name, symbol, right.find(name).value_or(StateSets::no_symbol)});
  }
  for (Symbol symbol = 0; symbol < right.size(); ++symbol) {
    if (left.find(right.name(symbol))) continue;
    symbols.push_back({right.name(symbol), StateSets::no_symbol, symbol});
  }
  return symbols;
}

// Walks from the initial state. `answer(state, question)` has targets in the model's numbers, which
// may be new ones.
template <typename Read>
Behaviour walk(StateId initial, std::size_t questions, const RunControl& control, Read&& answer) {
  Behaviour result;
  std::unordered_map<StateId, StateId> numbers{{initial, 0}};
  result.origins.push_back(initial);
  for (std::size_t state = 0; state < result.origins.size(); ++state) {
    if (state % comparison_check == 0) control.check("the comparison");
    for (std::size_t question = 0; question < questions; ++question) {
      Answer read = answer(result.origins[state], question);
      for (Answer::Way& way : read.ways) {
        const auto [place, is_new] =
            numbers.try_emplace(way.target, static_cast<StateId>(result.origins.size()));
        if (is_new) result.origins.push_back(way.target);
        way.target = place->second;
      }
      result.answers.push_back(std::move(read));
    }
  }
  result.size = result.origins.size();
  return result;
}

// What is compared of a state; the blocks of the targets are those of `partition`.
std::vector<std::uint32_t> signature(const BehaviourPair& pair, const Partition& partition,
                                     Partition::Element element) {
  const bool is_left = element < pair.left.size;
  const std::size_t shift = is_left ? 0 : pair.left.size;
  std::vector<std::uint32_t> result;
  for (std::size_t question = 0; question < pair.questions.size(); ++question) {
    if (!pair.is_common[question]) continue;
    const auto state = static_cast<StateId>(element - shift);
    const Answer& answer =
        is_left ? pair.left_answer(state, question) : pair.right_answer(state, question);
    result.push_back(answer.text);
    for (const Answer::Way& way : answer.ways) {
      result.push_back(way.label);
      result.push_back(partition.block_of(static_cast<Partition::Element>(way.target + shift)));
    }
  }
  return result;
}

// Makes the states of each block one. Blocks of both behaviours get the same number in `blocks`.
Behaviour merge(const Behaviour& whole, std::size_t questions, const Partition& partition,
                std::size_t shift, std::vector<Partition::Block>& blocks) {
  Behaviour result;
  std::unordered_map<Partition::Block, StateId> numbers;
  std::vector<StateId> number(whole.size);
  for (StateId state = 0; state < whole.size; ++state) {
    const Partition::Block block =
        partition.block_of(static_cast<Partition::Element>(state + shift));
    const auto [place, is_new] =
        numbers.try_emplace(block, static_cast<StateId>(result.origins.size()));
    number[state] = place->second;
    if (!is_new) continue;
    result.origins.push_back(whole.origins[state]);
    blocks.push_back(block);
    for (std::size_t question = 0; question < questions; ++question) {
      result.answers.push_back(whole.answers[std::size_t{state} * questions + question]);
    }
  }
  for (Answer& answer : result.answers) {
    for (Answer::Way& way : answer.ways) way.target = number[way.target];
  }
  result.initial = number[whole.initial];
  result.size = result.origins.size();
  return result;
}

// Equivalent states of one behaviour become one, and those of both become partners.
void merge_equivalent(BehaviourPair& pair, const RunControl& control) {
  Partition partition(pair.left.size + pair.right.size);
  std::size_t calls = 0;
  refine_by_signatures(partition, [&](Partition::Element element) {
    if (++calls % comparison_check == 0) control.check("the comparison");
    return signature(pair, partition, element);
  });
  std::vector<Partition::Block> left_blocks, right_blocks;
  const std::size_t shift = pair.left.size;
  pair.left = merge(pair.left, pair.questions.size(), partition, 0, left_blocks);
  pair.right = merge(pair.right, pair.questions.size(), partition, shift, right_blocks);
  std::unordered_map<Partition::Block, StateId> of_right;
  for (StateId state = 0; state < right_blocks.size(); ++state) {
    of_right.emplace(right_blocks[state], state);
  }
  pair.equivalent.assign(pair.left.size, Mealy::no_state);
  for (StateId state = 0; state < left_blocks.size(); ++state) {
    const auto found = of_right.find(left_blocks[state]);
    if (found != of_right.end()) pair.equivalent[state] = found->second;
  }
}

}  // namespace

BehaviourPair read_behaviours(const NondeterministicMealy& left, const NondeterministicMealy& right,
                              const RunControl& control) {
  BehaviourPair pair;
  const std::vector<JointSymbol> inputs = join_alphabets(left.inputs(), right.inputs());
  for (const JointSymbol& input : inputs) {
    pair.questions.push_back(input.name);
    pair.is_common.push_back(input.left != StateSets::no_symbol &&
                             input.right != StateSets::no_symbol);
  }
  const auto read = [&](const NondeterministicMealy& machine, StateId state, Symbol input) {
    Answer answer;
    if (input == StateSets::no_symbol) {
      answer.text = pair.texts.intern("no such input");
      return answer;
    }
    std::vector<std::string> outputs;
    for (const auto& choice : machine.choices(state, input)) {
      const std::string& output = machine.outputs().name(choice.output);
      if (is_never_tried(output)) {
        answer.is_known = false;
        outputs.emplace_back("never tried");
        continue;
      }
      outputs.push_back(output);
      answer.ways.push_back(
          {pair.labels.intern(machine.inputs().name(input) + " / " + output), choice.target});
    }
    std::ranges::sort(outputs);
    answer.text = pair.texts.intern(outputs.empty() ? "no answer" : join(outputs, " or "));
    return answer;
  };
  pair.left = walk(left.initial(), inputs.size(), control, [&](StateId state, std::size_t place) {
    return read(left, state, inputs[place].left);
  });
  pair.right = walk(right.initial(), inputs.size(), control, [&](StateId state, std::size_t place) {
    return read(right, state, inputs[place].right);
  });
  merge_equivalent(pair, control);
  return pair;
}

BehaviourPair read_behaviours(const InterfaceAutomaton& left, const InterfaceAutomaton& right,
                              const RunControl& control) {
  BehaviourPair pair;
  pair.has_outputs = true;
  const std::vector<JointSymbol> inputs = join_alphabets(left.inputs(), right.inputs());
  const std::vector<JointSymbol> outputs = join_alphabets(left.outputs(), right.outputs());
  for (const JointSymbol& input : inputs) {
    pair.questions.push_back("?" + input.name);
    pair.is_common.push_back(input.left != StateSets::no_symbol &&
                             input.right != StateSets::no_symbol);
  }
  pair.questions.emplace_back("what comes out");
  pair.is_common.push_back(true);
  const Symbol rest = pair.labels.intern(rest_label);
  const auto read_input = [&](StateSets& sets, StateId state, const JointSymbol& input,
                              Symbol symbol) {
    const ActionStatus status = sets.status(state, Action::Kind::input, symbol);
    Answer answer;
    answer.is_known = !status.untried;
    answer.text = pair.texts.intern(to_string(status));
    if (status.enabled) {
      answer.ways.push_back({pair.labels.intern("?" + input.name),
                             sets.successor(state, {Action::Kind::input, symbol})});
    }
    return answer;
  };
  const auto read_outputs = [&](StateSets& sets, StateId state, auto&& symbol_of) {
    Answer answer;
    const auto [may_rest, may_emit] = sets.quiescence(state);
    std::vector<std::string> names;
    for (const JointSymbol& output : outputs) {
      const ActionStatus status = sets.status(state, Action::Kind::output, symbol_of(output));
      if (!status.enabled) continue;
      // An output of every state that the word may have led to is not one of some of them.
      names.push_back(output.name +
                      (status.refused && sets.at(state).size() > 1 ? " (perhaps)" : ""));
      answer.ways.push_back({pair.labels.intern("!" + output.name),
                             sets.successor(state, {Action::Kind::output, symbol_of(output)})});
    }
    if (may_rest) names.emplace_back(rest_label);
    if (may_rest) answer.ways.push_back({rest, state});
    answer.text = pair.texts.intern(join(names, " or "));
    return answer;
  };
  const auto read = [&](const InterfaceAutomaton& automaton, auto&& symbol_of) {
    StateSets sets(automaton);
    const StateId initial = sets.intern({automaton.initial()});
    Behaviour result =
        walk(initial, pair.questions.size(), control, [&](StateId state, std::size_t place) {
          return place < inputs.size()
                     ? read_input(sets, state, inputs[place], symbol_of(inputs[place]))
                     : read_outputs(sets, state, symbol_of);
        });
    for (StateId& origin : result.origins) origin = sets.at(origin).front();
    return result;
  };
  pair.left = read(left, [](const JointSymbol& symbol) { return symbol.left; });
  pair.right = read(right, [](const JointSymbol& symbol) { return symbol.right; });
  merge_equivalent(pair, control);
  return pair;
}

}  // namespace maide
