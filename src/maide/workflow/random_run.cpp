#include "maide/workflow/random_run.hpp"

#include <algorithm>
#include <vector>

namespace maide {

Trace draw_run(const System& system, std::size_t most_steps, Random& random) {
  Trace trace;
  GlobalState state = initial_state(system);
  while (trace.steps.size() < most_steps) {
    std::vector<Step> steps = enabled_steps(system, state);
    std::erase_if(steps, [](const Step& step) { return step.is_beyond; });
    if (steps.empty()) break;
    std::vector<std::uint32_t> programs;
    for (const Step& step : steps) {
      if (programs.empty() || programs.back() != step.program) programs.push_back(step.program);
    }
    const std::uint32_t program = programs[random.below(programs.size())];
    std::erase_if(steps, [&](const Step& step) { return step.program != program; });
    const Step& step = steps[random.below(steps.size())];
    trace.steps.push_back(step);
    state = apply(system, state, step);
  }
  return trace;
}

}  // namespace maide
