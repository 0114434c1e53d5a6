#include "maide/check/reduce/stubborn_sets.hpp"

#include <algorithm>
#include <utility>

#include "maide/base/invariant.hpp"

namespace maide {
namespace {

// Most pairs of actions of one model, times its states. To find out what they do to one another
// would take longer than it saves, and more memory than the search.
constexpr std::uint64_t most_reduced_pairs = std::uint64_t{1} << 20;

std::uint64_t bit(std::size_t index) { return std::uint64_t{1} << index; }

}  // namespace

StubbornSets::StubbornSets(const PackedSystem& packed, StubbornOptions options)
    : packed_(packed), options_(std::move(options)) {
  const System& system = packed.system();
  actors_.resize(packed.actor_count());
  if (actors_.size() > most_actors_in_a_word) return;
  const std::vector<std::vector<ModelUse>> actions = find_actions(system);
  const std::vector<std::uint64_t> strongly_fair = find_strongly_fair(actions);
  for (std::size_t m = 0; m < system.models.size(); ++m) {
    // More actions than bits: the system is not reduced.
    if (actions[m].size() > 64) {
      actors_.resize(most_actors_in_a_word + 1);
      return;
    }
    ReducedModel& model = models_.emplace_back();
    if (system.models[m].automaton.size() * actions[m].size() * actions[m].size() <=
        most_reduced_pairs) {
      model.commutation.emplace(system.models[m], actions[m], options_.watch, strongly_fair[m]);
    }
  }
  for (std::size_t p = 0; p < system.programs.size(); ++p) add_program(p, actions);
  for (std::size_t p = packed.program_count(); p < actors_.size(); ++p) add_part(p, actions);
  control_.resize(actors_.size());
  now_.resize(actors_.size());
  at_.resize(models_.size());
}

// By model: the actions of steps to whose groups weakly fair runs are fair as to programs strongly
// fair ones.
std::vector<std::uint64_t> StubbornSets::find_strongly_fair(
    const std::vector<std::vector<ModelUse>>& actions) const {
  std::vector<std::uint64_t> found(actions.size(), 0);
  if (options_.watch != Commutation::Watch::weak) return found;
  for (std::size_t actor = 0; actor < packed_.actor_count(); ++actor) {
    const auto [first, end] = packed_.edges_of(actor);
    for (std::uint32_t i = first; i < end; ++i) {
      if (!packed_.is_fair_on_weak_runs(actor, i)) continue;
      for (const ModelUse& use : packed_.uses_of(actor, i)) {
        const std::uint32_t action = action_number(actions[use.model], use);
        if (action < 64) found[use.model] |= bit(action);
      }
    }
  }
  return found;
}

void StubbornSets::add_next(std::size_t index, std::span<const ModelUse> uses, bool is_visible,
                            bool is_due, const std::vector<std::vector<ModelUse>>& actions) {
  ReducedActor& reduced = actors_[index];
  Next next;
  next.is_visible = is_visible;
  next.is_due = is_due;
  next.first_use = static_cast<std::uint32_t>(reduced.uses.size());
  for (const ModelUse& use : uses) {
    const std::uint32_t action = action_number(actions[use.model], use);
    MAIDE_CHECK(action < actions[use.model].size());
    reduced.uses.push_back({use.model, action});
    ++next.use_count;
    auto& models = reduced.models;
    if (std::ranges::find(models, use.model) == models.end()) {
      models_[use.model].users.push_back(
          {static_cast<std::uint32_t>(index), static_cast<std::uint32_t>(models.size())});
      models.push_back(use.model);
    }
  }
  reduced.next.push_back(next);
}

// Runs are fair to a group, of which they may take another action: all are in that part, and none
// ends a program's call.
bool StubbornSets::is_due(const NobodysAction& action, std::size_t part) const {
  if (!action.counts_for_deadlock) return false;
  if (options_.watch == Commutation::Watch::nothing) return true;
  if (action.what.fair == 0) return false;
  const auto& programs = packed_.system().programs;
  const bool is_of_calls = std::ranges::any_of(programs, [&](const Program& program) {
    return std::ranges::any_of(program.edges, [&](const ProgramEdge& edge) {
      return program.nobodys_group_of(edge) == action.what.fair;
    });
  });
  if (is_of_calls) return false;
  const std::span all(packed_.system().nobodys_actions);
  const auto [first, end] = packed_.edges_of(part);
  const auto is_in_group = [&](const NobodysAction& other) {
    return other.what.fair == action.what.fair;
  };
  return std::ranges::none_of(all.first(first), is_in_group) &&
         std::ranges::none_of(all.subspan(end), is_in_group);
}

void StubbornSets::add_part(std::size_t index, const std::vector<std::vector<ModelUse>>& actions) {
  const auto& nobodys = packed_.system().nobodys_actions;
  const auto& visible = options_.visible;
  const auto [first, end] = packed_.edges_of(index);
  ReducedActor& reduced = actors_[index];
  for (std::uint32_t i = first; i < end; ++i) {
    add_next(index, nobodys[i].what.uses, !visible.empty() && visible[packed_.program_count()][i],
             is_due(nobodys[i], index), actions);
  }
  reduced.first_edge = first;
  reduced.first_use = {0, static_cast<std::uint32_t>(reduced.uses.size())};
  reduced.future.assign(reduced.models.size(), 0);
  for (const Use& use : reduced.uses) {
    const auto slot = std::ranges::find(reduced.models, use.model);
    reduced.future[static_cast<std::size_t>(slot - reduced.models.begin())] |= bit(use.action);
  }
}

void StubbornSets::add_program(std::size_t index,
                               const std::vector<std::vector<ModelUse>>& actions) {
  const Program& program = packed_.system().programs[index];
  ReducedActor& reduced = actors_[index];
  const bool is_asked = options_.watch == Commutation::Watch::nothing || program.flags.is_fair;
  for (std::size_t i = 0; i < program.edges.size(); ++i) {
    const ProgramEdge& edge = program.edges[i];
    // Behind an error nothing comes that others would have done.
    const bool is_visible =
        program.is_error(edge.target) || (!options_.visible.empty() && options_.visible[index][i]);
    add_next(index, program.uses_of(edge), is_visible, is_asked && program.is_progress(edge),
             actions);
  }
  const auto end = static_cast<std::uint32_t>(reduced.uses.size());
  for (const Program::State& state : program.states) {
    reduced.first_use.push_back(
        state.first_edge < reduced.next.size() ? reduced.next[state.first_edge].first_use : end);
  }
  reduced.first_use.push_back(end);
  compute_future(program, reduced);
}

// Backwards from each edge; a control state is looked at again when what follows it has grown.
void StubbornSets::compute_future(const Program& program, ReducedActor& reduced) {
  const std::size_t width = reduced.models.size();
  reduced.future.assign(program.states.size() * width, 0);
  std::vector<std::vector<ControlState>> before(program.states.size());
  std::vector<ControlState> open;
  for (ControlState at = 0; at < program.states.size(); ++at) {
    const Program::State& state = program.states[at];
    for (std::uint32_t i = state.first_edge; i < state.first_edge + state.edge_count; ++i) {
      before[program.edges[i].target].push_back(at);
      for (const Use& use : reduced.uses_of(reduced.next[i])) {
        const auto slot = static_cast<std::size_t>(std::ranges::find(reduced.models, use.model) -
                                                   reduced.models.begin());
        reduced.future[at * width + slot] |= bit(use.action);
      }
    }
    open.push_back(at);
  }
  while (!open.empty()) {
    const ControlState at = open.back();
    open.pop_back();
    for (const ControlState source : before[at]) {
      bool grows = false;
      for (std::size_t slot = 0; slot < width; ++slot) {
        std::uint64_t& actions = reduced.future[source * width + slot];
        const std::uint64_t all = actions | reduced.future[at * width + slot];
        grows = grows || all != actions;
        actions = all;
      }
      if (grows) open.push_back(source);
    }
  }
  for (ControlState at = 0; at < program.states.size(); ++at) {
    for (const ControlState source : before[at]) {
      for (std::size_t slot = 0; slot < width; ++slot) {
        MAIDE_CHECK((reduced.future[at * width + slot] & ~reduced.future[source * width + slot]) ==
                    0);  // what may follow a step may follow what is before it
      }
    }
  }
}

std::uint64_t StubbornSets::select_here() {
  std::uint64_t able = 0;
  for (std::size_t a = 0; a < actors_.size(); ++a) {
    if (now_[a].steps > 0) able |= bit(a);
  }
  find_coming();
  std::uint64_t best = able;
  std::uint32_t least = ~std::uint32_t{0};
  for (std::uint64_t left = able; left != 0 && (able & (able - 1)) != 0; left &= left - 1) {
    const auto seed = static_cast<std::size_t>(std::countr_zero(left));
    if (now_[seed].is_visible) continue;
    const std::uint64_t set = closure(seed) & able;
    if (set == 0 || set == able) continue;
    std::uint32_t steps = 0;
    bool is_visible = false, is_due = false;
    for (std::uint64_t rest = set; rest != 0; rest &= rest - 1) {
      const Now& now = now_[static_cast<std::size_t>(std::countr_zero(rest))];
      steps += now.steps;
      is_visible = is_visible || now.is_visible;
      is_due = is_due || now.is_due;
    }
    if (is_visible || !is_due || steps >= least) continue;
    best = set;
    least = steps;
    MAIDE_CHECK((best & bit(seed)) != 0);
    if (steps == 1) break;
  }
  is_reduced_ = best != able;
  MAIDE_CHECK((best & ~able) == 0 && (best == 0) == (able == 0));
  return best;
}

void StubbornSets::find_coming() {
  idle_ = 0;
  for (std::size_t a = packed_.program_count(); a < actors_.size(); ++a) {
    const ReducedActor& part = actors_[a];
    const bool comes = std::ranges::any_of(part.next, [&](const Next& next) {
      return std::ranges::all_of(part.uses_of(next), [&](const Use& use) { return may_come(use); });
    });
    if (!comes) idle_ |= bit(a);
  }
}

// Programs and parts of nobody are taken to do all that they have to come, idle or not.
bool StubbornSets::may_come(const Use& use) {
  ReducedModel& model = models_[use.model];
  std::uint64_t actions = 0;
  for (const User& user : model.users) actions |= future_of(user);
  return !model.commutation ||
         model.commutation->may_come(use.action, actions)[at_[use.model]] != 0;
}

std::uint64_t StubbornSets::closure(std::size_t actor) {
  std::uint64_t set = bit(actor), open = set;
  while (open != 0) {
    const auto member = static_cast<std::size_t>(std::countr_zero(open));
    open &= open - 1;
    const ReducedActor& reduced = actors_[member];
    const ControlState at = control_[member];
    for (std::uint32_t i = reduced.first_use[at]; i < reduced.first_use[at + 1]; ++i) {
      const std::uint64_t added = disturbers(reduced.uses[i], set);
      MAIDE_CHECK((added & set) == 0);
      set |= added;
      open |= added;
    }
    for (std::uint64_t rest = open; options_.one_can_step && rest != 0; rest &= rest - 1) {
      if (now_[static_cast<std::size_t>(std::countr_zero(rest))].steps > 0) return 0;
    }
  }
  return set;
}

std::uint64_t StubbornSets::future_of(const User& user) const {
  const ReducedActor& reduced = actors_[user.actor];
  MAIDE_CHECK(user.slot < reduced.models.size());
  return reduced.future[control_[user.actor] * reduced.models.size() + user.slot];
}

// One actor alone if that is enough, else all that use the model.
std::uint64_t StubbornSets::disturbers(const Use& use, std::uint64_t set) {
  ReducedModel& model = models_[use.model];
  const StateId at = at_[use.model];
  std::uint64_t users = 0, actions = 0;
  for (const User& user : model.users) {
    const std::uint64_t future = ((set | idle_) >> user.actor & 1) != 0 ? 0 : future_of(user);
    if (future == 0) continue;
    users |= bit(user.actor);
    actions |= future;
  }
  if (actions == 0) return 0;
  if (!model.commutation) return users;
  if (model.commutation->undisturbed(use.action, actions)[at] != 0) return 0;
  if ((users & (users - 1)) == 0) return users;
  for (const User& left_out : model.users) {
    if ((users >> left_out.actor & 1) == 0) continue;
    std::uint64_t rest = 0;
    for (const User& user : model.users) {
      if (user.actor != left_out.actor && (users >> user.actor & 1) != 0) rest |= future_of(user);
    }
    if (model.commutation->undisturbed(use.action, rest)[at] != 0) return bit(left_out.actor);
  }
  return users;
}

}  // namespace maide
