// A system as tables, for exploring it fast. A global state is a few machine words in which each
// component has a field. A step that uses one model changes two fields by one addition each; one
// that uses several, a field more for each. Everything that depends on
// the text of programs and models is worked out beforehand, once for each program edge and model
// state. The meaning is that of check/system/system.hpp; tests hold the two against one another.
//
// Each step also has a code of a few bits. The code and the state after the step tell the state
// before it. Stored with each state, the codes are the search's tree. Where a step forgets more
// than a code has room for (a reader dies, and all that is on its way to it is gone), what it
// forgot is kept beside, and the code is its number there.
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

#include "maide/base/invariant.hpp"
#include "maide/check/packed/bits.hpp"
#include "maide/check/packed/state_table.hpp"
#include "maide/check/system/steps.hpp"

namespace maide {

// Programs and parts of nobody of which a set is one word of bits. In a system of more nobody is
// one part, and reductions do not reduce it.
inline constexpr std::size_t most_actors_in_a_word = 64;

// Where a component's state lies.
struct PackedField {
  std::uint8_t word = 0, shift = 0;
  std::uint64_t mask = 0;  // before the shift
  template <std::size_t words>
  std::uint32_t get(const PackedState<words>& state) const {
    return static_cast<std::uint32_t>((state[word] >> shift) & mask);
  }
  template <std::size_t words>
  void set(PackedState<words>& state, std::uint32_t value) const {
    state[word] = (state[word] & ~(mask << shift)) | (std::uint64_t{value} << shift);
  }
};

// Numbers for lists of numbers, which are kept. The number of a list is its hash, or the next one
// that is free, so that it hardly depends on who came first. Threads may use it at once.
class KeptLists {
 public:
  // Numbers have so many bits: 1..32.
  explicit KeptLists(unsigned bits) : bits_(bits) {}
  // Throws UsageError if all numbers are taken.
  std::uint64_t number_of(std::span<const std::uint32_t> list);
  std::vector<std::uint32_t> at(std::uint64_t number) const;

 private:
  unsigned bits_;
  mutable std::mutex mutex_;
  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> lists_;
};

class PackedSystem {
 public:
  static constexpr std::size_t most_words = 64;
  // Keeps a reference. Lays states out so that a StateTable can carry max(code_bits(),
  // least_payload_bits) with each; at most 32. Throws UsageError for a system that needs more than
  // most_words words. `monitor_states`: a field more, for the state of something that watches.
  explicit PackedSystem(const System& system, unsigned least_payload_bits = 0,
                        std::size_t monitor_states = 1);

  const System& system() const { return *system_; }
  std::size_t words() const { return words_; }
  unsigned address_bits() const { return address_bits_; }
  unsigned state_bits() const { return state_bits_; }
  unsigned code_bits() const { return code_bits_; }
  // Some steps' codes mean nothing to another PackedSystem of the same system.
  bool has_kept_codes() const { return kept_ != nullptr; }

  template <std::size_t words>
  PackedState<words> pack(const GlobalState& state) const {
    PackedState<words> packed{};
    for (std::size_t i = 0; i < program_count_; ++i) {
      MAIDE_CHECK(state.programs[i] <= actors_[i].field.mask);
      actors_[i].field.set(packed, state.programs[i]);
    }
    for (std::size_t i = 0; i < models_.size(); ++i) models_[i].set(packed, state.models[i]);
    return packed;
  }
  template <std::size_t words>
  GlobalState unpack(const PackedState<words>& packed) const {
    GlobalState state;
    for (const PackedField& model : models_) state.models.push_back(model.get(packed));
    for (std::size_t i = 0; i < program_count_; ++i) {
      state.programs.push_back(actors_[i].field.get(packed));
    }
    return state;
  }

  // 0 in a packed state, until it is set.
  const PackedField& monitor() const { return monitor_; }

