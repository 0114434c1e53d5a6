#include "maide/learn/lsharp/target_estimate.hpp"

#include <algorithm>

namespace maide {
TargetEstimate::TargetEstimate(const Apartness& apartness)
    : states_(apartness.size()), by_input_(apartness.input_count()), visits_(states_) {
  for (Apartness::Transition transition = 0; transition < states_ * by_input_.size();
       ++transition) {
    const StateId target = apartness.target(transition);
    if (target == Mealy::no_state) continue;
    const Symbol output = apartness.tree().output(apartness.target_node(transition));
    const bool is_loop = target == apartness.source(transition);
    by_input_[apartness.input(transition)].push_back({output, target, is_loop});
    Counts& counts = by_output_[output];
    counts.targets.resize(states_);
    (is_loop ? counts.loops : counts.targets[target]) += 1;
    visits_[target] += 1;
  }
}

bool TargetEstimate::has_seen(Symbol input, Symbol output) const {
  const std::vector<Seen>& all = by_input_[input];
  return std::any_of(all.begin(), all.end(),
                     [&](const Seen& seen) { return seen.output == output; });
}

std::vector<double> TargetEstimate::weights(std::size_t states, StateId source, Symbol input,
                                            Symbol output) const {
  std::vector<double> result;
  result.reserve(states);
  for (StateId state = 0; state < states; ++state) result.push_back(weight(state));
  if (const auto found = by_output_.find(output); found != by_output_.end()) {
    const Counts& counts = found->second;
    for (StateId state = 0; state < states_; ++state) {
      result[state] += same_output * counts.targets[state];
    }
    result[source] += loop * same_output * counts.loops;
  }
  for (const Seen& seen : by_input_[input]) {
    result[seen.target] += same_input;
    if (seen.output != output) continue;
    result[seen.is_loop ? source : seen.target] += seen.is_loop ? loop * same_both : same_both;
  }
  return result;
}

}  // namespace maide
