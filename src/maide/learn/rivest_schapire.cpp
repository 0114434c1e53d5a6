#include "maide/learn/rivest_schapire.hpp"

#include "maide/automata/words.hpp"
#include "maide/learn/counterexample.hpp"

namespace maide {

std::vector<Word> RivestSchapire::suffixes_of(const Word& counterexample, Symbol last_output,
                                              const RunControl& control) {
  const Decomposition split =
      decompose(hypothesis(), hypothesis_.access, counterexample, last_output, oracle_, control);
  counterexample_queries_ += split.output_queries;
  return {tail(counterexample, split.position + 1)};
}

}  // namespace maide
