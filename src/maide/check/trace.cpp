#include "maide/check/trace.hpp"

#include <algorithm>
#include <stdexcept>

namespace maide {
namespace {

// Weak fairness on the loop: each program steps in it, or is unable to somewhere in it.
bool is_weakly_fair(const System& system, const Trace& trace,
                    const std::vector<GlobalState>& states) {
  const std::size_t begin = *trace.loop_start;
  for (std::uint32_t program = 0; program < system.programs.size(); ++program) {
    bool is_served = false;
    for (std::size_t at = begin; at < trace.steps.size() && !is_served; ++at) {
      const auto enabled = enabled_steps(system, states[at]);
      is_served = trace.steps[at].program == program ||
                  std::none_of(enabled.begin(), enabled.end(),
                               [&](const Step& step) { return step.program == program; });
    }
    if (!is_served) return false;
  }
  return true;
}

std::string find_flaw_of_run(const System& system, const Property& property, const Trace& trace,
                             const std::vector<GlobalState>& states) {
  const bool loops = trace.loop_start.has_value();
  // A run that is cut, or shown no further, must have a bad prefix: whatever comes, it is violated.
  const bool goes_on = !loops && !enabled_steps(system, states.back()).empty();
  if (loops && property.fairness == Fairness::weak && !is_weakly_fair(system, trace, states)) {
    return "the run is not fair";
  }
  // A run that ends repeats its last state, without the event that led there.
  const std::size_t length = states.size() + (loops ? 0 : 1);
  const std::size_t loop = loops ? *trace.loop_start + 1 : length - 1;
  const auto value = [&](const Atom& atom, std::size_t at) {
    const Step* step = at == 0 || at > trace.steps.size() ? nullptr : &trace.steps[at - 1];
    return is_true(atom, system, states[std::min(at, states.size() - 1)], step);
  };
  std::size_t cut = never_cut;
  if (goes_on) cut = states.size();
  if (states.back().is_cut) cut = states.size() - 1;
  return holds_on_lasso(property.formula, length, loop, value, cut) ? "the formula holds on the run"
                                                                    : "";
}

}  // namespace

std::vector<GlobalState> replay(const System& system, const Trace& trace) {
  std::vector<GlobalState> states{initial_state(system)};
  for (const Step& step : trace.steps) {
    const auto enabled = enabled_steps(system, states.back());
    if (std::find(enabled.begin(), enabled.end(), step) == enabled.end()) {
      throw std::logic_error("step " + std::to_string(states.size()) + " is not possible");
    }
    states.push_back(apply(system, states.back(), step));
  }
  if (trace.loop_start &&
      (*trace.loop_start >= trace.steps.size() || !(states[*trace.loop_start] == states.back()))) {
    throw std::logic_error("the loop does not close");
  }
  return states;
}

std::string find_flaw(const System& system, const Property& property, const Trace& trace) {
  std::vector<GlobalState> states;
  try {
    states = replay(system, trace);
  } catch (const std::logic_error& error) {
    return error.what();
  }
  if (property.kind == Property::Kind::deadlock) {
    return is_deadlock(system, states.back()) ? "" : "it ends in no deadlock";
  }
  if (property.kind == Property::Kind::ltl) {
    return find_flaw_of_run(system, property, trace, states);
  }
  return "";
}

}  // namespace maide
