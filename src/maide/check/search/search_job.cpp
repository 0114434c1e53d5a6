#include "maide/check/search/search_job.hpp"

#include <cstring>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "maide/base/error.hpp"
#include "maide/base/hash.hpp"
#include "maide/base/version.hpp"

namespace maide {
namespace {

UsageError of_another_version() {
  return UsageError("the first rank's maide is of another version; all ranks need the same");
}

// One function a type serves both ways: a JobWriter appends what it is given, a JobReader fills it
// in.

class JobWriter {
 public:
  static constexpr bool writes = true;
  template <typename Number>
  void number(Number& value) {
    const auto* data = reinterpret_cast<const unsigned char*>(&value);
    bytes_.insert(bytes_.end(), data, data + sizeof value);
  }
  Ranks::Bytes take() { return std::move(bytes_); }

 private:
  Ranks::Bytes bytes_;
};

class JobReader {
 public:
  static constexpr bool writes = false;
  explicit JobReader(std::span<const unsigned char> bytes) : bytes_(bytes) {}
  template <typename Number>
  void number(Number& value) {
    if (bytes_.size() < sizeof value) throw of_another_version();
    std::memcpy(&value, bytes_.data(), sizeof value);
    bytes_ = bytes_.subspan(sizeof value);
  }
  bool is_at_end() const { return bytes_.empty(); }