  std::size_t program_count() const { return program_count_; }
  // Programs, then parts of nobody, if he has actions: each is always in control state 0. A part
  // has actions that stand side by side, those of one wire for instance, and keeps their numbers.
  std::size_t actor_count() const { return actors_.size(); }
  // Its edges, or actions of nobody, are those from the first up to the second.
  std::pair<std::uint32_t, std::uint32_t> edges_of(std::size_t actor) const {
    return {actors_[actor].first_edge.front(), actors_[actor].first_edge.back()};
  }
  // What the program's edge, or the action of nobody, does with models.
  std::span<const ModelUse> uses_of(std::size_t actor, std::size_t action) const;
  template <std::size_t words>
  ControlState control(const PackedState<words>& state, std::size_t actor) const {
    return actors_[actor].field.get(state);
  }
  template <std::size_t words>
  StateId model_state(const PackedState<words>& state, std::size_t model) const {
    return models_[model].get(state);
  }
  // The program has ended, or may stand there for ever.
  template <std::size_t words>
  bool is_at_rest(const PackedState<words>& state, std::size_t program) const {
    const PackedActor& compiled = actors_[program];
    return compiled.may_stay[compiled.field.get(state)];
  }
  template <std::size_t words>
  bool is_at_rest(const PackedState<words>& state) const {
    for (std::size_t program = 0; program < program_count_; ++program) {
      if (!is_at_rest(state, program)) return false;
    }
    return true;
  }
  // A program is at an error: nothing follows, and the steps there do not count.
  template <std::size_t words>
  bool is_error(const PackedState<words>& state) const {
    return has_errors() && is_any_at_error(state);
  }
  // Any control state, reached or not, is an error.
  bool has_errors() const { return !erring_.empty(); }
  // Some step is no progress: a death, mostly (Program::is_progress).
  bool has_idle_steps() const { return has_idle_steps_; }
  // Each step is progress, and none comes to an error, belongs to a fair group, or uses several
  // models.
  bool has_plain_steps_only() const {
    return !has_errors() && !has_idle_steps_ && weak_groups_.empty() && combined_.empty();
  }
  bool is_progress(std::size_t actor, std::uint32_t action) const {
    return !has_idle_steps_ || !actors_[actor].is_idle[action];
  }
  // The step is the actor's own: for fairness, what befalls a program is not.
  bool is_own(std::size_t actor, std::uint32_t action) const {
    return !has_fates_ || !actors_[actor].is_fate[action];
  }
  // Programs that fair runs are fair to.
  template <typename Bits>
  Bits fair_programs() const {
    Bits fair{};
    for (std::size_t program = 0; program < program_count_; ++program) {
      if (system_->programs[program].flags.is_fair) fair |= bit_of<Bits>(program);
    }
    return fair;
  }
  // The program has a step that is possible and is progress.
  template <std::size_t words>
  bool can_step(const PackedState<words>& state, std::size_t program) const {
    bool can = false;
    for_each_step(state, program,
                  [&](const PackedState<words>&, std::uint32_t edge, bool, std::uint64_t) {
                    can = can || is_progress(program, edge);
                  });
    return can;
  }

  // Fair groups of all programs (FairGroup), then nobody's, by number.
  std::size_t group_count() const { return weak_groups_.size(); }
  // Those that are fair on weakly fair runs, too.
  bool has_groups_on_weak_runs() const { return has_weak_groups_; }
  template <typename Bits>
  Bits groups_on_weak_runs() const {
    Bits groups{};
    for (std::size_t group = 0; group < weak_groups_.size(); ++group) {
      if (weak_groups_[group]) groups |= bit_of<Bits>(group);
    }
    return groups;
  }
  // Programs, by bit, that cannot step in the middle of that step of another program, though they
  // may be able to before and after it: it is a call (merged_calls.hpp) to the model that they wait
  // for.
  bool has_calls() const { return !users_.empty(); }
  template <typename Bits, std::size_t words>
  Bits locked_out(const PackedState<words>& state, std::size_t program, std::uint32_t edge) const {
    Bits locked{};
    const std::uint32_t model = actors_[program].called[edge];
    if (model == no_model) return locked;
    for (const User& user : users_[model]) {
      if (user.program != program && user.uses[control(state, user.program)]) {
        locked |= bit_of<Bits>(user.program);
      }
    }
    return locked;
  }

  // The bit of the action's group, if it has one.
  template <typename Bits>
  Bits group_of(std::size_t actor, std::uint32_t action) const {
    if (weak_groups_.empty()) return Bits{};
    const std::uint32_t group = actors_[actor].groups[action];
    return group == no_group ? Bits{} : bit_of<Bits>(group);
  }

  // The action's group is fair on weakly fair runs, too.
  bool is_fair_on_weak_runs(std::size_t actor, std::uint32_t action) const {
    if (!has_weak_groups_) return false;
    const std::uint32_t group = actors_[actor].groups[action];
    return group != no_group && weak_groups_[group];
  }

