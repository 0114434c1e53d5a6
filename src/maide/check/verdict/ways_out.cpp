#include "maide/check/verdict/ways_out.hpp"

#include <algorithm>
#include <functional>
#include <iterator>
#include <map>
#include <set>
#include <span>
#include <string>
#include <utility>

#include "maide/check/rules/model_words.hpp"

namespace maide {
namespace {

using UseKind = ModelUse::Kind;
using Role = CombinedStep::Role;

const std::optional<std::uint32_t> no_callback;

std::optional<std::uint32_t> started_by(const Program& program, const ProgramEdge& edge) {
  if (edge.kind != UseKind::combined) return no_callback;
  const CombinedStep& combined = program.combined[edge.index];
  if (combined.role != Role::arm && combined.role != Role::timer) return no_callback;
  return combined.callback;
}

bool is_possible_at(const ModelInstance& model, StateId at, const ModelUse& use) {
  return !model_steps(model, at, use).empty();
}

bool is_of_threads(const System& system, const ModelUse& use) {
  return system.models[use.model].source == ModelInstance::Source::executor;
}

class WayFinder {
 public:
  WayFinder(const System& system, const GlobalState& state, std::uint32_t waiting)
      : system_(system),
        state_(state),
        waiting_(waiting),
        own_(system.programs[waiting]),
        own_callbacks_(callbacks_in(own_)) {}

  std::vector<WayOut> run() {
    const ControlState at = state_.programs[waiting_];
    std::map<std::pair<int, int>, WayOut> ways;  // by the place of the arm
    for (const ProgramEdge& edge : awaited_at(own_, at)) {
      ways[{edge.line, edge.column}].edges.push_back(edge);
    }
    for (const Program::Guard& guard : closed_guards(own_, at)) {
      ways[{guard.line, guard.column}].guard = guard;
    }
    std::vector<WayOut> result;
    for (auto& [place, way] : ways) {
      if (way.guard) {
        add_openers(way);
      } else {
        add_enablers(way);
      }
      result.push_back(std::move(way));
    }
    return result;
  }

  // Who would start the callback.
  std::optional<Helper> starter(std::uint32_t callback) {
    for (std::uint32_t index = 0; index < system_.programs.size(); ++index) {
      const Program& program = system_.programs[index];
      const bool runs_it = std::ranges::any_of(program.edges, [&](const ProgramEdge& edge) {
        return started_by(program, edge) == callback;
      });
      if (runs_it) return with_obstacle_to_start(index, callback);
    }
    return std::nullopt;
  }

 private:
  // ---- Steps that make an awaited one possible ----

  // What of a model an awaited step needs, and does not have.
  using Needs = std::map<std::uint32_t, std::set<ModelUse>>;

  void add_enablers(WayOut& way) {
    Needs needs;
    for (const ProgramEdge& edge : way.edges) {
      for (const ModelUse& use : own_.uses_of(edge)) {
        if (!is_possible_at(system_.models[use.model], state_.models[use.model], use)) {
          needs[use.model].insert(use);
          add_refused(way, edge, use);
        }
      }
    }
    std::set<ModelUse> enabling;
    for (const auto& [model, uses] : needs) {
      for (const ModelUse& use : uses) find_enabling(use, enabling);
    }
    for (std::uint32_t index = 0; index < system_.programs.size(); ++index) {
      add_users(way, index, enabling);
    }
  }

  // An input, or what a step does with a model that is written by hand, by its event.
  void add_refused(WayOut& way, const ProgramEdge& edge, const ModelUse& use) const {
    if (use.kind == UseKind::give) return way.refused.push_back(use);
    if (system_.models[use.model].source != ModelInstance::Source::built_in) return;
    for (const ModelUse& event : own_.events_of(edge)) {
      if (event.kind == UseKind::give && event.model == use.model) way.refused.push_back(event);
    }
  }

  // Which uses of the same model bring it from where that one is not possible to where it is. What
  // nobody does is made possible by uses of the other models that he uses then.
  void find_enabling(const ModelUse& needed, std::set<ModelUse>& enabling) {
    const ModelInstance& model = system_.models[needed.model];
    std::vector<bool> is_enough(model.automaton.size());
    for (StateId at = 0; at < is_enough.size(); ++at) {
      const auto steps = model_steps(model, at, needed);
      is_enough[at] = std::ranges::any_of(steps, [](const auto& step) { return !step.is_beyond; });
    }
    const auto enables = [&](const ModelUse& use) {
      for (StateId at = 0; at < is_enough.size(); ++at) {
        if (is_enough[at]) continue;
        const auto steps = model_steps(model, at, use);
        if (std::ranges::any_of(steps, [&](const ModelStep& step) {
              return !step.is_beyond && is_enough[step.target];
            })) {
          return true;
        }
      }
      return false;
    };
    for (const ModelUse& use : uses_of(needed.model)) {
      if (enables(use)) enabling.insert(use);
    }
    for (const NobodysAction& action : system_.nobodys_actions) {
      const auto& uses = action.what.uses;
      if (std::ranges::none_of(uses, [&](const ModelUse& use) {
            return use.model == needed.model && enables(use);
          })) {
        continue;
      }
      for (const ModelUse& use : uses) {
        if (use.model == needed.model) continue;
        const auto others = uses_of(use.model);
        enabling.insert(others.begin(), others.end());
      }
    }
  }

