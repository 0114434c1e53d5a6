#include "maide/check/reduce/stubborn_sets.hpp"

#include <algorithm>
#include <utility>

#include "maide/base/invariant.hpp"

namespace maide {
namespace {

std::uint64_t bit(std::size_t index) { return std::uint64_t{1} << index; }

}  // namespace

StubbornSets::StubbornSets(const PackedSystem& packed, StubbornOptions options)
    : packed_(packed), options_(std::move(options)) {
  const System& system = packed.system();
  programs_.resize(packed.actor_count());
  if (programs_.size() > most_reduced_programs) return;
  const std::vector<std::vector<ModelUse>> actions = find_actions(system);
  for (std::size_t m = 0; m < system.models.size(); ++m) {
    // More actions than bits: the system is not reduced.
    if (actions[m].size() > 64) {
      programs_.resize(most_reduced_programs + 1);
      return;
    }
    models_.push_back({Commutation(system.models[m], actions[m], options_.watch), {}});
  }
  for (std::size_t p = 0; p < system.programs.size(); ++p) add_program(p, actions);
  if (packed.actor_count() > packed.program_count()) add_nobody(actions);
  control_.resize(programs_.size());
  now_.resize(programs_.size());
  at_.resize(models_.size());
}

void StubbornSets::add_next(std::size_t index, std::span<const ModelUse> uses, bool is_visible,
                            const std::vector<std::vector<ModelUse>>& actions) {
  ReducedProgram& reduced = programs_[index];
  Next next;
  next.is_visible = is_visible;
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

void StubbornSets::add_nobody(const std::vector<std::vector<ModelUse>>& actions) {
  const std::size_t index = packed_.program_count();
  const auto& nobodys = packed_.system().nobodys_actions;
  ReducedProgram& reduced = programs_[index];
  for (std::size_t i = 0; i < nobodys.size(); ++i) {
    add_next(index, nobodys[i].what.uses, !options_.visible.empty() && options_.visible[index][i],
             actions);
  }
  reduced.first = {0, static_cast<std::uint32_t>(nobodys.size())};
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
  ReducedProgram& reduced = programs_[index];
  for (const Program::State& state : program.states) reduced.first.push_back(state.first_edge);
  reduced.first.push_back(static_cast<std::uint32_t>(program.edges.size()));
  for (std::size_t i = 0; i < program.edges.size(); ++i) {
    const ProgramEdge& edge = program.edges[i];
    // Behind an error nothing comes that others would have done.
    const bool is_visible =
        program.is_error(edge.target) || (!options_.visible.empty() && options_.visible[index][i]);
    add_next(index, program.uses_of(edge), is_visible, actions);
  }
  for (const std::uint32_t first : reduced.first) {
    reduced.first_use.push_back(first < reduced.next.size()
                                    ? reduced.next[first].first_use
                                    : static_cast<std::uint32_t>(reduced.uses.size()));
  }
  compute_future(program, reduced);
}

// Backwards from each edge; a control state is looked at again when what follows it has grown.
void StubbornSets::compute_future(const Program& program, ReducedProgram& reduced) {
  const std::size_t width = reduced.models.size();
  reduced.future.assign(program.states.size() * width, 0);
  std::vector<std::vector<ControlState>> before(program.states.size());
  std::vector<ControlState> open;
  for (ControlState at = 0; at < program.states.size(); ++at) {
    for (std::uint32_t i = reduced.first[at]; i < reduced.first[at + 1]; ++i) {
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

StubbornSets::Now StubbornSets::look_at(std::size_t program) const {
  const ReducedProgram& reduced = programs_[program];
  Now now;
  const ControlState at = control_[program];
  for (std::uint32_t i = reduced.first[at]; i < reduced.first[at + 1]; ++i) {
    const Next& next = reduced.next[i];
    const auto uses = reduced.uses_of(next);
    std::uint32_t steps = 1;
    for (const Use& use : uses) {
      steps *= static_cast<std::uint32_t>(
          models_[use.model].commutation.count(use.action, at_[use.model]));
    }
    if (steps == 0) continue;
    now.steps += steps;
    now.is_visible =
        now.is_visible || next.is_visible ||
        (options_.cuts_are_visible && std::ranges::any_of(uses, [&](const Use& use) {
           return models_[use.model].commutation.may_be_cut(use.action, at_[use.model]);
         }));
  }
  return now;
}

std::uint64_t StubbornSets::select_here() {
  std::uint64_t able = 0;
  for (std::size_t p = 0; p < programs_.size(); ++p) {
    now_[p] = look_at(p);
    if (now_[p].steps > 0) able |= bit(p);
  }
  std::uint64_t best = able;
  std::uint32_t least = ~std::uint32_t{0};
  for (std::uint64_t left = able; left != 0 && (able & (able - 1)) != 0; left &= left - 1) {
    const auto seed = static_cast<std::size_t>(std::countr_zero(left));
    if (now_[seed].is_visible) continue;
    const std::uint64_t set = closure(seed);
    if (set == 0 || (set & able) == able) continue;
    std::uint32_t steps = 0;
    bool is_visible = false;
    for (std::uint64_t rest = set & able; rest != 0; rest &= rest - 1) {
      const Now& now = now_[static_cast<std::size_t>(std::countr_zero(rest))];
      steps += now.steps;
      is_visible = is_visible || now.is_visible;
    }
    if (is_visible || steps >= least) continue;
    best = set & able;
    least = steps;
    MAIDE_CHECK(best != 0 && (best & bit(seed)) != 0);
    if (steps == 1) break;
  }
  is_reduced_ = best != able;
  MAIDE_CHECK((best & ~able) == 0 && (best == 0) == (able == 0));
  return best;
}

std::uint64_t StubbornSets::closure(std::size_t program) {
  std::uint64_t set = bit(program), open = set;
  while (open != 0) {
    const auto member = static_cast<std::size_t>(std::countr_zero(open));
    open &= open - 1;
    const ReducedProgram& reduced = programs_[member];
    const ControlState at = control_[member];
    for (std::uint32_t i = reduced.first_use[at]; i < reduced.first_use[at + 1]; ++i) {
      const std::uint64_t added = disturbers(reduced.uses[i], set);
      if (added != 0 && options_.singletons) return 0;
      MAIDE_CHECK((added & set) == 0);
      set |= added;
      open |= added;
    }
  }
  return set;
}

std::uint64_t StubbornSets::future_of(const User& user) const {
  const ReducedProgram& reduced = programs_[user.program];
  MAIDE_CHECK(user.slot < reduced.models.size());
  return reduced.future[control_[user.program] * reduced.models.size() + user.slot];
}

// One program alone if that is enough, else all that use the model.
std::uint64_t StubbornSets::disturbers(const Use& use, std::uint64_t set) {
  ReducedModel& model = models_[use.model];
  const StateId at = at_[use.model];
  std::uint64_t users = 0, actions = 0;
  for (const User& user : model.users) {
    const std::uint64_t future = (set >> user.program & 1) != 0 ? 0 : future_of(user);
    if (future == 0) continue;
    users |= bit(user.program);
    actions |= future;
  }
  if (actions == 0 || model.commutation.undisturbed(use.action, actions)[at] != 0) return 0;
  if ((users & (users - 1)) == 0) return users;
  for (const User& left_out : model.users) {
    if ((users >> left_out.program & 1) == 0) continue;
    std::uint64_t rest = 0;
    for (const User& user : model.users) {
      if (user.program != left_out.program && (users >> user.program & 1) != 0) {
        rest |= future_of(user);
      }
    }
    if (model.commutation.undisturbed(use.action, rest)[at] != 0) return bit(left_out.program);
  }
  return users;
}

}  // namespace maide