  // Calls `visit(next, action, is_cut, code)` for each step that `actor` can take, in a state that
  // is no error: the state afterwards, the index of the edge or of the action of nobody, whether
  // the run is cut there, and the step's code. `is_plain`: the system has_plain_steps_only().
  template <bool is_plain = false, std::size_t words, typename Visit>
  [[gnu::always_inline]] void for_each_step(const PackedState<words>& state, std::size_t actor,
                                            Visit&& visit) const {
    const PackedActor& compiled = actors_[actor];
    const ControlState at = compiled.field.get(state);
    for (std::uint32_t i = compiled.first_edge[at]; i < compiled.first_edge[at + 1]; ++i) {
      const PackedEdge& edge = compiled.edges[i];
      PackedState<words> next = state;
      next[compiled.field.word] += edge.control_change;
      std::uint64_t code = edge.code;
      bool is_cut = false;
      std::uint64_t more = 0;  // outcomes of a combined step
      const auto take_next_combined = [&] {
        const Taken<words> taken = take_combined(state, compiled, edge, --more);
        next = taken.next;
        code = taken.code;
        is_cut = taken.is_cut;
      };
      if (is_plain || edge.table < first_combined) [[likely]] {
        const std::uint32_t from = edge.model.get(state);
        const Target target = targets_[edge.table + from];
        if (target.state == none) continue;
        next[edge.model.word] += (std::uint64_t{target.state} - from) << edge.model.shift;
        code |= target.code;
        is_cut = target.is_cut != 0;
      } else {
        more = count_outcomes(state, edge);
        if (more == 0) continue;
        take_next_combined();
      }
      // The only call of `visit`: so it is compiled into the loop.
      while (true) {
        visit(next, i, is_cut, code);
        if (is_plain || more == 0) [[likely]]
          break;
        take_next_combined();
      }
    }
  }

  // Whether any step, possible or not, may cut a run.
  bool has_cuts() const { return has_cuts_; }

  // The step with that code that led to `state`, and the state before it.
  StepBefore undo(const GlobalState& state, std::uint64_t code) const;

  // Throws std::logic_error unless fields lie side by side, and every step that an edge can take in
  // a state of one of its models, the others in their first, is undone by its code. O(edges x
  // states of models).
  void check_invariants() const;

 private:
  static constexpr std::uint32_t none = ~std::uint32_t{0};
  static constexpr std::uint32_t several = none - 1;
  static constexpr std::uint32_t no_table = none;
  static constexpr std::uint32_t no_model = none;
  static constexpr std::uint32_t no_group = none;
  // The table of a choice, which uses a field of no bits: one target, which changes nothing.
  static constexpr std::uint32_t choice_table = 0;
  static constexpr std::uint32_t first_combined = std::uint32_t{1} << 31;

  // What an action of a model does in one of its states.
  struct Target {
    std::uint32_t state = none;  // or none, or several
    std::uint32_t is_cut : 1 = 0;
    std::uint32_t code : 31 = 0;  // of several: the index into several_
  };
  struct PackedEdge {
    PackedField model;
    // For one action of one model, an index into targets_. For a step that uses several models, or
    // that may lead to several states of one, first_combined and an index into combined_.
    std::uint32_t table = choice_table;
    std::uint32_t code = 0;            // actor and place among the edges into the target
    std::uint64_t control_change = 0;  // shifted
  };
  // One use of a step that uses several models, or leads to several states.
  struct PackedUse {
    PackedField model;
    std::uint32_t table = no_table;
    unsigned code_shift = 0;  // of its part of the step's code, behind that of the first use
  };
  struct PackedCombination {
    std::vector<PackedUse> uses;
    bool is_kept = false;  // where it comes from is not in the code: it is kept
  };
  // A program, or a part of nobody: its field has no bits, and its edges before the first of its
  // own are empty.
  struct PackedActor {
    PackedField field;
    std::vector<std::uint32_t> first_edge;               // by control state, one more than states
    std::vector<PackedEdge> edges;                       // as in Program::edges
    std::vector<ControlState> sources;                   // by edge
    std::vector<std::vector<std::uint32_t>> edges_into;  // by control state
    std::vector<bool> may_stay, is_error;                // by control state
    std::vector<bool> is_idle;                           // by edge: it is no progress
    std::vector<bool> is_fate;                           // so: it befalls the program (is_fate())
    std::vector<std::uint32_t> groups;                   // by edge: its fair group, or no_group
    std::vector<std::uint32_t> called;  // by edge: the model of a call, or no_model; if has_calls()
  };
  // A program, and whether it uses a model, by control state.
  struct User {
    std::uint32_t program = 0;
    std::vector<bool> uses;
  };
  // Where an action may have come from: the inverse of its table.
  struct Source {
    StateId state = 0;
    bool is_beyond = false;
  };
  struct ActionTable {
    std::uint32_t first = no_table;            // in targets_
    std::vector<std::vector<Source>> sources;  // by target state
    unsigned source_bits = 0;                  // tell which of them is meant
    bool is_deterministic = true;              // leads to at most one state
  };