  // All uses that programs make of the model.
  const std::set<ModelUse>& uses_of(std::uint32_t model) {
    const auto [known, is_new] = uses_.try_emplace(model);
    if (!is_new) return known->second;
    for (const Program& program : system_.programs) {
      for (const ProgramEdge& edge : program.edges) {
        for (const ModelUse& use : program.uses_of(edge)) {
          if (use.model == model) known->second.insert({use.kind, use.model, use.index});
        }
      }
    }
    return known->second;
  }

  void add_users(WayOut& way, std::uint32_t index, const std::set<ModelUse>& enabling) {
    const Program& program = system_.programs[index];
    const auto helps = [&](const ProgramEdge& edge) {
      const auto uses = program.uses_of(edge);
      return std::ranges::any_of(uses, [&](const ModelUse& use) {
        return enabling.contains({use.kind, use.model, use.index});
      });
    };
    add_helpers(way, index, helps);
  }

  // ---- Guards over own variables ----

  void add_openers(WayOut& way) {
    const Program::Guard& guard = *way.guard;
    // Where it reads shared ones alone, it holds with none of their values.
    if (guard.variables.empty()) return;
    std::set<std::vector<std::optional<Value>>> open;  // values with which the guard holds
    for (const Program::Select& select : own_.selects) {
      const auto& guards = own_.guard_lists[select.guards];
      if (std::ranges::find(guards, guard) == guards.end()) continue;
      const auto edges = own_.edges_of(select.state);
      const bool holds = std::ranges::any_of(edges, [&](const ProgramEdge& edge) {
        return edge.line == guard.line && edge.column == guard.column;
      });
      if (holds) open.insert(values_at(select.state, guard));
    }
    add_helpers(way, waiting_, [&](const ProgramEdge& edge) {
      const auto number = static_cast<std::uint32_t>(&edge - own_.edges.data());
      return open.contains(values_at(edge.target, guard)) &&
             !open.contains(values_at(own_.source_of(number), guard));
    });
  }

  std::vector<std::optional<Value>> values_at(ControlState at, const Program::Guard& guard) const {
    std::vector<std::optional<Value>> values;
    for (const std::uint32_t variable : guard.variables) {
      values.push_back(own_.value_of(at, variable));
    }
    return values;
  }

  // ---- Who takes such a step, and what keeps him from it ----

  using Helps = std::function<bool(const ProgramEdge&)>;

  void add_helpers(WayOut& way, std::uint32_t index, const Helps& helps) {
    const Program& program = system_.programs[index];
    const bool is_own = index == waiting_;
    const auto callbacks = is_own ? own_callbacks_ : callbacks_in(program);
    const auto running = callbacks[state_.programs[index]];
    std::set<std::optional<std::uint32_t>> helping;
    for (ControlState at = 0; at < program.states.size(); ++at) {
      for (const ProgramEdge& edge : program.edges_of(at)) {
        if (!program.is_progress(edge) || !helps(edge)) continue;
        const auto started = started_by(program, edge);
        helping.insert(started ? started : callbacks[at]);
      }
    }
    for (const auto& callback : helping) {
      // What the program itself does later does not help it.
      if (is_own && (!callback || callback == running)) continue;
      if (callback && callback != running) {
        way.helpers.push_back(with_obstacle_to_start(index, *callback));
        continue;
      }
      const ControlState at = state_.programs[index];
      const Obstacle obstacle = program.is_end(at)              ? Obstacle::ended
                                : can_reach(program, at, helps) ? Obstacle::none
                                                                : Obstacle::passed;
      way.helpers.push_back({index, callback, obstacle, {}});
    }
  }

  static bool can_reach(const Program& program, ControlState start, const Helps& helps) {
    std::vector<bool> seen(program.states.size());
    std::vector<ControlState> open{start};
    seen[start] = true;
    while (!open.empty()) {
      const ControlState at = open.back();
      open.pop_back();
      for (const ProgramEdge& edge : program.edges_of(at)) {
        if (helps(edge)) return true;
        if (program.is_fate(edge) || seen[edge.target]) continue;
        seen[edge.target] = true;
        open.push_back(edge.target);
      }
    }
    return false;
  }

