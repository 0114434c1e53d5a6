#include "maide/automata/mealy.hpp"

#include <atomic>
#include <map>
#include <utility>

#include "maide/base/invariant.hpp"

namespace maide {
namespace {

// One that no row of the process has had. Each thread takes many at a time.
std::uint64_t new_revision() {
  constexpr std::uint64_t taken_at_once = 1 << 16;
  static std::atomic<std::uint64_t> taken{0};
  thread_local std::uint64_t last = 0;
  if (last % taken_at_once == 0) last = taken.fetch_add(taken_at_once, std::memory_order_relaxed);
  return ++last;
}

}  // namespace

Mealy::Mealy(Alphabet inputs, Alphabet outputs, std::size_t states)
    : inputs_(std::move(inputs)), outputs_(std::move(outputs)), size_(states) {
  cells_.resize(size_ * inputs_.size());
  revisions_.resize(size_);
}

StateId Mealy::add_state() {
  ++size_;
  cells_.resize(size_ * inputs_.size());
  revisions_.push_back(0);
  return static_cast<StateId>(size_ - 1);
}

void Mealy::set_transition(StateId from, Symbol input, Symbol output, StateId to) {
  MAIDE_CHECK(from < size_ && input < inputs_.size() && output < outputs_.size());
  cells_[index(from, input)] = {to, output};
  revisions_[from] = new_revision();
}

bool Mealy::is_complete() const {
  for (const Cell& cell : cells_) {
    if (cell.target == no_state) return false;
  }
  return true;
}

StateId Mealy::run(StateId from, std::span<const Symbol> word) const {
  for (const Symbol input : word) from = target(from, input);
  return from;
}

Word Mealy::output_word(StateId from, std::span<const Symbol> word) const {
  Word outputs;
  outputs.reserve(word.size());
  for (const Symbol input : word) {
    outputs.push_back(output(from, input));
    from = target(from, input);
  }
  return outputs;
}

std::optional<std::string> find_initial_output(const Mealy& machine) {
  const auto type = machine.origin.find("type");
  if (type == machine.origin.end() || (type->second != "moore" && type->second != "dfa")) {
    return std::nullopt;
  }
  const auto output = machine.origin.find("initial_output");
  if (output == machine.origin.end()) return std::nullopt;
  return output->second;
}

void mark_as_moore(Mealy& machine, const std::string& type, const std::string& initial_output) {
  machine.origin["type"] = type;
  machine.origin["initial_output"] = initial_output;
}

std::optional<std::vector<std::string>> find_state_outputs(const Mealy& machine) {
  const auto initial = find_initial_output(machine);
  if (!initial) return std::nullopt;
  std::vector<std::optional<std::string>> outputs(machine.size());
  outputs[machine.initial()] = *initial;
  for (StateId state = 0; state < machine.size(); ++state) {
    for (Symbol input = 0; input < machine.inputs().size(); ++input) {
      const std::string& name = machine.outputs().name(machine.output(state, input));
      std::optional<std::string>& output = outputs[machine.target(state, input)];
      if (output && *output != name) return std::nullopt;
      output = name;
    }
  }
  std::vector<std::string> result;
  for (const auto& output : outputs) result.push_back(output ? *output : *initial);
  return result;
}

Mealy split_states(const Mealy& machine) {
  Mealy result(machine.inputs(), machine.outputs(), 1);
  const Symbol initial = result.intern_output(find_initial_output(machine).value());
  std::vector<std::pair<StateId, Symbol>> states{{machine.initial(), initial}};  // of the result
  std::map<std::pair<StateId, Symbol>, StateId> number{{states[0], 0}};
  for (StateId state = 0; state < states.size(); ++state) {
    for (Symbol input = 0; input < machine.inputs().size(); ++input) {
      const StateId source = states[state].first;
      const std::pair next(machine.target(source, input), machine.output(source, input));
      const auto [entry, is_new] = number.try_emplace(next, static_cast<StateId>(states.size()));
      if (is_new) {
        states.push_back(next);
        result.add_state();
      }
      result.set_transition(state, input, next.second, entry->second);
    }
  }
  result.origin = machine.origin;
  result.actors = machine.actors;
  return result;
}

}  // namespace maide