  template <std::size_t words>
  bool is_any_at_error(const PackedState<words>& state) const {
    for (const std::uint32_t program : erring_) {
      const PackedActor& compiled = actors_[program];
      if (compiled.is_error[compiled.field.get(state)]) return true;
    }
    return false;
  }
  // Ways in which a combined step can be taken: the product of what each use can lead to.
  template <std::size_t words>
  [[gnu::noinline]] std::uint64_t count_outcomes(const PackedState<words>& state,
                                                 const PackedEdge& edge) const {
    std::uint64_t count = 1;
    for (const PackedUse& use : combined_[edge.table - first_combined].uses) {
      const Target& target = targets_[use.table + use.model.get(state)];
      if (target.state == none) return 0;
      if (target.state == several) count *= several_[target.code].size();
    }
    return count;
  }
  // The combined step with its outcome number `left`, counted from the last one; the last use
  // varies fastest.
  template <std::size_t words>
  struct Taken {
    PackedState<words> next;
    std::uint64_t code = 0;
    bool is_cut = false;
  };
  template <std::size_t words>
  [[gnu::noinline]] Taken<words> take_combined(const PackedState<words>& state,
                                               const PackedActor& actor, const PackedEdge& edge,
                                               std::uint64_t left) const {
    Taken<words> taken{state, edge.code, false};
    taken.next[actor.field.word] += edge.control_change;
    const PackedCombination& combined = combined_[edge.table - first_combined];
    const std::vector<PackedUse>& uses = combined.uses;
    std::vector<std::uint32_t> sources(combined.is_kept ? uses.size() : 0);
    for (std::size_t at = uses.size(); at > 0; --at) {
      const PackedUse& use = uses[at - 1];
      const std::uint32_t from = use.model.get(state);
      Target target = targets_[use.table + from];
      MAIDE_CHECK(target.state != none);
      if (target.state == several) {
        const std::vector<Target>& steps = several_[target.code];
        target = steps[steps.size() - 1 - left % steps.size()];
        left /= steps.size();
      }
      taken.next[use.model.word] += (std::uint64_t{target.state} - from) << use.model.shift;
      if (combined.is_kept) {
        sources[at - 1] = target.code >> (actor_bits_ + into_bits_);
      } else {
        taken.code |= std::uint64_t{target.code} << use.code_shift;
      }
      taken.is_cut = taken.is_cut || target.is_cut != 0;
    }
    MAIDE_CHECK(left == 0);
    if (combined.is_kept) {
      taken.code |= kept_->number_of(sources) << (actor_bits_ + into_bits_);
    }
    return taken;
  }

  std::size_t action_index(const ModelUse& use) const;
  const ActionTable& table_of(const ModelUse& use) const;
  void add_program(const Program& program);
  void add_groups(const Program& program, PackedActor& packed);
  void add_nobody();
  void add_part(std::uint32_t first, std::uint32_t end);
  void add_calls();
  void add_action(const ModelUse& use);
  void number_codes();
  // Tell together from where the uses came.
  unsigned source_bits_of(std::span<const ModelUse> uses) const;
  bool is_kept(std::span<const ModelUse> uses) const;
  void lay_out(unsigned payload_bits, std::size_t monitor_states);
  void place_fields();
  void place_uses(std::span<const ModelUse> uses, PackedEdge& compiled);
  template <std::size_t words>
  void check_steps() const;

  const System* system_;
  std::size_t program_count_ = 0;
  std::vector<PackedActor> actors_;
  std::vector<PackedField> models_;
  PackedField monitor_;
  std::vector<Target> targets_{Target{0, 0, 0}};  // the first one is that of all choices
  std::vector<std::vector<Target>> several_;
  std::vector<PackedCombination> combined_;
  std::vector<std::vector<ActionTable>> tables_;  // by model, then by action_index()
  std::size_t words_ = 1;
  unsigned address_bits_ = 0, state_bits_ = 0, code_bits_ = 0;
  unsigned actor_bits_ = 0, into_bits_ = 0;
  unsigned most_source_bits_ = 0;  // in a code; steps that need more are kept
  std::unique_ptr<KeptLists> kept_;
  bool has_cuts_ = false, has_idle_steps_ = false;
  bool has_fates_ = false;
  std::vector<std::uint32_t> erring_;  // programs with errors
  std::vector<bool> weak_groups_;      // by fair group: whether it is fair on weakly fair runs
  bool has_weak_groups_ = false;
  std::vector<std::vector<User>> users_;  // by model; none without calls
};

// Calls `work(std::integral_constant<std::size_t, n>)` with the least n that is compiled and holds
// that many words, at most most_own_words.
template <typename Work>
auto with_own_words(std::size_t words, Work&& work) {
  if (words <= 1) return work(std::integral_constant<std::size_t, 1>());
  if (words <= 2) return work(std::integral_constant<std::size_t, 2>());
  if (words <= 4) return work(std::integral_constant<std::size_t, 4>());
  return work(std::integral_constant<std::size_t, most_own_words>());
}

// And for any number of words that a system has.
template <typename Work>
auto with_words(std::size_t words, Work&& work) {
  if (words <= most_own_words) return with_own_words(words, work);
  return work(std::integral_constant<std::size_t, PackedSystem::most_words>());
}

}  // namespace maide
