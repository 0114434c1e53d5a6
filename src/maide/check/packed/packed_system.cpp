#include "maide/check/packed/packed_system.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "maide/base/error.hpp"
#include "maide/base/hash.hpp"
#include "maide/base/invariant.hpp"
#include "maide/base/numbers.hpp"

namespace maide {
namespace {

// What a StateTable can do: see there.
constexpr unsigned first_word = 44, most_payload = 32;
constexpr unsigned most_code_bits = 31;  // what a table of steps has room for
constexpr unsigned most_kept_bits = 24;  // of a number of what is kept, where there is room

// The first actions of nobody's parts, and their number. An action belongs to the part before it if
// both use one wire.
std::vector<std::uint32_t> find_parts(const System& system) {
  const auto& actions = system.nobodys_actions;
  const auto are_together = [&](const NobodysAction& left, const NobodysAction& right) {
    return std::ranges::any_of(left.what.uses, [&](const ModelUse& use) {
      return system.models[use.model].source == ModelInstance::Source::wire &&
             std::ranges::find(right.what.uses, use.model, &ModelUse::model) !=
                 right.what.uses.end();
    });
  };
  std::vector<std::uint32_t> firsts{0};
  for (std::uint32_t i = 1; i < actions.size(); ++i) {
    if (!are_together(actions[i - 1], actions[i])) firsts.push_back(i);
  }
  if (system.programs.size() + firsts.size() > most_actors_in_a_word) firsts.resize(1);
  firsts.push_back(static_cast<std::uint32_t>(actions.size()));
  return firsts;
}

}  // namespace

PackedSystem::PackedSystem(const System& system, unsigned least_payload_bits,
                           std::size_t monitor_states)
    : system_(&system) {
  for (const ModelInstance& model : system.models) {
    tables_.emplace_back(model.automaton.inputs().size() + model.automaton.outputs().size() + 1 +
                         model.actions.size());
  }
  program_count_ = system.programs.size();
  for (const Program& program : system.programs) add_program(program);
  if (!system.nobodys_actions.empty()) add_nobody();
  add_calls();
  number_codes();
  lay_out(std::max(code_bits_, least_payload_bits), monitor_states);
  place_fields();
}

std::size_t PackedSystem::action_index(const ModelUse& use) const {
  const InterfaceAutomaton& automaton = system_->models[use.model].automaton;
  const std::size_t inputs = automaton.inputs().size(), outputs = automaton.outputs().size();
  switch (use.kind) {
    case ModelUse::Kind::give: return use.index;
    case ModelUse::Kind::take: return inputs + use.index;
    case ModelUse::Kind::act: return inputs + outputs + 1 + use.index;
    default: return inputs + outputs;  // quiet
  }
}

const PackedSystem::ActionTable& PackedSystem::table_of(const ModelUse& use) const {
  return tables_[use.model][action_index(use)];
}

std::span<const ModelUse> PackedSystem::uses_of(std::size_t actor, std::size_t action) const {
  if (actor >= program_count_) return system_->nobodys_actions[action].what.uses;
  const Program& program = system_->programs[actor];
  return program.uses_of(program.edges[action]);
}

void PackedSystem::add_program(const Program& program) {
  PackedActor& packed = actors_.emplace_back();
  packed.edges_into.resize(program.states.size());
  packed.edges.resize(program.edges.size());
  packed.sources.resize(program.edges.size());
  for (ControlState at = 0; at < program.states.size(); ++at) {
    const Program::State& state = program.states[at];
    packed.first_edge.push_back(state.first_edge);
    packed.may_stay.push_back(program.is_end(at) || program.may_rest(at));
    packed.is_error.push_back(state.error != 0);
    for (std::uint32_t i = state.first_edge; i < state.first_edge + state.edge_count; ++i) {
      const ProgramEdge& edge = program.edges[i];
      packed.sources[i] = at;
      packed.edges_into[edge.target].push_back(i);
      for (const ModelUse& use : program.uses_of(edge)) add_action(use);
    }
  }
  packed.first_edge.push_back(static_cast<std::uint32_t>(program.edges.size()));
  for (const ProgramEdge& edge : program.edges) {
    packed.is_idle.push_back(!program.is_progress(edge));
    has_idle_steps_ = has_idle_steps_ || packed.is_idle.back();
    packed.is_fate.push_back(program.role_of(edge) == CombinedStep::Role::fate);
    has_fates_ = has_fates_ || packed.is_fate.back();
  }
  if (std::ranges::find(packed.is_error, true) != packed.is_error.end()) {
    erring_.push_back(static_cast<std::uint32_t>(actors_.size() - 1));
  }
  add_groups(program, packed);
}

void PackedSystem::add_groups(const Program& program, PackedActor& packed) {
  packed.groups.assign(program.edges.size(), no_group);
  for (std::uint32_t group = 1; group < program.fair_groups.size(); ++group) {
    const auto number = static_cast<std::uint32_t>(weak_groups_.size());
    weak_groups_.push_back(program.fair_groups[group].on_weak_runs);
    has_weak_groups_ = has_weak_groups_ || weak_groups_.back();
    for (std::size_t i = 0; i < program.edges.size(); ++i) {
      if (program.fair_group_of(program.edges[i]) == group) packed.groups[i] = number;
    }
  }
}

void PackedSystem::add_nobody() {
  const std::vector<std::uint32_t> firsts = find_parts(*system_);
  for (std::size_t i = 0; i + 1 < firsts.size(); ++i) add_part(firsts[i], firsts[i + 1]);
  for (std::size_t index = 0; index < program_count_; ++index) {
    const Program& program = system_->programs[index];
    for (std::size_t i = 0; i < program.edges.size(); ++i) {
      const std::uint32_t group = program.nobodys_group_of(program.edges[i]);
      if (group == 0) continue;
      actors_[index].groups[i] = static_cast<std::uint32_t>(weak_groups_.size()) + group - 1;
    }
  }
  for (std::size_t group = 1; group < system_->nobodys_groups.size(); ++group) {
    weak_groups_.push_back(true);
    has_weak_groups_ = true;
  }
}

// One control state, from which all actions lead back to it.
void PackedSystem::add_part(std::uint32_t first, std::uint32_t end) {
  PackedActor& packed = actors_.emplace_back();
  const auto& actions = system_->nobodys_actions;
  packed.first_edge = {first, end};
  packed.may_stay = {true};
  packed.is_error = {false};
  packed.edges.resize(end);
  packed.sources.assign(end, 0);
  packed.edges_into.resize(1);
  packed.groups.assign(end, no_group);
  packed.is_idle.assign(end, false);
  packed.is_fate.assign(end, false);
  for (std::uint32_t number = first; number < end; ++number) {
    const NobodysAction& action = actions[number];
    packed.edges_into[0].push_back(number);
    packed.is_idle[number] = !action.counts_for_deadlock;
    has_idle_steps_ = has_idle_steps_ || packed.is_idle[number];
    for (const ModelUse& use : action.what.uses) add_action(use);
    if (action.what.fair == 0) continue;
    packed.groups[number] = static_cast<std::uint32_t>(weak_groups_.size()) + action.what.fair - 1;
  }
}

void PackedSystem::add_calls() {
  const auto& models = system_->models;
  const auto is_call = [&](const ModelUse& use) {
    return use.kind == ModelUse::Kind::act && models[use.model].actions[use.index].is_call;
  };
  for (std::size_t index = 0; index < actors_.size(); ++index) {
    auto& called = actors_[index].called;
    called.assign(actors_[index].edges.size(), no_model);
    for (std::size_t edge = 0; edge < called.size(); ++edge) {
      for (const ModelUse& use : uses_of(index, edge)) {
        if (!is_call(use)) continue;
        called[edge] = use.model;
        users_.resize(models.size());
      }
    }
  }
  if (!has_calls()) return;
  for (std::uint32_t index = 0; index < program_count_; ++index) {
    const Program& program = system_->programs[index];
    for (std::size_t edge = 0; edge < program.edges.size(); ++edge) {
      for (const ModelUse& use : program.uses_of(program.edges[edge])) {
        auto& users = users_[use.model];
        if (users.empty() || users.back().program != index) {
          users.push_back({index, std::vector<bool>(program.states.size())});
        }
        users.back().uses[actors_[index].sources[edge]] = true;
      }
    }
  }
}

// The steps of check/system/system.cpp, for each state of the model.
void PackedSystem::add_action(const ModelUse& use) {
  ActionTable& table = tables_[use.model][action_index(use)];
  if (table.first != no_table) return;
  const ModelInstance& model = system_->models[use.model];
  const InterfaceAutomaton& automaton = model.automaton;
  table.first = static_cast<std::uint32_t>(targets_.size());
  table.sources.resize(automaton.size());
  for (StateId at = 0; at < automaton.size(); ++at) {
    std::vector<Target> steps;
    for (const ModelStep& met : model_steps(model, at, use)) {
      auto& sources = table.sources[met.target];
      Target step;
      step.state = met.target;
      step.is_cut = cuts(model, met) ? 1 : 0;
      has_cuts_ = has_cuts_ || step.is_cut != 0;
      step.code = static_cast<std::uint32_t>(sources.size()) & 0x7fffffff;
      sources.push_back({at, met.is_beyond});
      steps.push_back(step);
    }
    Target target;
    if (steps.size() == 1) target = steps.front();
    if (steps.size() > 1) {
      table.is_deterministic = false;
      target.state = several;
      target.code = static_cast<std::uint32_t>(several_.size()) & 0x7fffffff;
      several_.push_back(std::move(steps));
    }
    targets_.push_back(target);
  }
  MAIDE_CHECK(targets_.size() < first_combined);
  std::size_t most = 1;
  for (const auto& sources : table.sources) most = std::max(most, sources.size());
  table.source_bits = bits_for(most);
}

void PackedSystem::number_codes() {
  std::size_t most_into = 1;
  for (const PackedActor& actor : actors_) {
    for (const auto& edges : actor.edges_into) most_into = std::max(most_into, edges.size());
  }
  actor_bits_ = bits_for(actors_.size());
  into_bits_ = bits_for(most_into);
  const unsigned shift = actor_bits_ + into_bits_;
  const unsigned room = shift < most_code_bits ? most_code_bits - shift : 0;
  bool keeps = false;
  for (std::size_t actor = 0; actor < actors_.size(); ++actor) {
    for (std::size_t action = 0; action < actors_[actor].edges.size(); ++action) {
      const auto uses = uses_of(actor, action);
      const unsigned bits = source_bits_of(uses);
      // Each use for itself has room, or no step has.
      const bool is_kept = bits > room && std::ranges::all_of(uses, [&](const ModelUse& use) {
                             return table_of(use).source_bits <= room;
                           });
      keeps = keeps || is_kept;
      if (!is_kept) most_source_bits_ = std::max(most_source_bits_, bits);
    }
  }
  if (keeps) {
    most_source_bits_ = std::max(most_source_bits_, std::min(room, most_kept_bits));
    kept_ = std::make_unique<KeptLists>(most_source_bits_);
  }
  code_bits_ = shift + most_source_bits_;
  for (Target& target : targets_) {
    if (target.state < several) target.code = (target.code << shift) & 0x7fffffff;
  }
  for (auto& steps : several_) {
    for (Target& target : steps) target.code = (target.code << shift) & 0x7fffffff;
  }
}

// First fit, the largest first; in one word if that is enough.
void PackedSystem::lay_out(unsigned payload_bits, std::size_t monitor_states) {
  std::vector<std::pair<unsigned, PackedField*>> fields;
  models_.resize(system_->models.size());
  for (std::size_t i = 0; i < models_.size(); ++i) {
    fields.emplace_back(bits_for(system_->models[i].automaton.size()), &models_[i]);
  }
  for (std::size_t i = 0; i < program_count_; ++i) {
    fields.emplace_back(bits_for(system_->programs[i].states.size()), &actors_[i].field);
  }
  fields.emplace_back(bits_for(monitor_states), &monitor_);
  for (const auto& [bits, field] : fields) state_bits_ += bits;
  std::ranges::stable_sort(
      fields, [](const auto& left, const auto& right) { return left.first > right.first; });
  const bool is_one_word = state_bits_ <= 64 && state_bits_ + payload_bits <= most_bits_together;
  std::vector<unsigned> used{0};
  for (const auto& [bits, field] : fields) {
    std::size_t word = 0;
    const auto fits = [&, width = bits](std::size_t at) {
      return used[at] + width <= (at == 0 && !is_one_word ? first_word : 64);
    };
    while (word < used.size() && !fits(word)) ++word;
    if (word == used.size()) used.push_back(0);
    field->word = static_cast<std::uint8_t>(word);
    // A field of no bits may come when a word is full: anywhere will do.
    field->shift = static_cast<std::uint8_t>(std::min(used[word], 63U));
    field->mask = low_bits(bits);
    used[word] += bits;
  }
  MAIDE_CHECK(std::ranges::all_of(used, [](unsigned bits) { return bits <= 64; }));
  words_ = used.size();
  address_bits_ = used.front();
  if (words_ > most_words || payload_bits > most_payload || code_bits_ > most_code_bits) {
    throw UsageError(
        fmt::format("{}: the system is too large for the engine native: {} bits a state, {} a step",
                    system_->file, state_bits_, payload_bits));
  }
}

// What depends on where the fields are.
void PackedSystem::place_fields() {
  for (std::size_t index = 0; index < actors_.size(); ++index) {
    PackedActor& packed = actors_[index];
    for (ControlState target = 0; target < packed.edges_into.size(); ++target) {
      const auto& edges = packed.edges_into[target];
      for (std::size_t place = 0; place < edges.size(); ++place) {
        PackedEdge& compiled = packed.edges[edges[place]];
        compiled.code = static_cast<std::uint32_t>(index | (place << actor_bits_));
        MAIDE_CHECK(compiled.code <= low_bits(actor_bits_ + into_bits_));
        compiled.control_change = (std::uint64_t{target} - packed.sources[edges[place]])
                                  << packed.field.shift;
        place_uses(uses_of(index, edges[place]), compiled);
      }
    }
  }
}

void PackedSystem::place_uses(std::span<const ModelUse> uses, PackedEdge& compiled) {
  if (uses.empty()) return;
  if (uses.size() == 1 && table_of(uses.front()).is_deterministic) {
    compiled.model = models_[uses.front().model];
    compiled.table = table_of(uses.front()).first;
    MAIDE_CHECK(compiled.table < first_combined);
    return;
  }
  PackedCombination& combined = combined_.emplace_back();
  combined.is_kept = is_kept(uses);
  compiled.table = first_combined + static_cast<std::uint32_t>(combined_.size() - 1);
  unsigned code_shift = 0;
  for (const ModelUse& use : uses) {
    const ActionTable& table = table_of(use);
    MAIDE_CHECK(table.first != no_table);
    combined.uses.push_back({models_[use.model], table.first, code_shift});
    code_shift += table.source_bits;
  }
}

unsigned PackedSystem::source_bits_of(std::span<const ModelUse> uses) const {
  unsigned bits = 0;
  for (const ModelUse& use : uses) bits += table_of(use).source_bits;
  return bits;
}

bool PackedSystem::is_kept(std::span<const ModelUse> uses) const {
  return source_bits_of(uses) > most_source_bits_;
}

StepBefore PackedSystem::undo(const GlobalState& state, std::uint64_t code) const {
  const auto cut_off = [&code](unsigned bits) {
    const std::uint64_t value = code & low_bits(bits);
    code >>= bits;
    return static_cast<std::size_t>(value);
  };
  StepBefore origin{{}, state};
  const std::size_t index = cut_off(actor_bits_);
  const std::size_t place = cut_off(into_bits_);
  const PackedActor& actor = actors_.at(index);
  const bool is_program = index < program_count_;
  origin.step.actor = is_program ? static_cast<std::uint32_t>(index) : nobody;
  origin.step.action = actor.edges_into.at(is_program ? state.programs[index] : 0).at(place);
  if (is_program) origin.before.programs[index] = actor.sources[origin.step.action];
  const auto uses = uses_of(index, origin.step.action);
  std::vector<std::uint32_t> kept;
  if (is_kept(uses)) kept = kept_->at(std::exchange(code, 0));
  for (std::size_t at = 0; at < uses.size(); ++at) {
    const ModelUse& use = uses[at];
    const ActionTable& table = table_of(use);
    // Behind a single use there is room for that of any other.
    const std::size_t source = !kept.empty()      ? kept[at]
                               : uses.size() == 1 ? static_cast<std::size_t>(std::exchange(code, 0))
                                                  : cut_off(table.source_bits);
    const Source& from = table.sources.at(state.models[use.model]).at(source);
    origin.step.targets.push_back(state.models[use.model]);
    origin.step.is_beyond = origin.step.is_beyond || from.is_beyond;
    const ModelStep met{state.models[use.model], from.is_beyond};
    origin.step.is_cut = origin.step.is_cut || cuts(system_->models[use.model], met);
    origin.before.models[use.model] = from.state;
  }
  MAIDE_CHECK(code == 0);
  return origin;
}

std::uint64_t KeptLists::number_of(std::span<const std::uint32_t> list) {
  std::uint64_t hash = hash_start;
  for (const std::uint32_t each : list) hash = hash_mix(hash, each);
  const std::lock_guard lock(mutex_);
  std::uint64_t number = hash & low_bits(bits_);
  for (;; number = (number + 1) & low_bits(bits_)) {
    const auto place = lists_.find(number);
    if (place == lists_.end()) break;
    if (std::ranges::equal(place->second, list)) return number;
  }
  // The last place stays free, so that looking for one ends.
  if (lists_.size() >= low_bits(bits_)) {
    throw UsageError(
        "the steps of the system forget too much in too many ways for the engine native");
  }
  lists_.emplace(number, std::vector<std::uint32_t>(list.begin(), list.end()));
  return number;
}

std::vector<std::uint32_t> KeptLists::at(std::uint64_t number) const {
  const std::lock_guard lock(mutex_);
  return lists_.at(number);
}

template <std::size_t words>
void PackedSystem::check_steps() const {
  GlobalState state = initial_state(*system_);
  for (std::size_t index = 0; index < actors_.size(); ++index) {
    for (std::uint32_t edge = 0; edge < actors_[index].edges.size(); ++edge) {
      const auto uses = uses_of(index, edge);
      const auto check = [&] {
        if (index < program_count_) state.programs[index] = actors_[index].sources[edge];
        const PackedState<words> packed = pack<words>(state);
        MAIDE_CHECK_ALWAYS(unpack(packed) == state);
        for_each_step(
            packed, index,
            [&](const PackedState<words>& next, std::uint32_t by, bool, std::uint64_t code) {
              MAIDE_CHECK_ALWAYS(code <= low_bits(code_bits_));
              const StepBefore origin = undo(unpack(next), code);
              MAIDE_CHECK_ALWAYS(origin.before == state && origin.step.action == by);
            });
      };
      if (uses.empty()) check();
      for (const ModelUse& use : uses) {
        const StateId first = state.models[use.model];
        for (StateId at = 0; at < system_->models[use.model].automaton.size(); ++at) {
          state.models[use.model] = at;
          check();
        }
        state.models[use.model] = first;
      }
    }
    state = initial_state(*system_);
  }
}

void PackedSystem::check_invariants() const {
  std::vector<std::uint64_t> taken(words_, 0);
  std::vector<PackedField> fields = models_;
  for (const PackedActor& actor : actors_) fields.push_back(actor.field);
  fields.push_back(monitor_);
  for (const PackedField& field : fields) {
    const std::uint64_t bits = field.mask << field.shift;
    MAIDE_CHECK_ALWAYS((bits >> field.shift) == field.mask && (taken.at(field.word) & bits) == 0);
    taken[field.word] |= bits;
  }
  MAIDE_CHECK_ALWAYS(taken.front() <= low_bits(address_bits_));
  with_words(words_, [&](auto words) { check_steps<decltype(words)::value>(); });
}

}  // namespace maide
