#include "maide/automata/nondeterministic_mealy.hpp"

#include <algorithm>
#include <numeric>
#include <set>
#include <tuple>

#include "maide/automata/partition.hpp"
#include "maide/base/error.hpp"

namespace maide {

NondeterministicMealy::NondeterministicMealy(Alphabet inputs, Alphabet outputs, std::size_t states)
    : inputs_(std::move(inputs)),
      outputs_(std::move(outputs)),
      states_(states),
      cells_(states * inputs_.size()) {}

NondeterministicMealy::NondeterministicMealy(const Mealy& machine)
    : NondeterministicMealy(machine.inputs(), machine.outputs(), machine.size()) {
  initial_ = machine.initial();
  origin = machine.origin;
  actors = machine.actors;
  for (StateId state = 0; state < states_; ++state) {
    for (Symbol input = 0; input < inputs_.size(); ++input) {
      if (machine.target(state, input) == Mealy::no_state) continue;
      add_choice(state, input, machine.output(state, input), machine.target(state, input));
    }
  }
}

std::size_t NondeterministicMealy::transition_count() const {
  return std::accumulate(
      cells_.begin(), cells_.end(), std::size_t{0},
      [](std::size_t sum, const std::vector<Choice>& cell) { return sum + cell.size(); });
}

void NondeterministicMealy::add_choice(StateId from, Symbol input, Symbol output, StateId to) {
  auto& cell = cells_[index(from, input)];
  const auto place =
      std::lower_bound(cell.begin(), cell.end(), output,
                       [](const Choice& choice, Symbol wanted) { return choice.output < wanted; });
  if (place != cell.end() && place->output == output) {
    if (place->target == to) return;
    throw UsageError("state " + std::to_string(from) + " has two transitions for \"" +
                     inputs_.name(input) + " / " + outputs_.name(output) +
                     "\": a nondeterministic Mealy machine must be observable");
  }
  cell.insert(place, {output, to});
}

StateId NondeterministicMealy::successor(StateId from, Symbol input, Symbol output) const {
  const auto& cell = cells_[index(from, input)];
  const auto place =
      std::lower_bound(cell.begin(), cell.end(), output,
                       [](const Choice& choice, Symbol wanted) { return choice.output < wanted; });
  return place != cell.end() && place->output == output ? place->target : Mealy::no_state;
}

bool NondeterministicMealy::answers_at(StateId state) const {
  for (Symbol input = 0; input < inputs_.size(); ++input) {
    if (!choices(state, input).empty()) return true;
  }
  return false;
}

bool NondeterministicMealy::is_complete() const {
  return std::ranges::none_of(cells_, [](const auto& cell) { return cell.empty(); });
}

bool NondeterministicMealy::is_deterministic() const {
  return std::ranges::all_of(cells_, [](const auto& cell) { return cell.size() <= 1; });
}

std::optional<Mealy> NondeterministicMealy::to_mealy() const {
  if (!is_deterministic() || !is_complete()) return std::nullopt;
  Mealy machine(inputs_, outputs_, states_);
  machine.set_initial(initial_);
  machine.origin = origin;
  machine.actors = actors;
  for (StateId state = 0; state < states_; ++state) {
    for (Symbol input = 0; input < inputs_.size(); ++input) {
      const Choice& choice = cells_[index(state, input)].front();
      machine.set_transition(state, input, choice.output, choice.target);
    }
  }
  return machine;
}

void NondeterministicMealy::complete_with(std::string_view output) {
  for (StateId state = 0; state < states_; ++state) {
    for (Symbol input = 0; input < inputs_.size(); ++input) {
      if (choices(state, input).empty()) add_choice(state, input, intern_output(output), state);
    }
  }
}

namespace {

using Choice = NondeterministicMealy::Choice;

// Places of the outputs in the order of their names.
std::vector<std::size_t> rank_by_name(const Alphabet& outputs) {
  std::vector<Symbol> order(outputs.size());
  std::iota(order.begin(), order.end(), Symbol{0});
  std::ranges::sort(
      order, [&](Symbol left, Symbol right) { return outputs.name(left) < outputs.name(right); });
  std::vector<std::size_t> rank(outputs.size());
  for (std::size_t place = 0; place < order.size(); ++place) rank[order[place]] = place;
  return rank;
}

}  // namespace

NondeterministicMealy minimize(const NondeterministicMealy& machine) {
  if (machine.size() == 0) return machine;
  // The coarsest partition in which equal states have equal choices up to the targets' blocks.
  Partition classes(machine.size());
  refine_by_signatures(classes, [&](StateId state) {
    std::vector<std::tuple<Symbol, Symbol, Partition::Block>> signature;
    for (Symbol input = 0; input < machine.inputs().size(); ++input) {
      for (const Choice& choice : machine.choices(state, input)) {
        signature.emplace_back(input, choice.output, classes.block_of(choice.target));
      }
    }
    return signature;
  });
  const std::vector<std::size_t> rank = rank_by_name(machine.outputs());
  constexpr StateId unseen = Mealy::no_state;
  std::vector<StateId> number(machine.size(), unseen);  // by block
  std::vector<StateId> order;                           // a state of each block that is reached
  const auto visit = [&](StateId state) {
    if (number[classes.block_of(state)] != unseen) return;
    number[classes.block_of(state)] = static_cast<StateId>(order.size());
    order.push_back(state);
  };
  visit(machine.initial());
  for (std::size_t place = 0; place < order.size(); ++place) {
    for (Symbol input = 0; input < machine.inputs().size(); ++input) {
      const auto choices = machine.choices(order[place], input);
      std::vector<Choice> sorted(choices.begin(), choices.end());
      std::ranges::sort(sorted, [&](const Choice& left, const Choice& right) {
        return rank[left.output] < rank[right.output];
      });
      for (const Choice& choice : sorted) visit(choice.target);
    }
  }
  NondeterministicMealy result(machine.inputs(), machine.outputs(), order.size());
  result.origin = machine.origin;
  result.actors = machine.actors;
  for (StateId state = 0; state < order.size(); ++state) {
    for (Symbol input = 0; input < machine.inputs().size(); ++input) {
      for (const Choice& choice : machine.choices(order[state], input)) {
        result.add_choice(state, input, choice.output, number[classes.block_of(choice.target)]);
      }
    }
  }
  return result;
}

namespace {

std::vector<std::string> offered(const NondeterministicMealy& machine, StateId state,
                                 const std::string& input) {
  std::vector<std::string> names;
  if (const auto symbol = machine.inputs().find(input)) {
    for (const Choice& choice : machine.choices(state, *symbol)) {
      names.push_back(machine.outputs().name(choice.output));
    }
  }
  std::ranges::sort(names);
  return names;
}

// The inputs of both, left's first.
std::vector<std::string> all_inputs(const NondeterministicMealy& left,
                                    const NondeterministicMealy& right) {
  std::vector<std::string> names = left.inputs().names();
  for (const std::string& name : right.inputs().names()) {
    if (!left.inputs().find(name)) names.push_back(name);
  }
  return names;
}

// A pair of states that the same trace reaches, and the step that led there first.
struct Pair {
  StateId left, right;
  std::size_t parent;
  std::string input, output;
};

}  // namespace

std::optional<TraceDifference> find_difference(const NondeterministicMealy& left,
                                               const NondeterministicMealy& right) {
  const std::vector<std::string> inputs = all_inputs(left, right);
  std::vector<Pair> pairs{{left.initial(), right.initial(), 0, {}, {}}};
  std::set<std::pair<StateId, StateId>> seen{{left.initial(), right.initial()}};
  for (std::size_t place = 0; place < pairs.size(); ++place) {
    for (const std::string& input : inputs) {
      const Pair here = pairs[place];
      TraceDifference difference{
          {}, input, offered(left, here.left, input), offered(right, here.right, input)};
      if (difference.left != difference.right || !left.inputs().find(input) ||
          !right.inputs().find(input)) {
        for (std::size_t back = place; back != 0; back = pairs[back].parent) {
          difference.trace.emplace_back(pairs[back].input, pairs[back].output);
        }
        std::ranges::reverse(difference.trace);
        return difference;
      }
      for (const std::string& output : difference.left) {
        const StateId next_left =
            left.successor(here.left, *left.inputs().find(input), *left.outputs().find(output));
        const StateId next_right =
            right.successor(here.right, *right.inputs().find(input), *right.outputs().find(output));
        if (!seen.emplace(next_left, next_right).second) continue;
        pairs.push_back({next_left, next_right, place, input, output});
      }
    }
  }
  return std::nullopt;
}

}  // namespace maide
