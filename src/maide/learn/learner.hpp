// A learner builds a hypothesis from output queries and refines it by counterexamples. The loop
// that drives it against a teacher is `learn()`.
#pragma once

#include <cstdint>
#include <functional>

#include "maide/automata/mealy.hpp"
#include "maide/base/run_control.hpp"
#include "maide/learn/equivalence_oracle.hpp"

namespace maide {

class Learner {
 public:
  virtual ~Learner() = default;

  // Makes the first hypothesis. Must be called once, before anything else.
  virtual void start(const RunControl& control = {}) = 0;

  // Refines the hypothesis with a word on which it differs from the system, until it agrees with
  // the system on that word. A word that is no counterexample throws std::invalid_argument.
  virtual void refine(const Word& counterexample, const RunControl& control = {}) = 0;

  // The present hypothesis: complete, every state reachable, state 0 initial. A learner that lets a
  // state keep its number from one hypothesis to the next spares the perfect oracle work.
  virtual const Mealy& hypothesis() const = 0;

  // Output queries asked so far, answered by a cache or not.
  virtual std::uint64_t output_queries() const = 0;
};

// Called with each hypothesis before it goes to the teacher (to keep it, to draw it).
using HypothesisObserver = std::function<void(const Mealy& hypothesis, std::uint64_t round)>;

struct LearnResult {
  Mealy model;  // the last hypothesis, states numbered in breadth-first order
  std::uint64_t equivalence_queries = 0;  // the last one, which found nothing, included
};

// Runs the learner against the teacher until the teacher finds no counterexample. Throws
// Interrupted when `control` says stop; the learner then still holds its last hypothesis.
LearnResult run_learner(Learner& learner, EquivalenceOracle& teacher,
                        const RunControl& control = {}, const HypothesisObserver& observer = {});

// The same for short programs: the learned model.
Mealy learn(Learner& learner, EquivalenceOracle& teacher);

}  // namespace maide
