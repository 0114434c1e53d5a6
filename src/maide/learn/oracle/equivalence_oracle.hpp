// Equivalence queries, the second half of the teacher, approximated by conformance tests. An oracle
// that finds nothing has not proven equivalence. `guarantee()` says in words what its last run does
// establish, `strength()` in numbers.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "maide/automata/mealy.hpp"
#include "maide/automata/strength.hpp"
#include "maide/base/run_control.hpp"

namespace maide {

// Words and the inputs in them, saturating.
struct TestCost {
  std::uint64_t words = 0, symbols = 0;
};

class EquivalenceOracle {
 public:
  virtual ~EquivalenceOracle() = default;

  // A word on which `hypothesis` and the system differ, cut at the first output that differs unless
  // what follows shows more; nothing if the oracle finds none. The first in the order of its tests,
  // whatever the parallelism.
  virtual std::optional<Word> find_counterexample(const Mealy& hypothesis,
                                                  const RunControl& control = {}) = 0;

  // In words, what "nothing found" means: "not refuted by 412 tests of the W-method; no machine
  // with at most 2 more states behaves differently". For reports.
  virtual std::string guarantee() const = 0;

  // The same in numbers, as far as the last run came, be it that an exception ended it; nothing
  // where it found a counterexample, and by default.
  virtual Strength strength() const { return {}; }
  // What the tests that are missing to the strength that was demanded would cost; nothing where
  // none is missing, or where the method does not know. For messages.
  virtual TestCost cost_of_missing() const { return {}; }
};

}  // namespace maide