  // Why that callback, which the program runs, does not start.
  Helper with_obstacle_to_start(std::uint32_t index, std::uint32_t callback) const {
    Helper helper{index, callback, Obstacle::none, {}};
    const bool is_parallel = threads_of(callback) > 1;
    const auto running = running_callback(system_, state_, index);
    if (running) {
      const bool is_own = index == waiting_;
      helper.obstacle = !is_own       ? Obstacle::busy
                        : is_parallel ? Obstacle::own_group
                                      : Obstacle::own_thread;
      helper.holders.push_back(*running);
      return helper;
    }
    const Program& program = system_.programs[index];
    if (program.is_end(state_.programs[index])) helper.obstacle = Obstacle::ended;
    bool is_there = false, lacks_thread = false;
    for (const ProgramEdge& edge : program.edges_of(state_.programs[index])) {
      if (started_by(program, edge) != callback) continue;
      bool can = true, can_but_for_threads = true;
      for (const ModelUse& use : program.uses_of(edge)) {
        if (is_possible_at(system_.models[use.model], state_.models[use.model], use)) continue;
        can = false;
        can_but_for_threads = can_but_for_threads && is_of_threads(system_, use);
      }
      if (can) return helper;
      is_there = true;
      lacks_thread = lacks_thread || can_but_for_threads;
    }
    if (!is_there) {
      const ControlState at = state_.programs[index];
      const bool is_spun = system_.callbacks[callback].kind == CallbackKind::client &&
                           program.spins_until_answer(at);
      if (helper.obstacle == Obstacle::none && !is_spun && !may_start_any(program, at)) {
        helper.obstacle = index == waiting_ ? Obstacle::own_thread : Obstacle::busy;
      }
      return helper;
    }
    helper.obstacle = lacks_thread ? Obstacle::no_thread : Obstacle::not_started;
    if (lacks_thread) helper.holders = running_on(system_.callbacks[callback].executor);
    return helper;
  }

  // Some callback starts there, or would where a guard held.
  static bool may_start_any(const Program& program, ControlState at) {
    const auto edges = program.edges_of(at);
    return !closed_guards(program, at).empty() ||
           std::ranges::any_of(edges, [&](const ProgramEdge& edge) {
             const Role role = program.role_of(edge);
             return started_by(program, edge).has_value() || role == Role::look;
           });
  }

  std::uint32_t threads_of(std::uint32_t callback) const {
    return system_.executors[system_.callbacks[callback].executor].threads;
  }

  // What an executor's threads run.
  std::vector<std::uint32_t> running_on(std::uint32_t executor) const {
    std::vector<std::uint32_t> result;
    for (std::uint32_t index = 0; index < system_.programs.size(); ++index) {
      const auto running = running_callback(system_, state_, index);
      if (running && system_.callbacks[*running].executor == executor) result.push_back(*running);
    }
    return result;
  }

  const System& system_;
  const GlobalState& state_;
  std::uint32_t waiting_;
  const Program& own_;
  std::vector<std::optional<std::uint32_t>> own_callbacks_;
  std::map<std::uint32_t, std::set<ModelUse>> uses_;
};

}  // namespace

std::vector<std::optional<std::uint32_t>> callbacks_in(const Program& program) {
  std::vector<std::optional<std::uint32_t>> result(program.states.size());
  std::vector<ControlState> open;
  for (const ProgramEdge& start : program.edges) {
    const auto callback = started_by(program, start);
    if (!callback || result[start.target]) continue;
    result[start.target] = callback;
    open.push_back(start.target);
    while (!open.empty()) {
      const ControlState at = open.back();
      open.pop_back();
      for (const ProgramEdge& edge : program.edges_of(at)) {
        if (program.role_of(edge) == Role::end || program.is_fate(edge)) continue;
        if (result[edge.target]) continue;
        result[edge.target] = callback;
        open.push_back(edge.target);
      }
    }
  }
  return result;
}

std::optional<std::uint32_t> running_callback(const System& system, const GlobalState& state,
                                              std::uint32_t program) {
  const Program& own = system.programs[program];
  if (own.nodes.empty()) return std::nullopt;
  return callbacks_in(own)[state.programs[program]];
}

std::vector<WayOut> find_ways_out(const System& system, const GlobalState& state,
                                  std::uint32_t program) {
  return WayFinder(system, state, program).run();
}

std::optional<Helper> find_starter(const System& system, const GlobalState& state,
                                   std::uint32_t program, std::uint32_t callback) {
  return WayFinder(system, state, program).starter(callback);
}

}  // namespace maide