 private:
  std::span<const unsigned char> bytes_;
};

template <typename Archive, typename... Parts>
void all(Archive& archive, Parts&... parts);

template <typename Archive, typename Number>
requires(std::is_arithmetic_v<Number> || std::is_enum_v<Number>) void pass(Archive& archive,
                                                                           Number& value) {
  archive.number(value);
}

// The number of elements, which a reader makes first.
template <typename Archive, typename List>
void pass_size(Archive& archive, List& list) {
  std::uint64_t size = list.size();
  pass(archive, size);
  if constexpr (!Archive::writes) list.resize(size);
}
template <typename Archive>
void pass(Archive& archive, std::string& text) {
  pass_size(archive, text);
  for (char& byte : text) pass(archive, byte);
}
template <typename Archive, typename Item>
void pass(Archive& archive, std::optional<Item>& item) {
  bool is_there = item.has_value();
  pass(archive, is_there);
  if (!is_there) return;
  if constexpr (!Archive::writes) item.emplace();
  all(archive, *item);
}
template <typename Archive, typename Item>
void pass(Archive& archive, std::vector<Item>& items) {
  pass_size(archive, items);
  for (Item& item : items) all(archive, item);
}
template <typename Archive>
void pass(Archive& archive, std::vector<bool>& bits) {
  pass_size(archive, bits);
  for (std::size_t i = 0; i < bits.size(); ++i) {
    bool bit = bits[i];
    pass(archive, bit);
    bits[i] = bit;
  }
}

// ---- Models ----

template <typename Archive>
void pass(Archive& archive, Alphabet& alphabet) {
  std::vector<std::string> names = alphabet.names();
  pass(archive, names);
  if constexpr (!Archive::writes) alphabet = Alphabet(names);
}
template <typename Archive>
void pass(Archive& archive, InterfaceAutomaton::Transition& transition) {
  all(archive, transition.action.kind, transition.action.symbol, transition.target,
      transition.absorbed);
}
template <typename Archive>
void pass(Archive& archive, InterfaceAutomaton& automaton) {
  Alphabet inputs = automaton.inputs(), outputs = automaton.outputs();
  std::uint64_t size = automaton.size();
  StateId initial = automaton.initial();
  all(archive, inputs, outputs, size, initial);
  if constexpr (!Archive::writes) {
    automaton = InterfaceAutomaton(std::move(inputs), std::move(outputs), size);
    automaton.set_initial(initial);
  }
  for (StateId state = 0; state < size; ++state) {
    const auto transitions = automaton.transitions(state);
    const auto unexplored = automaton.unexplored(state);
    std::vector<InterfaceAutomaton::Transition> known(transitions.begin(), transitions.end());
    std::vector<Symbol> unknown(unexplored.begin(), unexplored.end());
    all(archive, known, unknown);
    if constexpr (!Archive::writes) {
      for (const auto& transition : known) {
        automaton.add_transition(state, transition.action, transition.target, transition.absorbed);
      }
      for (const Symbol input : unknown) automaton.mark_unexplored(state, input);
    }
  }
}
template <typename Archive>
void pass(Archive& archive, ModelStep& step) {
  all(archive, step.target, step.is_beyond);
}
template <typename Archive>
void pass(Archive& archive, ModelAction& action) {
  all(archive, action.name, action.steps, action.is_call);
}
template <typename Archive>
void pass(Archive& archive, ValueType& type) {
  all(archive, type.kind, type.low, type.high, type.words);
}
template <typename Archive>
void pass(Archive& archive, ModelInstance& model) {
  all(archive, model.name, model.automaton, model.actions, model.source, model.type, model.is_grown,
      model.when_unexplored, model.when_weak);
}

// ---- Programs ----

template <typename Archive>
void pass(Archive& archive, ModelUse& use) {
  all(archive, use.kind, use.model, use.index);
}
template <typename Archive>
void pass(Archive& archive, ProgramEdge& edge) {
  all(archive, static_cast<ModelUse&>(edge), edge.target, edge.line, edge.column, edge.origin);
}
template <typename Archive>
void pass(Archive& archive, CombinedStep& combined) {
  all(archive, combined.role, combined.uses, combined.events, combined.text, combined.fair,
      combined.callback, combined.awaits_anybody);
}
template <typename Archive>
void pass(Archive& archive, FairGroup& group) {
  all(archive, group.on_weak_runs, group.text);
}
template <typename Archive>
void pass(Archive& archive, ProgramVariable& variable) {
  all(archive, variable.name, variable.type);
}
template <typename Archive>
void pass(Archive& archive, ProgramError& error) {
  all(archive, error.text);
}
template <typename Archive>
void pass(Archive& archive, Program::State& state) {
  all(archive, state.first_edge, state.edge_count, state.label_set, state.round, state.valuation,
      state.error, state.may_rest, state.waits);
}
template <typename Archive>
void pass(Archive& archive, ActorFlags& flags) {
  all(archive, flags.counts_for_deadlock, flags.is_fair, flags.may_rest, flags.is_shown,
      flags.counts_on_anybody);
}
template <typename Archive>
void pass(Archive& archive, NobodysAction& action) {
  all(archive, action.what, action.counts_for_deadlock, action.is_shown);
}
template <typename Archive>
void pass(Archive& archive, Program& program) {
  all(archive, program.name, program.flags, program.states, program.edges, program.labels,
      program.label_sets, program.combined, program.fair_groups, program.variables,
      program.valuations, program.errors, program.names);
}

// ---- Properties ----

template <typename Archive>
void pass(Archive& archive, Expression::Dimension& dimension) {
  all(archive, dimension.low, dimension.high);
}
template <typename Archive>
void pass(Archive& archive, Expression& expression) {
  all(archive, expression.op, expression.kind, expression.value, expression.owner, expression.index,
      expression.dimensions, expression.operands);
}
template <typename Archive>
void pass(Archive& archive, Atom& atom) {
  all(archive, atom.kind, atom.owner, atom.symbol, atom.program);
}
template <typename Archive>
void pass(Archive& archive, Formula& formula) {
  bool is_there = formula != nullptr;
  pass(archive, is_there);
  if (!is_there) return;
  FormulaNode node = formula == nullptr ? FormulaNode() : *formula;
  all(archive, node.op, node.atom, node.left, node.right);
  if constexpr (!Archive::writes) formula = std::make_shared<const FormulaNode>(std::move(node));
}
template <typename Archive>
void pass(Archive& archive, Property& property) {
  all(archive, property.name, property.kind, property.formula, property.fairness);
}

template <typename Archive>
void pass(Archive& archive, LtlAutomaton::Transition& transition) {
  all(archive, transition.letter.positive, transition.letter.negative, transition.target,
      transition.marks);
}
template <typename Archive>
void pass(Archive& archive, LtlAutomaton& automaton) {
  all(archive, automaton.atoms, automaton.mark_count, automaton.states, automaton.initial,
      automaton.universal);
}
template <typename Archive>
void pass(Archive& archive, StreettPair& pair) {
  all(archive, pair.asked, pair.answered);
}
template <typename Archive>
void pass(Archive& archive, StreettAutomaton& automaton) {
  all(archive, automaton.buchi, automaton.pairs, automaton.pairs_of);
}
template <typename Archive>
void pass(Archive& archive, SearchJob::Monitor& monitor) {
  all(archive, monitor.automaton, monitor.stuck, monitor.has_wide_bits);
}
template <typename Archive>
void pass(Archive& archive, SearchLimits& limits) {
  all(archive, limits.states, limits.depth, limits.bytes, limits.states_a_thread, limits.threads,
      limits.checkpoints, limits.checkpoint_seconds);
}
template <typename Archive>
void pass(Archive& archive, SearchJob& job) {
  all(archive, job.goal, job.system.models, job.system.programs, job.system.nobodys_actions,
      job.system.nobodys_groups, job.system.expressions, job.property, job.reduction, job.limits,
      job.monitor);
}

template <typename Archive, typename... Parts>
void all(Archive& archive, Parts&... parts) {
  (pass(archive, parts), ...);
}

}  // namespace

Ranks::Bytes encode(SearchJob job) {
  JobWriter writer;
  std::string program(version());
  all(writer, program, job);
  return writer.take();
}

std::uint64_t key_of(SearchJob job) {
  SearchLimits limits;
  limits.depth = job.limits.depth;
  job.limits = std::move(limits);
  JobWriter writer;
  pass(writer, job);
  std::uint64_t key = hash_start;
  for (const unsigned char byte : writer.take()) key = hash_step(key, byte);
  return key;
}

SearchJob decode(std::span<const unsigned char> bytes) {
  JobReader reader(bytes);
  std::string program;
  pass(reader, program);
  if (program != version()) throw of_another_version();
  SearchJob job;
  pass(reader, job);
  if (!reader.is_at_end()) throw of_another_version();
  return job;
}

}  // namespace maide
