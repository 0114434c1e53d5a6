// Runs of systems that no engine chose, for tests of how counterexamples are shown: the programs
// take turns as the test says.
#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "maide/check/system/trace.hpp"

namespace maide::test {

// The first step that the program can take; nothing if it can take none.
inline std::optional<Step> first_step(const System& system, const GlobalState& state,
                                      std::uint32_t program) {
  const std::vector<Step> steps = enabled_steps(system, state);
  const auto step = std::find_if(steps.begin(), steps.end(),
                                 [&](const Step& each) { return each.actor == program; });
  return step == steps.end() ? std::nullopt : std::optional(*step);
}

// Each letter of `turns` is one step of a program, '0' being the first.
inline Trace run_in_turns(const System& system, const std::string& turns) {
  Trace trace;
  GlobalState state = initial_state(system);
  for (const char turn : turns) {
    trace.steps.push_back(
        first_step(system, state, static_cast<std::uint32_t>(turn - '0')).value());
    state = apply(system, state, trace.steps.back());
  }
  return trace;
}

// The first program of `order` that can go on does, until none can.
inline Trace run_by_priority(const System& system, const std::vector<std::uint32_t>& order) {
  Trace trace;
  GlobalState state = initial_state(system);
  for (bool goes_on = true; goes_on;) {
    goes_on = false;
    for (const std::uint32_t program : order) {
      const std::optional<Step> step = first_step(system, state, program);
      if (!step) continue;
      trace.steps.push_back(*step);
      state = apply(system, state, *step);
      goes_on = true;
      break;
    }
  }
  return trace;
}

}  // namespace maide::test
