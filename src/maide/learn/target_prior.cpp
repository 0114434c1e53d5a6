#include "maide/learn/target_prior.hpp"

#include <algorithm>

namespace maide {
namespace {

// How much a known transition tells about another: much if it has the same input and output, little
// if only one of them is the same. Set once, by the sum over the models of bench_learn.
constexpr double same_both = 5;
constexpr double same_output = 0.5;
constexpr double same_input = 1.5;
constexpr double same_nothing = 0.15;
constexpr double loop = 2;  // times as much if it leads back

}  // namespace

TargetPrior::TargetPrior(const Apartness& apartness)
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

bool TargetPrior::has_seen(Symbol input, Symbol output) const {
  const std::vector<Seen>& all = by_input_[input];
  return std::any_of(all.begin(), all.end(),
                     [&](const Seen& seen) { return seen.output == output; });
}

std::vector<double> TargetPrior::weights(std::size_t states, StateId source, Symbol input,
                                         Symbol output) const {
  std::vector<double> result(states, 1);
  for (StateId state = 0; state < states_; ++state) result[state] += same_nothing * visits_[state];
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
