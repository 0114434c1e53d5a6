#include "maide/automata/minimize.hpp"

#include <algorithm>
#include <cstdint>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include "maide/automata/partition.hpp"
#include "maide/base/invariant.hpp"

namespace maide {
namespace {

// Reverse transitions, flat: the predecessors of `state` under `input`.
class Predecessors {
 public:
  explicit Predecessors(const Mealy& machine)
      : states_(machine.size()), begin_(machine.size() * machine.inputs().size() + 1) {
    const auto inputs = static_cast<Symbol>(machine.inputs().size());
    for (StateId state = 0; state < states_; ++state) {
      for (Symbol input = 0; input < inputs; ++input) {
        ++begin_[cell(machine.target(state, input), input) + 1];
      }
    }
    for (std::size_t i = 1; i < begin_.size(); ++i) begin_[i] += begin_[i - 1];
    MAIDE_CHECK(begin_.back() == states_ * inputs);  // every transition has one target
    sources_.resize(begin_.back());
    std::vector<std::uint32_t> next(begin_.begin(), begin_.end() - 1);
    for (StateId state = 0; state < states_; ++state) {
      for (Symbol input = 0; input < inputs; ++input) {
        sources_[next[cell(machine.target(state, input), input)]++] = state;
      }
    }
  }
  std::span<const StateId> of(StateId state, Symbol input) const {
    const std::size_t place = cell(state, input);
    return {sources_.data() + begin_[place], begin_[place + 1] - begin_[place]};
  }

