// The teacher's answering half (Angluin 1987, "minimally adequate teacher"): output queries.
// Oracles are stacked as decorators that hold references: SulOracle (plays words on a system),
// Cache, counters. All take batches; the answer to query i is element i whatever the parallelism
// below, and new outputs are numbered in query order, so the same seed gives the same run.
#pragma once

#include <span>
#include <vector>

#include "maide/automata/alphabet.hpp"
#include "maide/base/run_control.hpp"
#include "maide/sul/ia_translator.hpp"
#include "maide/sul/query.hpp"

namespace maide {

class OutputOracle {
 public:
  virtual ~OutputOracle() = default;

  virtual const Alphabet& inputs() const = 0;
  virtual const Alphabet& outputs() const = 0;  // grows as outputs are seen

  // Answers every query, in their order. Throws Interrupted, WrapperError or NondeterminismError.
  virtual std::vector<MealyAnswer> ask(std::span<const Query> batch,
                                       const RunControl& control = {}) = 0;

  // The outputs along `word`; one output query.
  Word ask(const Word& word, const RunControl& control = {});
};

}  // namespace maide
