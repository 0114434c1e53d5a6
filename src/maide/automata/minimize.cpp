#include "maide/automata/minimize.hpp"

#include <algorithm>
#include <map>
#include <tuple>
#include <utility>

#include "maide/base/invariant.hpp"

namespace maide {
namespace {

// Refinable partition of 0..n-1 into blocks: elements of a block lie side by side in `elements`,
// the marked ones first. Splitting a block off costs as much as it has marked elements.
class Partition {
 public:
  Partition(std::vector<std::uint32_t> block_of, std::uint32_t blocks)
      : block_of_(std::move(block_of)), begin_(blocks + 1), marked_(blocks) {
    for (const std::uint32_t block : block_of_) ++begin_[block + 1];
    for (std::size_t i = 1; i < begin_.size(); ++i) begin_[i] += begin_[i - 1];
    end_.assign(begin_.begin() + 1, begin_.end());
    begin_.pop_back();
    elements_.resize(block_of_.size());
    place_.resize(block_of_.size());
    std::vector<std::uint32_t> next = begin_;
    for (std::uint32_t element = 0; element < block_of_.size(); ++element) {
      place_[element] = next[block_of_[element]]++;
      elements_[place_[element]] = element;
    }
  }

  std::uint32_t blocks() const { return static_cast<std::uint32_t>(begin_.size()); }
  std::uint32_t block_of(std::uint32_t element) const { return block_of_[element]; }
  std::uint32_t size(std::uint32_t block) const { return end_[block] - begin_[block]; }
  std::span<const std::uint32_t> elements(std::uint32_t block) const {
    return {elements_.data() + begin_[block], size(block)};
  }

  // Marks an element; returns true if it is the first marked one of its block.
  bool mark(std::uint32_t element) {
    const std::uint32_t block = block_of_[element];
    const std::uint32_t boundary = begin_[block] + marked_[block];
    MAIDE_CHECK(boundary <= end_[block] && elements_[place_[element]] == element);
    if (place_[element] < boundary) return false;
    swap_places(element, elements_[boundary]);
    return marked_[block]++ == 0;
  }

  // Splits the marked elements off into a new block and unmarks them; returns the new block, or
  // `block` itself if all of it was marked.
  std::uint32_t split(std::uint32_t block) {
    const std::uint32_t count = std::exchange(marked_[block], 0);
    if (count == 0 || count == size(block)) return block;
    const std::uint32_t fresh = blocks();
    begin_.push_back(begin_[block]);
    end_.push_back(begin_[block] + count);
    marked_.push_back(0);
    begin_[block] += count;
    MAIDE_CHECK(size(block) > 0 && size(fresh) == count && end_[fresh] == begin_[block]);
    for (const std::uint32_t element : elements(fresh)) block_of_[element] = fresh;
    return fresh;
  }

