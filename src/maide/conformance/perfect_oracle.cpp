#include "maide/conformance/perfect_oracle.hpp"

namespace maide {

std::optional<Word> PerfectOracle::find_counterexample(const Mealy& hypothesis,
                                                       const RunControl& /*control*/) {
  return comparison_.find_difference(hypothesis);
}

std::string PerfectOracle::guarantee() const { return "equivalent to the reference model"; }

}  // namespace maide
