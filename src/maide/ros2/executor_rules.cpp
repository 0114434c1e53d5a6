#include "maide/ros2/executor_rules.hpp"

#include <algorithm>
#include <string>

namespace maide {
namespace {

using Kind = CallbackInstance::Kind;

}  // namespace

std::optional<std::uint32_t> started_by(const System& system, const Step& step) {
  const CombinedStep* combined = combined_step_of(system, step);
  return combined == nullptr || combined->role == CombinedStep::Role::discard ? std::nullopt
                                                                              : combined->callback;
}

std::optional<std::uint32_t> discarded_by(const System& system, const Step& step) {
  const CombinedStep* combined = combined_step_of(system, step);
  return combined == nullptr || combined->role != CombinedStep::Role::discard ? std::nullopt
                                                                              : combined->callback;
}

std::optional<std::uint32_t> picked_for(const System& system, const Step& step) {
  const CombinedStep* combined = combined_step_of(system, step);
  return combined == nullptr ? std::nullopt : combined->callback;
}

bool is_end_of_callback(const System& system, const Step& step) {
  const CombinedStep* combined = combined_step_of(system, step);
  return combined != nullptr && combined->role == CombinedStep::Role::end;
}

std::vector<std::uint32_t> found_by(const System& system, const Step& step) {
  const CombinedStep* combined = combined_step_of(system, step);
  std::vector<std::uint32_t> found;
  if (combined == nullptr || combined->role != CombinedStep::Role::look) return found;
  for (std::uint32_t callback = 0; callback < system.callbacks.size(); ++callback) {
    // "finds camera.tick, detector.on_image", or "finds nothing for camera.on_image"
    if (combined->text.starts_with("finds nothing for ")) continue;
    const std::string& name = system.callbacks[callback].name;
    const std::string text = combined->text.substr(combined->text.find(' ') + 1) + ",";
    for (std::size_t at = text.find(name + ","); at != std::string::npos;
         at = text.find(name + ",", at + 1)) {
      if (at == 0 || text[at - 1] == ' ') found.push_back(callback);
    }
  }
  return found;
}

ExecutorRules::ExecutorRules(const System& system)
    : system_(system), group_of_(system.callbacks.size()), ways_(system.callbacks.size()) {
  for (std::uint32_t number = 0; number < system.callbacks.size(); ++number) {
    const CallbackInstance& callback = system.callbacks[number];
    const auto is_its = [&](const std::vector<std::uint32_t>& group) {
      const CallbackInstance& first = system.callbacks[group.front()];
      return first.node == callback.node && first.group == callback.group;
    };
    const auto place = std::ranges::find_if(groups_, is_its);
    group_of_[number] = static_cast<std::size_t>(place - groups_.begin());
    if (place == groups_.end()) groups_.emplace_back();
    groups_[group_of_[number]].push_back(number);
    order_.push_back(number);
  }
  std::ranges::stable_sort(order_, [&](std::uint32_t a, std::uint32_t b) {
    const Kind kind = system.callbacks[a].kind, other = system.callbacks[b].kind;
    return kind != other ? kind < other : group_of_[a] < group_of_[b];
  });
  // What a start does with threads and groups, and what it asks of other models in `order: rounds`,
  // says nothing of what is there for the callback.
  for (const Program& program : system.programs) {
    for (const ProgramEdge& edge : program.edges) {
      if (edge.kind != ModelUse::Kind::combined) continue;
      const CombinedStep& combined = program.combined[edge.index];
      const bool discards = combined.role == CombinedStep::Role::discard;
      if (!combined.callback || (combined.events.empty() && !discards)) continue;
      std::vector<ModelUse>& ways = ways_[*combined.callback];
      const std::uint32_t model =
          discards ? system.callbacks[*combined.callback].model : combined.events.front().model;
      for (const ModelUse& use : combined.uses) {
        if (use.model != model) continue;
        if (std::ranges::find(ways, use) == ways.end()) ways.push_back(use);
      }
    }
  }
}

ExecutorRules::State ExecutorRules::initial() const {
  State state;
  state.found.resize(system_.executors.size());
  state.picked.resize(system_.executors.size());
  for (std::uint32_t callback = 0; callback < system_.callbacks.size(); ++callback) {
    state.running.emplace_back(runs_of(callback), false);
  }
  return state;
}

std::size_t ExecutorRules::runs_of(std::uint32_t callback) const {
  const CallbackInstance& instance = system_.callbacks[callback];
  return instance.is_reentrant ? system_.executors[instance.executor].threads : 1;
}

bool ExecutorRules::is_ready(std::uint32_t callback, const GlobalState& at) const {
  return std::ranges::any_of(ways_[callback], [&](const ModelUse& use) {
    return !model_steps(system_.models[use.model], at.models[use.model], use).empty();
  });
}

bool ExecutorRules::is_gone(std::uint32_t callback, const GlobalState& at,
                            std::span<const std::uint32_t> due) const {
  return system_.callbacks[callback].kind != Kind::timer && !is_ready(callback, at) &&
         std::ranges::find(due, callback) == due.end();
}

bool ExecutorRules::is_busy(const State& state, std::size_t group) const {
  if (system_.callbacks[groups_[group].front()].is_reentrant) return false;
  return std::ranges::any_of(groups_[group], [&](std::uint32_t callback) {
    const auto& picked = state.picked[system_.callbacks[callback].executor];
    return state.running[callback].front() || std::ranges::find(picked, callback) != picked.end();
  });
}

std::optional<std::uint32_t> ExecutorRules::pick(State& state, std::uint32_t executor,
                                                 const GlobalState& at,
                                                 std::span<const std::uint32_t> due) const {
  std::size_t busy = state.picked[executor].size();
  for (std::uint32_t callback = 0; callback < system_.callbacks.size(); ++callback) {
    if (system_.callbacks[callback].executor != executor) continue;
    const auto& running = state.running[callback];
    busy += static_cast<std::size_t>(std::ranges::count(running, true));
  }
  if (busy >= system_.executors[executor].threads) return std::nullopt;
  std::vector<std::uint32_t>& found = state.found[executor];
  std::erase_if(found, [&](std::uint32_t callback) { return is_gone(callback, at, due); });
  const auto is_free = [&](std::uint32_t callback) { return !is_busy(state, group_of_[callback]); };
  auto first = std::ranges::find_if(found, is_free);
  if (first == found.end()) {
    found.clear();
    for (const std::uint32_t callback : order_) {
      const bool is_due = std::ranges::find(due, callback) != due.end();
      if (system_.callbacks[callback].executor == executor && is_free(callback) &&
          (is_due || is_ready(callback, at))) {
        found.push_back(callback);
      }
    }
    first = found.begin();
  }
  if (first == found.end()) return std::nullopt;
  const std::uint32_t callback = *first;
  found.erase(first);
  auto& picked = state.picked[executor];
  picked.insert(std::ranges::upper_bound(picked, callback), callback);
  return callback;
}

void ExecutorRules::discard(State& state, std::uint32_t callback) const {
  auto& picked = state.picked[system_.callbacks[callback].executor];
  const auto place = std::ranges::find(picked, callback);
  if (place != picked.end()) picked.erase(place);
}

std::size_t ExecutorRules::start(State& state, std::uint32_t callback) const {
  discard(state, callback);
  auto& running = state.running[callback];
  const auto run = std::ranges::find(running, false);
  if (run == running.end()) return 0;
  *run = true;
  return static_cast<std::size_t>(run - running.begin());
}

void ExecutorRules::end(State& state, std::uint32_t callback, std::size_t run) const {
  state.running[callback][run] = false;
}

}  // namespace maide
