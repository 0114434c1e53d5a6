// What it costs a learner to learn a machine in memory from the perfect oracle.
#pragma once

#include <cstdint>

#include "maide/automata/mealy.hpp"
#include "maide/learn/learner.hpp"
#include "maide/learn/oracle/observing_oracle.hpp"

namespace maide::bench {

struct LearnerCost {
  QueryCounts counts;  // that reached the system
  std::uint64_t equivalence_queries = 0;
  double cpu_seconds = 0;
  std::uint64_t peak_bytes = 0;  // resident; only where it was measured
  bool is_right = false;         // the minimal machine was learned

  std::uint64_t symbols_and_resets() const { return counts.symbols + counts.resets; }
};

// Every output query is asked of the system, as published figures count them, or through the cache.
LearnerCost measure_learner(const LearnerEntry& algorithm, const Mealy& model, bool use_cache);

// The same in a process of its own, whose peak of memory is its own but for what this one has
// already. Throws Error if there can be no such process, or it ends early.
LearnerCost measure_learner_apart(const LearnerEntry& algorithm, const Mealy& model,
                                  bool use_cache);

// Always the same one of this size, with 10 inputs and 10 outputs.
Mealy make_random_machine(std::size_t states);

}  // namespace maide::bench
