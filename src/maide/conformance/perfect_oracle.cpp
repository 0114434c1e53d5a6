#include "maide/conformance/perfect_oracle.hpp"

#include "maide/automata/compare.hpp"

namespace maide {

std::optional<Word> PerfectOracle::find_counterexample(const Mealy& hypothesis,
                                                       const RunControl& /*control*/) {
  return find_distinguishing_word(hypothesis, reference_);
}

std::string PerfectOracle::guarantee() const { return "equivalent to the reference model"; }

}  // namespace maide
