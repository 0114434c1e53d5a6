// Equivalence oracles that run a complete suite (identifier_suite.hpp): the W-method, Wp, HSI and
// hybrid ADS. They differ in the words that identify states. If the system differs from the
// hypothesis and has at most `extra_states` states more, some test shows it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "maide/automata/mealy.hpp"
#include "maide/base/random.hpp"
#include "maide/conformance/identify/state_identifiers.hpp"
#include "maide/conformance/method/test_runner.hpp"
#include "maide/conformance/suite/identifier_suite.hpp"

namespace maide {

// A way to identify states.
struct IdentifierMethod {
  std::string_view title;  // in sentences: "the W-method"
  StateIdentifiers (*compute)(const Mealy& machine, Random random);
  bool is_complete = true;  // tells all states apart, so its suites are complete
};

inline constexpr IdentifierMethod w_identifiers{"the W-method", compute_characterising_words};
inline constexpr IdentifierMethod wp_identifiers{"the Wp-method", compute_partial_words};
inline constexpr IdentifierMethod hsi_identifiers{"the HSI-method", compute_harmonised_words};
inline constexpr IdentifierMethod hads_identifiers{"hybrid ADS", compute_adaptive_words};
// Every transition, and every path of `extra_states` transitions more, is taken once; where it
// leads is not looked at.
inline constexpr IdentifierMethod no_identifiers{"transition cover", compute_no_words, false};

// In words, what it means that the first `tests` tests of the suite, all that it has made so far,
// were passed by the system.
std::string describe_passed(const IdentifierSuite& suite, std::uint64_t tests,
                            const IdentifierMethod& method, const Mealy& hypothesis);

struct CompleteMethodOptions {
  std::size_t extra_states = 2;
  TestRunnerOptions runner = {};
  std::uint64_t seed = 0;  // between identifiers that serve equally well
};

class CompleteMethod : public SuiteMethod {
 public:
  // Keeps a reference to `oracle`.
  CompleteMethod(OutputOracle& oracle, const IdentifierMethod& method,
                 CompleteMethodOptions options = {})
      : SuiteMethod(oracle, options.runner), method_(method), options_(options) {}

  std::optional<Word> find_counterexample(const Mealy& hypothesis,
                                          const RunControl& control = {}) override;

 private:
  IdentifierMethod method_;
  CompleteMethodOptions options_;
};

// Vasilevskii, "Failure diagnosis of automata", 1973; Chow, "Testing software design modeled by
// finite-state machines", IEEE TSE 1978.
class WMethod : public CompleteMethod {
 public:
  explicit WMethod(OutputOracle& oracle, CompleteMethodOptions options = {})
      : CompleteMethod(oracle, w_identifiers, options) {}
};

class WpMethod : public CompleteMethod {
 public:
  explicit WpMethod(OutputOracle& oracle, CompleteMethodOptions options = {})
      : CompleteMethod(oracle, wp_identifiers, options) {}
};

class HsiMethod : public CompleteMethod {
 public:
  explicit HsiMethod(OutputOracle& oracle, CompleteMethodOptions options = {})
      : CompleteMethod(oracle, hsi_identifiers, options) {}
};

class HybridAds : public CompleteMethod {
 public:
  explicit HybridAds(OutputOracle& oracle, CompleteMethodOptions options = {})
      : CompleteMethod(oracle, hads_identifiers, options) {}
};

}  // namespace maide