 private:
  void swap_places(std::uint32_t left, std::uint32_t right) {
    std::swap(elements_[place_[left]], elements_[place_[right]]);
    std::swap(place_[left], place_[right]);
  }
  std::vector<std::uint32_t> block_of_, begin_, end_, marked_, elements_, place_;
};

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

Partition by_output_rows(const Mealy& machine) {
  std::map<Word, std::uint32_t> rows;
  std::vector<std::uint32_t> block_of(machine.size());
  Word row(machine.inputs().size());
  for (StateId state = 0; state < machine.size(); ++state) {
    for (Symbol input = 0; input < row.size(); ++input) row[input] = machine.output(state, input);
    const auto [place, is_new] = rows.emplace(row, static_cast<std::uint32_t>(rows.size()));
    block_of[state] = place->second;
  }
  return Partition(std::move(block_of), static_cast<std::uint32_t>(rows.size()));
}

void refine(const Mealy& machine, Partition& partition) {
  const Predecessors predecessors(machine);
  const auto inputs = static_cast<Symbol>(machine.inputs().size());
  // Splitters still to be used, as (block, input); `waiting` says which are in the list.
  std::vector<std::pair<std::uint32_t, Symbol>> work;
  std::vector<std::vector<bool>> waiting;
  const auto add = [&](std::uint32_t block, Symbol input) {
    if (waiting.size() <= block) waiting.resize(block + 1, std::vector<bool>(inputs));
    if (waiting[block][input]) return;
    waiting[block][input] = true;
    work.emplace_back(block, input);
  };
  for (std::uint32_t block = 0; block < partition.blocks(); ++block) {
    for (Symbol input = 0; input < inputs; ++input) add(block, input);
  }
  std::vector<StateId> splitter;
  std::vector<std::uint32_t> touched;
  while (!work.empty()) {
    const auto [block, input] = work.back();
    work.pop_back();
    waiting[block][input] = false;
    const auto members = partition.elements(block);
    splitter.assign(members.begin(), members.end());
    touched.clear();
    for (const StateId state : splitter) {
      for (const StateId source : predecessors.of(state, input)) {
        const std::uint32_t its_block = partition.block_of(source);
        if (partition.mark(source)) touched.push_back(its_block);
      }
    }
    for (const std::uint32_t old : touched) {
      const std::uint32_t fresh = partition.split(old);
      if (fresh == old) continue;
      for (Symbol other = 0; other < inputs; ++other) {
        const bool is_waiting = waiting.size() > old && waiting[old][other];
        const bool fresh_is_smaller = partition.size(fresh) <= partition.size(old);
        add(is_waiting || fresh_is_smaller ? fresh : old, other);
      }
    }
  }
}

// Reachable states of a system in breadth-first order. `each_successor(state, visit)`.
template <typename EachSuccessor>
std::vector<StateId> breadth_first_order(StateId initial, std::size_t size,
                                         EachSuccessor each_successor) {
  std::vector<bool> seen(size);
  std::vector<StateId> order{initial};
  seen[initial] = true;
  for (std::size_t i = 0; i < order.size(); ++i) {
    each_successor(order[i], [&](StateId next) {
      if (seen[next]) return;
      seen[next] = true;
      order.push_back(next);
    });
  }
  return order;
}

// The quotient of `machine` by a partition whose blocks behave alike.
Mealy quotient(const Mealy& machine, const std::vector<std::uint32_t>& block_of) {
  const auto inputs = static_cast<Symbol>(machine.inputs().size());
  std::vector<StateId> number(machine.size(), Mealy::no_state);  // by block
  std::vector<StateId> representative;
  const auto visit = [&](StateId state) {
    StateId& its = number[block_of[state]];
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

// One round of signature refinement; returns the number of blocks.
std::size_t refine_by_signatures(const InterfaceAutomaton& automaton,
                                 const std::vector<StateId>& states,
                                 std::vector<std::uint32_t>& block_of) {
  using Signature =
      std::tuple<std::uint32_t, Word, std::vector<std::tuple<Action, bool, std::uint32_t>>>;
  std::map<Signature, std::uint32_t> blocks;
  std::vector<std::uint32_t> next(block_of.size());
  for (const StateId state : states) {
    const auto unexplored = automaton.unexplored(state);
    Signature signature{block_of[state], Word(unexplored.begin(), unexplored.end()), {}};
    auto& moves = std::get<2>(signature);
    for (const auto& transition : automaton.transitions(state)) {
      moves.emplace_back(transition.action, transition.absorbed, block_of[transition.target]);
    }
    std::sort(moves.begin(), moves.end());
    moves.erase(std::unique(moves.begin(), moves.end()), moves.end());
    const auto fresh = static_cast<std::uint32_t>(blocks.size());
    next[state] = blocks.emplace(std::move(signature), fresh).first->second;
  }
  MAIDE_CHECK(blocks.size() <= states.size());
  block_of = std::move(next);
  return blocks.size();
}

}  // namespace

Mealy breadth_first(const Mealy& machine) {
  std::vector<std::uint32_t> identity(machine.size());
  for (StateId state = 0; state < machine.size(); ++state) identity[state] = state;
  return quotient(machine, identity);
}

Mealy minimize(const Mealy& machine) {
  const Mealy reachable = breadth_first(machine);
  Partition partition = by_output_rows(reachable);
  refine(reachable, partition);
  std::vector<std::uint32_t> block_of(reachable.size());
  for (StateId state = 0; state < reachable.size(); ++state) {
    block_of[state] = partition.block_of(state);
  }
  return quotient(reachable, block_of);
}

InterfaceAutomaton minimize(const InterfaceAutomaton& automaton) {
  const auto each_successor = [&](StateId state, auto visit) {
    for (const auto& transition : automaton.transitions(state)) visit(transition.target);
  };
  const std::vector<StateId> states =
      breadth_first_order(automaton.initial(), automaton.size(), each_successor);
  std::vector<std::uint32_t> block_of(automaton.size());
  for (std::size_t before = 0, blocks = 1; blocks != before;) {
    before = blocks;
    blocks = refine_by_signatures(automaton, states, block_of);
  }
  InterfaceAutomaton result(automaton.inputs(), automaton.outputs(), 0);
  std::vector<StateId> number(automaton.size(), Mealy::no_state);  // by block
  std::vector<StateId> representative;
  const auto visit = [&](StateId state) {
    StateId& its = number[block_of[state]];
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
