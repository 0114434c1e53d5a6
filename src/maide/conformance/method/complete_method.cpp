#include "maide/conformance/method/complete_method.hpp"

#include <fmt/format.h>

#include "maide/automata/minimize.hpp"
#include "maide/base/text.hpp"
#include "maide/conformance/suite/identifier_suite.hpp"

namespace maide {

std::string describe_passed(const IdentifierSuite& suite, std::uint64_t tests,
                            const IdentifierMethod& method, const Mealy& hypothesis) {
  const std::size_t states = minimize(hypothesis).size();
  std::string text = fmt::format("not refuted by {} tests of {}", tests, method.title);
  if (!method.is_complete) return text;
  const auto extra = suite.complete_for();
  if (!extra) {
    return text + fmt::format(
                      ", cut off before the {} that would exclude other machines of {} "
                      "states",
                      suite.size_up_to(0), states);
  }
  if (*extra == 0) {
    return text + fmt::format(": no machine of at most {} states behaves differently", states);
  }
  return text + fmt::format(": no machine with at most {} ({} in all) behaves differently",
                            counted(*extra, "more state"), states + *extra);
}

std::optional<Word> CompleteMethod::find_counterexample(const Mealy& hypothesis,
                                                        const RunControl& control) {
  IdentifierSuite suite(hypothesis, method_.compute(hypothesis, Random(options_.seed)),
                        options_.extra_states);
  return run(suite, hypothesis, control, method_.title, [&](std::uint64_t tests) {
    Passed passed{describe_passed(suite, tests, method_, hypothesis)};
    if (method_.is_complete) passed.strength.extra_states = suite.complete_for();
    return passed;
  });
}

}  // namespace maide
