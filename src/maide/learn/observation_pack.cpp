#include "maide/learn/observation_pack.hpp"

#include "maide/learn/counterexample.hpp"

namespace maide {

bool ObservationPack::split(const Word& counterexample, std::span<const Symbol> outputs,
                            const RunControl& control) {
  return split_by_suffix(states_along(hypothesis(), counterexample), counterexample,
                         outputs[counterexample.size() - 1], false, control);
}

}  // namespace maide
