#include "explicit_checker.hpp"

#include <algorithm>
#include <deque>

namespace maide::test {
namespace {

std::vector<std::uint32_t> key_of(const GlobalState& state) {
  std::vector<std::uint32_t> key(state.models.begin(), state.models.end());
  key.insert(key.end(), state.programs.begin(), state.programs.end());
  return key;
}

// Fairness to programs asks for it.
bool is_asked(const System& system, const Step& step) {
  return step.actor != nobody && is_progress(system, step) &&
         system.programs[step.actor].flags.is_fair;
}

std::uint32_t group_of(const System& system, const Step& step) {
  const CombinedStep* combined = combined_step_of(system, step);
  return combined == nullptr ? 0 : combined->fair;
}

// Tarjan's strongly connected components (SIAM J. Comput. 1972) of the nodes in `allowed`, by
// repeated reachability instead: forward and backward from each node. Quadratic, plainly right.
std::vector<std::vector<std::uint32_t>> components(
    const std::vector<std::vector<std::uint32_t>>& edges, const std::vector<bool>& allowed) {
  const std::size_t count = edges.size();
  std::vector<std::vector<std::uint32_t>> back(count);
  for (std::uint32_t from = 0; from < count; ++from) {
    for (const std::uint32_t to : edges[from]) back[to].push_back(from);
  }
  const auto reachable = [&](std::uint32_t start, const auto& graph) {
    std::vector<bool> seen(count, false);
    std::vector<std::uint32_t> stack{start};
    seen[start] = true;
    while (!stack.empty()) {
      const std::uint32_t at = stack.back();
      stack.pop_back();
      for (const std::uint32_t to : graph[at]) {
        if (allowed[to] && !seen[to]) {
          seen[to] = true;
          stack.push_back(to);
        }
      }
    }
    return seen;
  };
  std::vector<bool> placed(count, false);
  std::vector<std::vector<std::uint32_t>> result;
  for (std::uint32_t node = 0; node < count; ++node) {
    if (!allowed[node] || placed[node]) continue;
    const auto ahead = reachable(node, edges), behind = reachable(node, back);
    result.emplace_back();
    for (std::uint32_t other = 0; other < count; ++other) {
      if (!ahead[other] || !behind[other]) continue;
      placed[other] = true;
      result.back().push_back(other);
    }
  }
  return result;
}

}  // namespace

ExplicitChecker::ExplicitChecker(const System& system, std::size_t limit, LastEvent last_event)
    : system_(system) {
  std::map<std::vector<std::uint32_t>, std::uint32_t> known;
  std::deque<std::uint32_t> queue;
  const auto add = [&](const GlobalState& state, const std::optional<Step>& last,
                       std::size_t depth) {
    std::vector<std::uint32_t> key = key_of(state);
    state_depths_.try_emplace(key, depth);
    key.push_back(last ? static_cast<std::uint32_t>(actor_number(system, last->actor)) + 1 : 0);
    key.push_back(last ? last->action : 0);
    const auto [place, is_new] =
        known.try_emplace(std::move(key), static_cast<std::uint32_t>(nodes_.size()));
    if (is_new) {
      nodes_.push_back({state, last, {}, std::vector<bool>(system.programs.size(), false), {}});
      queue.push_back(place->second);
    }
    return place->second;
  };
  if (is_error(system, initial_state(system))) {
    is_complete_ = false;
    return;
  }
  add(initial_state(system), std::nullopt, 0);
  while (!queue.empty()) {
    if (nodes_.size() > limit) {
      is_complete_ = false;
      return;
    }
    const std::uint32_t at = queue.front();
    queue.pop_front();
    const GlobalState state = nodes_[at].state;
    const std::size_t depth = state_depths_.at(key_of(state));
    const std::vector<Step> steps = enabled_steps(system, state);
    bool is_end = true;
    for (const Step& step : steps) {
      const auto actor = static_cast<std::uint32_t>(actor_number(system, step.actor));
      if (is_progress(system, step)) {
        is_end = false;
        if (is_asked(system, step)) {
          nodes_[at].enabled[actor] = true;
          nodes_[at].able.emplace_back(actor, 0);
        }
      }
      const std::uint32_t group = group_of(system, step);
      if (group != 0) nodes_[at].able.emplace_back(actor, group);
      const GlobalState next = apply(system, state, step);
      if (next.is_cut) {
        shortest_cut_ = std::min(shortest_cut_.value_or(depth + 1), depth + 1);
        continue;
      }
      if (is_error(system, next)) {
        state_depths_.try_emplace(key_of(next), depth + 1);
        shortest_error_ = std::min(shortest_error_.value_or(depth + 1), depth + 1);
        continue;
      }
      const std::uint32_t target = add(next, step, depth + 1);
      nodes_[at].edges.push_back({target, actor, group});
    }
    if (is_end) {
      if (is_deadlock(system, state)) {
        shortest_deadlock_ = std::min(shortest_deadlock_.value_or(depth), depth);
      }
      const bool keeps = last_event == LastEvent::kept;
      const std::uint32_t target =
          add(state, keeps ? nodes_[at].last : std::optional<Step>(), depth);
      nodes_[at].edges.push_back({target, static_cast<std::uint32_t>(system.programs.size()), 0});
    }
  }
}

namespace {

// One step of the graph that has_stuck_program() makes.
struct StuckEdge {
  std::uint32_t target = 0, program = 0;
  std::uint32_t group = 0;  // of the program; 0: none
};

struct StuckNode {
  GlobalState state;
  std::vector<StuckEdge> edges;
  // (program, group) that could step; group 0 is the program itself.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> able;
  std::size_t depth = 0;
};

std::vector<StuckNode> make_graph(const System& system) {
  std::vector<StuckNode> nodes{{initial_state(system), {}, {}, 0}};
  std::map<std::vector<std::uint32_t>, std::uint32_t> known{{key_of(nodes[0].state), 0}};
  for (std::size_t at = 0; at < nodes.size(); ++at) {
    const GlobalState state = nodes[at].state;
    for (const Step& step : enabled_steps(system, state)) {
      const auto actor = static_cast<std::uint32_t>(actor_number(system, step.actor));
      const std::uint32_t group = group_of(system, step);
      if (is_asked(system, step)) nodes[at].able.emplace_back(actor, 0);
      if (group != 0) nodes[at].able.emplace_back(actor, group);
      const GlobalState next = apply(system, state, step);
      if (next.is_cut || is_error(system, next)) continue;
      const auto [place, is_new] =
          known.try_emplace(key_of(next), static_cast<std::uint32_t>(nodes.size()));
      if (is_new) nodes.push_back({next, {}, {}, nodes[at].depth + 1});
      nodes[at].edges.push_back({place->second, actor, group});
    }
  }
  return nodes;
}

// Whether a fair run without steps of `stuck` stays within `allowed`.
bool has_fair_run(const std::vector<StuckNode>& nodes, std::uint32_t stuck,
                  const std::vector<bool>& allowed) {
  std::vector<std::vector<std::uint32_t>> edges(nodes.size());
  for (std::size_t at = 0; at < nodes.size(); ++at) {
    for (const StuckEdge& edge : nodes[at].edges) {
      if (edge.program != stuck) edges[at].push_back(edge.target);
    }
  }
  for (const auto& component : components(edges, allowed)) {
    std::vector<bool> inside(nodes.size());
    for (const std::uint32_t node : component) inside[node] = true;
    std::map<std::pair<std::uint32_t, std::uint32_t>, bool> serves;
    bool has_edge = false;
    for (const std::uint32_t node : component) {
      for (const auto& who : nodes[node].able) serves.try_emplace(who, false);
      for (const StuckEdge& edge : nodes[node].edges) {
        if (edge.program == stuck || !inside[edge.target]) continue;
        has_edge = true;
        serves[{edge.program, 0}] = serves[{edge.program, edge.group}] = true;
      }
    }
    if (!has_edge) continue;
    std::vector<bool> rest(nodes.size());
    bool is_fair = true;
    for (const std::uint32_t node : component) {
      rest[node] = std::all_of(nodes[node].able.begin(), nodes[node].able.end(),
                               [&](const auto& who) { return serves[who]; });
      is_fair = is_fair && rest[node];
    }
    if (is_fair || has_fair_run(nodes, stuck, rest)) return true;
  }
  return false;
}

// Where the program has neither ended nor may rest.
std::vector<bool> restless(const System& system, const std::vector<StuckNode>& nodes,
                           std::uint32_t index) {
  std::vector<bool> allowed(nodes.size());
  const Program& program = system.programs[index];
  for (std::size_t at = 0; at < nodes.size(); ++at) {
    const ControlState control = nodes[at].state.programs[index];
    allowed[at] =
        !program.is_end(control) && !program.is_error(control) && !program.may_rest(control);
  }
  return allowed;
}

}  // namespace

bool has_stuck_program(const System& system) {
  const std::vector<StuckNode> nodes = make_graph(system);
  for (std::uint32_t stuck = 0; stuck < system.programs.size(); ++stuck) {
    if (!system.programs[stuck].flags.is_fair) continue;
    if (has_fair_run(nodes, stuck, restless(system, nodes, stuck))) return true;
  }
  return false;
}

std::optional<std::size_t> nearest_stuck(const System& system) {
  const std::vector<StuckNode> nodes = make_graph(system);
  std::optional<std::size_t> nearest;
  for (std::uint32_t stuck = 0; stuck < system.programs.size(); ++stuck) {
    if (!system.programs[stuck].flags.is_fair) continue;
    std::vector<bool> allowed = restless(system, nodes, stuck);
    std::vector<std::vector<std::uint32_t>> edges(nodes.size());
    for (std::size_t at = 0; at < nodes.size(); ++at) {
      if (std::ranges::find(nodes[at].able, std::pair{stuck, 0U}) != nodes[at].able.end()) {
        allowed[at] = false;
      }
      for (const StuckEdge& edge : nodes[at].edges) edges[at].push_back(edge.target);
    }
    std::vector<bool> is_stuck(nodes.size());
    for (const auto& component : components(edges, allowed)) {
      std::vector<bool> inside(nodes.size());
      for (const std::uint32_t node : component) inside[node] = true;
      if (!has_fair_run(nodes, stuck, inside)) continue;
      for (const std::uint32_t node : component) is_stuck[node] = true;
    }
    for (bool has_grown = true; has_grown;) {
      has_grown = false;
      for (std::size_t at = 0; at < nodes.size(); ++at) {
        if (!allowed[at] || is_stuck[at]) continue;
        is_stuck[at] = std::ranges::any_of(edges[at], [&](auto to) { return is_stuck[to]; });
        has_grown = has_grown || is_stuck[at];
      }
    }
    for (std::size_t at = 0; at < nodes.size(); ++at) {
      if (is_stuck[at] && (!nearest || nodes[at].depth < *nearest)) nearest = nodes[at].depth;
    }
  }
  return nearest;
}

ExplicitChecker::Label ExplicitChecker::label(const Formula& expression) const {
  Label result;
  for (const Node& node : nodes_) {
    const Step* last = node.last ? &*node.last : nullptr;
    const auto value = [&](const Atom& atom, std::size_t) {
      return is_true(atom, system_, node.state, last);
    };
    result.push_back(holds_on_lasso(expression, 1, 0, value));
  }
  return result;
}

ExplicitChecker::Label ExplicitChecker::initial_only() const {
  Label label(nodes_.size(), false);
  label[0] = true;
  return label;
}

ExplicitChecker::Label ExplicitChecker::reach(const Label& from, const Label& allowed) const {
  Label seen(nodes_.size(), false);
  std::vector<std::uint32_t> stack;
  for (std::uint32_t node = 0; node < nodes_.size(); ++node) {
    if (from[node] && allowed[node]) {
      seen[node] = true;
      stack.push_back(node);
    }
  }
  while (!stack.empty()) {
    const std::uint32_t at = stack.back();
    stack.pop_back();
    for (const Edge& edge : nodes_[at].edges) {
      if (!allowed[edge.target] || seen[edge.target]) continue;
      seen[edge.target] = true;
      stack.push_back(edge.target);
    }
  }
  return seen;
}

bool ExplicitChecker::is_asked_strongly(const Who& who, Fairness fairness) const {
  if (fairness == Fairness::none) return false;
  if (fairness == Fairness::strong) return true;
  const auto& [actor, group] = who;
  if (group == 0) return false;
  return actor == system_.programs.size() ||
         system_.programs[actor].fair_groups[group].on_weak_runs;
}

ExplicitChecker::Label ExplicitChecker::trap(const Label& allowed, Fairness fairness,
                                             const Label* visit) const {
  std::vector<std::vector<std::uint32_t>> edges(nodes_.size());
  for (std::size_t node = 0; node < nodes_.size(); ++node) {
    for (const Edge& edge : nodes_[node].edges) edges[node].push_back(edge.target);
  }
  Label result(nodes_.size(), false);
  for (const auto& component : components(edges, allowed)) {
    Label inside(nodes_.size(), false);
    for (const std::uint32_t node : component) inside[node] = true;
    bool has_edge = false, is_visited = visit == nullptr;
    std::vector<bool> served(system_.programs.size(), fairness != Fairness::weak);
    std::map<Who, bool> steps;
    for (const std::uint32_t node : component) {
      is_visited = is_visited || (*visit)[node];
      for (std::size_t program = 0; program < served.size(); ++program) {
        if (!nodes_[node].enabled[program]) served[program] = true;
      }
      for (const Edge& edge : nodes_[node].edges) {
        if (!inside[edge.target]) continue;
        has_edge = true;
        if (edge.program < served.size()) served[edge.program] = true;
        steps[{edge.program, 0}] = steps[{edge.program, edge.group}] = true;
      }
    }
    if (!has_edge || !is_visited || std::count(served.begin(), served.end(), false) > 0) continue;
    // Who can step and never does must not be able to: without those nodes there may be a part.
    Label rest = inside;
    for (const std::uint32_t node : component) {
      for (const Who& who : nodes_[node].able) {
        if (is_asked_strongly(who, fairness) && !steps[who]) rest[node] = false;
      }
    }
    const Label found = rest == inside ? inside : trap(rest, fairness, visit);
    for (const std::uint32_t node : component) result[node] = result[node] || found[node];
  }
  return result;
}

bool ExplicitChecker::holds_globally(const Label& p) const {
  return std::count(p.begin(), p.end(), false) == 0;
}

namespace {
bool meet(const std::vector<bool>& left, const std::vector<bool>& right) {
  for (std::size_t at = 0; at < left.size(); ++at) {
    if (left[at] && right[at]) return true;
  }
  return false;
}
std::vector<bool> negated(std::vector<bool> label) {
  label.flip();
  return label;
}
}  // namespace

bool ExplicitChecker::holds_until(const Label& p, const Label& q, Fairness fairness) const {
  const Label not_q = negated(q);
  const Label before = reach(initial_only(), not_q);
  return !meet(before, negated(p)) && !meet(before, trap(not_q, fairness));
}

bool ExplicitChecker::holds_infinitely_often(const Label& p, Fairness fairness) const {
  return !meet(trap(negated(p), fairness), Label(nodes_.size(), true));
}

bool ExplicitChecker::holds_from_some_point(const Label& p, Fairness fairness) const {
  const Label everywhere(nodes_.size(), true), not_p = negated(p);
  return !meet(trap(everywhere, fairness, &not_p), everywhere);
}

bool ExplicitChecker::holds_response(const Label& p, const Label& q, Fairness fairness) const {
  return !meet(reach(p, negated(q)), trap(negated(q), fairness));
}

}  // namespace maide::test
