// Guesses where a transition leads, before it is known. Most inputs of a protocol lead back to
// where they were given, or to the same few states, and an output often tells which. L# asks for
// what is probable first (adaptive_experiment.hpp). A wrong guess costs symbols, never the result.
#pragma once

#include <map>
#include <vector>

#include "maide/learn/lsharp/apartness.hpp"

namespace maide {

class TargetEstimate {
 public:
  // Counts the transitions whose targets are known. Keeps nothing of `apartness`. O(transitions).
  explicit TargetEstimate(const Apartness& apartness);

  // Some known transition has this input and output.
  bool has_seen(Symbol input, Symbol output) const;

  // For each of `states` states, among which may be some that were found since, a weight,
  // proportional to the probability that `input`, answered by `output`, leads there from `source`.
  // O(states).
  std::vector<double> weights(std::size_t states, StateId source, Symbol input,
                              Symbol output) const;
  // The same for a transition of which nothing is known. O(1).
  double weight(StateId state) const {
    return 1 + (state < states_ ? same_nothing * visits_[state] : 0);
  }

 private:
  // How much a known transition tells about another: much if it has the same input and output,
  // little if only one of them is the same. Set once, by the sum over the models of bench_learn.
  static constexpr double same_both = 5;
  static constexpr double same_output = 0.5;
  static constexpr double same_input = 1.5;
  static constexpr double same_nothing = 0.15;
  static constexpr double loop = 2;  // times as much if it leads back

  struct Seen {
    Symbol output;
    StateId target;
    bool is_loop;
  };
  struct Counts {
    std::vector<double> targets;  // by state: transitions that lead there from another one
    double loops = 0;             // transitions that lead back
  };

  std::size_t states_;
  std::vector<std::vector<Seen>> by_input_;
  std::map<Symbol, Counts> by_output_;
  std::vector<double> visits_;  // by state: transitions that lead there
};

}  // namespace maide