 private:
  std::size_t cell(StateId state, Symbol input) const {
    return std::size_t{input} * states_ + state;
  }
  std::size_t states_;
  std::vector<std::uint32_t> begin_;
  std::vector<StateId> sources_;
};

// The parts of the blocks that were split since there were `known` blocks, all but a largest one of
// each. `origin` says which block each was part of then.
std::vector<std::vector<StateId>> smaller_parts(const Partition& partition,
                                                const std::vector<Partition::Block>& origin,
                                                Partition::Block known) {
  std::vector<std::pair<Partition::Block, Partition::Block>> parts;  // with their origins
  for (Partition::Block block = known; block < partition.blocks(); ++block) {
    parts.emplace_back(origin[block], origin[block]);
    parts.emplace_back(origin[block], block);
  }
  std::ranges::sort(parts);
  parts.erase(std::unique(parts.begin(), parts.end()), parts.end());
  std::vector<std::vector<StateId>> result;
  for (auto begin = parts.begin(); begin != parts.end();) {
    const auto end = std::find_if(begin, parts.end(),
                                  [&](const auto& part) { return part.first != begin->first; });
    const auto largest = std::max_element(begin, end, [&](const auto& left, const auto& right) {
      return partition.size(left.second) < partition.size(right.second);
    });
    for (; begin != end; ++begin) {
      if (begin == largest) continue;
      const auto states = partition.elements(begin->second);
      result.emplace_back(states.begin(), states.end());
    }
  }
  return result;
}

// The quotient of `machine` by classes of states that behave alike.
template <typename ClassOf>
Mealy quotient(const Mealy& machine, ClassOf&& class_of) {
  const auto inputs = static_cast<Symbol>(machine.inputs().size());
  std::vector<StateId> number(machine.size(), Mealy::no_state);  // by class
  std::vector<StateId> representative;
  const auto visit = [&](StateId state) {
    StateId& its = number[class_of(state)];
    if (its == Mealy::no_state) {
      its = static_cast<StateId>(representative.size());
      representative.push_back(state);
    }
    return its;
  };
  Mealy result(machine.inputs(), machine.outputs(), 0);
  visit(machine.initial());
  for (StateId state = 0; state < representative.size(); ++state) {
    result.add_state();
    for (Symbol input = 0; input < inputs; ++input) {
      const StateId source = representative[state];
      result.set_transition(state, input, machine.output(source, input),
                            visit(machine.target(source, input)));
    }
  }
  MAIDE_CHECK(result.size() == representative.size() && result.is_complete());
  result.origin = machine.origin;
  result.actors = machine.actors;
  return result;
}

}  // namespace

// At the end of a level, states of one block answer alike for that many steps, so each input leads
// them into parts of one block of the level before. What leads into one of those parts is split
// off, for all parts but the largest.
Partition compute_state_classes(const Mealy& machine, const SplitObserver& on_split) {
  using Block = Partition::Block;
  const auto inputs = static_cast<Symbol>(machine.inputs().size());
  const Predecessors predecessors(machine);
  Partition partition(machine.size());
  std::vector<Block> origin(partition.blocks(), 0);  // by block: that at the start of the level
  std::size_t step = 0;
  const auto note_split = [&](Block block, Block fresh) {
    origin.push_back(origin[block]);
    MAIDE_CHECK(origin.size() == fresh + std::size_t{1} && fresh < machine.size());
    if (on_split) on_split(block, fresh, step);
  };
  for (Symbol input = 0; input < inputs; ++input, ++step) {
    const auto output = [&](StateId state) { return machine.output(state, input); };
    for (Block block = 0, end = partition.blocks(); block < end; ++block) {
      Block fresh = partition.split_by(block, output);
      for (; fresh < partition.blocks(); ++fresh) note_split(block, fresh);
    }
  }
  std::vector<Block> touched;
  for (Block known = 1; known < partition.blocks();) {
    const std::vector<std::vector<StateId>> parts = smaller_parts(partition, origin, known);
    for (; known < partition.blocks(); ++known) origin[known] = known;
    for (Symbol input = 0; input < inputs; ++input, ++step) {
      for (const std::vector<StateId>& part : parts) {
        for (const StateId state : part) {
          for (const StateId source : predecessors.of(state, input)) {
            if (partition.mark(source)) touched.push_back(partition.block_of(source));
          }
        }
        for (const Block block : touched) {
          const Block fresh = partition.split(block);
          if (fresh != block) note_split(block, fresh);
        }
        touched.clear();
      }
    }
  }
  MAIDE_CHECK(step <= std::size_t{inputs} * std::max<std::size_t>(machine.size(), 1));
  return partition;
}

Mealy breadth_first(const Mealy& machine) {
  return quotient(machine, [](StateId state) { return state; });
}

Mealy minimize(const Mealy& machine) {
  const Mealy reachable = breadth_first(machine);
  const Partition classes = compute_state_classes(reachable);
  return quotient(reachable, [&](StateId state) { return classes.block_of(state); });
}

InterfaceAutomaton minimize(const InterfaceAutomaton& automaton) {
  Partition classes(automaton.size());
  refine_by_signatures(classes, [&](StateId state) {
    const auto unexplored = automaton.unexplored(state);
    std::vector<std::tuple<Action, bool, Partition::Block>> moves;
    for (const auto& transition : automaton.transitions(state)) {
      moves.emplace_back(transition.action, transition.absorbed,
                         classes.block_of(transition.target));
    }
    std::ranges::sort(moves);
    moves.erase(std::unique(moves.begin(), moves.end()), moves.end());
    return std::pair(Word(unexplored.begin(), unexplored.end()), std::move(moves));
  });
  InterfaceAutomaton result(automaton.inputs(), automaton.outputs(), 0);
  std::vector<StateId> number(automaton.size(), Mealy::no_state);  // by block
  std::vector<StateId> representative;
  const auto visit = [&](StateId state) {
    StateId& its = number[classes.block_of(state)];
    if (its == Mealy::no_state) {
      its = result.add_state();
      representative.push_back(state);
    }
    return its;
  };
  visit(automaton.initial());
  for (StateId state = 0; state < representative.size(); ++state) {
    const StateId source = representative[state];
    for (const auto& transition : automaton.transitions(source)) {
      result.add_transition(state, transition.action, visit(transition.target),
                            transition.absorbed);
    }
    for (const Symbol input : automaton.unexplored(source)) result.mark_unexplored(state, input);
  }
  result.origin = automaton.origin;
  result.actors = automaton.actors;
  result.hidden_returns = automaton.hidden_returns;
  return result;
}

}  // namespace maide
