#include "maide/conformance/complete_method.hpp"

#include <fmt/format.h>

#include "maide/automata/minimize.hpp"
#include "maide/conformance/identifier_suite.hpp"

namespace maide {

std::optional<Word> CompleteMethod::find_counterexample(const Mealy& hypothesis,
                                                        const RunControl& control) {
  IdentifierSuite suite(hypothesis, method_.compute(hypothesis, Random(options_.seed)),
                        options_.extra_states);
  guarantee_ = "not tested to the end";
  std::optional<Word> counterexample = runner_.run(suite, hypothesis, control);
  if (counterexample) {
    guarantee_ = fmt::format("refuted by {}", method_.title);
    return counterexample;
  }
  guarantee_ = fmt::format("not refuted by {} tests of {}", runner_.last_tests(), method_.title);
  const std::size_t states = minimize(hypothesis).size();
  if (const auto extra = suite.complete_for()) {
    guarantee_ += fmt::format(
        ": no machine with at most {} more state{} ({} in all) behaves "
        "differently",
        *extra, *extra == 1 ? "" : "s", states + *extra);
  } else {
    guarantee_ +=
        fmt::format(", cut off before the {} that would exclude other machines of {} states",
                    suite.size_up_to(0), states);
  }
  return counterexample;
}

}  // namespace maide
