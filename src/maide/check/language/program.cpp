#include "maide/check/language/program.hpp"

#include <algorithm>
#include <span>
#include <string>
#include <vector>

#include "maide/base/invariant.hpp"

namespace maide {

std::string Program::place_of(int line) const {
  std::string text = "line " + std::to_string(line);
  std::uint32_t origin = 0;  // what all that stands on the line was made from
  for (const ProgramEdge& edge : edges) {
    if (edge.line != line) continue;
    if (origin == 0) origin = edge.origin;
    if (edge.origin != origin) origin = 0;
    if (origin == 0) break;
  }
  if (origin != 0) text = to_string(origins[origin]);
  const auto is_in = [&](const CallbackLines& of) { return of.first <= line && line <= of.last; };
  if (std::ranges::count_if(callbacks, is_in) != 1) return text;
  return text + " (" + std::ranges::find_if(callbacks, is_in)->name + ")";
}

ControlState Program::source_of(std::uint32_t edge) const {
  const auto behind = std::ranges::upper_bound(states, edge, {}, &State::first_edge);
  MAIDE_CHECK(behind != states.begin());
  return static_cast<ControlState>(behind - states.begin() - 1);
}

std::span<const Program::Guard> Program::guards_at(ControlState state) const {
  const auto at = std::ranges::lower_bound(selects, state, {}, &Select::state);
  if (at == selects.end() || at->state != state) return {};
  return guard_lists[at->guards];
}

bool Program::has_label(ControlState state, std::uint32_t label) const {
  const auto& set = label_sets[states[state].label_set];
  return std::ranges::binary_search(set, label);
}

bool Program::may_end() const {
  if (life && std::ranges::find(life->is_dead_for_good, true) != life->is_dead_for_good.end()) {
    return true;
  }
  for (ControlState state = 0; state < states.size(); ++state) {
    if (is_end(state)) return true;
  }
  return false;
}

bool Program::spins_until_answer(ControlState state) const {
  const auto here = edges_of(state);
  return std::ranges::any_of(spins_until, [&](const SourcePosition& spin) {
    return std::ranges::any_of(here, [&](const ProgramEdge& edge) {
      return edge.line == spin.line && edge.column == spin.column;
    });
  });
}

bool Program::may_die() const {
  return life.has_value() ||
         std::ranges::any_of(edges, [&](const ProgramEdge& edge) { return is_death(edge); });
}

bool Program::may_reach(std::uint32_t label) const {
  return std::ranges::any_of(
      label_sets, [&](const auto& set) { return std::ranges::binary_search(set, label); });
}

}  // namespace maide
