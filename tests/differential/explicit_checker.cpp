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
    key.push_back(last ? last->program + 1 : 0);
    key.push_back(last ? last->edge : 0);
    const auto [place, is_new] =
        known.try_emplace(std::move(key), static_cast<std::uint32_t>(nodes_.size()));
    if (is_new) {
      nodes_.push_back({state, last, {}, std::vector<bool>(system.programs.size(), false)});
      queue.push_back(place->second);
    }
    return place->second;
  };
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
    for (const Step& step : steps) {
      nodes_[at].enabled[step.program] = true;
      const GlobalState next = apply(system, state, step);
      if (next.is_cut) {
        shortest_cut_ = std::min(shortest_cut_.value_or(depth + 1), depth + 1);
        continue;
      }
      const std::uint32_t target = add(next, step, depth + 1);
      nodes_[at].edges.push_back({target, step.program});
    }
    if (steps.empty()) {
      if (!has_ended(system, state)) {
        shortest_deadlock_ = std::min(shortest_deadlock_.value_or(depth), depth);
      }
      const bool keeps = last_event == LastEvent::kept;
      const std::uint32_t target =
          add(state, keeps ? nodes_[at].last : std::optional<Step>(), depth);
      nodes_[at].edges.push_back({target, 0});
    }
  }
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

ExplicitChecker::Label ExplicitChecker::trap(const Label& allowed, bool fair,
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
    std::vector<bool> served(system_.programs.size(), !fair);
    for (const std::uint32_t node : component) {
      is_visited = is_visited || (*visit)[node];
      for (std::size_t program = 0; program < served.size(); ++program) {
        if (!nodes_[node].enabled[program]) served[program] = true;
      }
      for (const Edge& edge : nodes_[node].edges) {
        if (!inside[edge.target]) continue;
        has_edge = true;
        served[edge.program] = true;
      }
    }
    if (!has_edge || !is_visited || std::count(served.begin(), served.end(), false) > 0) continue;
    for (const std::uint32_t node : component) result[node] = true;
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

bool ExplicitChecker::holds_until(const Label& p, const Label& q, bool fair) const {
  const Label not_q = negated(q);
  const Label before = reach(initial_only(), not_q);
  return !meet(before, negated(p)) && !meet(before, trap(not_q, fair));
}

bool ExplicitChecker::holds_infinitely_often(const Label& p, bool fair) const {
  return !meet(trap(negated(p), fair), Label(nodes_.size(), true));
}

bool ExplicitChecker::holds_from_some_point(const Label& p, bool fair) const {
  const Label everywhere(nodes_.size(), true), not_p = negated(p);
  return !meet(trap(everywhere, fair, &not_p), everywhere);
}

bool ExplicitChecker::holds_response(const Label& p, const Label& q, bool fair) const {
  return !meet(reach(p, negated(q)), trap(negated(q), fair));
}

}  // namespace maide::test
