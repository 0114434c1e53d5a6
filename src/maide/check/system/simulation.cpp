#include "maide/check/system/simulation.hpp"

#include "maide/base/invariant.hpp"

namespace maide {

Simulation::Simulation(const System& system)
    : system_(system),
      states_{initial_state(system)},
      next_(enabled_steps(system, states_.front())) {}

Simulation::End Simulation::end() const {
  const GlobalState& state = states_.back();
  if (state.is_cut) return End::cut;
  if (is_error(system_, state)) return End::error;
  if (is_deadlock(system_, state)) return End::deadlock;
  if (!is_over(system_, state)) return End::none;
  return has_ended(system_, state) ? End::ended : End::at_rest;
}

void Simulation::take(std::size_t index) {
  MAIDE_CHECK(index < next_.size());
  const Step step = next_[index];
  states_.push_back(apply(system_, states_.back(), step));
  trace_.steps.push_back(step);
  next_ = enabled_steps(system_, states_.back());
}

void Simulation::go_back() {
  MAIDE_CHECK(!trace_.steps.empty());
  trace_.steps.pop_back();
  states_.pop_back();
  next_ = enabled_steps(system_, states_.back());
}

std::size_t draw_step(const std::vector<Step>& steps, Random& random) {
  MAIDE_CHECK(!steps.empty());
  std::vector<std::size_t> firsts;  // of each actor
  for (std::size_t at = 0; at < steps.size(); ++at) {
    if (at == 0 || steps[at].actor != steps[at - 1].actor) firsts.push_back(at);
  }
  firsts.push_back(steps.size());
  const std::size_t actor = random.below(firsts.size() - 1);
  return firsts[actor] + random.below(firsts[actor + 1] - firsts[actor]);
}

}  // namespace maide
