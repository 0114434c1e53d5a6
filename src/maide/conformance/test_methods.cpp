#include "maide/conformance/test_methods.hpp"

#include <array>
#include <utility>
#include <vector>

#include "maide/base/error.hpp"
#include "maide/base/join.hpp"
#include "maide/base/named_table.hpp"
#include "maide/conformance/complete_method.hpp"
#include "maide/conformance/coverage_suite.hpp"
#include "maide/conformance/perfect_oracle.hpp"
#include "maide/conformance/random_walk.hpp"
#include "maide/conformance/random_words.hpp"
#include "maide/conformance/standard_method.hpp"

namespace maide {
namespace {

using Oracle = std::unique_ptr<EquivalenceOracle>;

// Sets a field of a method's options where the user set one.
template <typename Field, typename Value>
void set(Field& field, const std::optional<Value>& value) {
  if (value) field = *value;
}

Oracle make_standard(const TestMethodContext& context, const TestMethodOptions& options) {
  StandardMethodOptions method{.seed = options.seed, .batch_size = options.batch_size};
  set(method.extra_states, options.extra_states);
  method.max_tests = options.max_tests;
  method.strength = options.strength;
  method.sizes = options.sizes;
  if (options.budget.words != 0) method.budget = options.budget;
  return std::make_unique<StandardMethod>(context.oracle, method);
}

template <const IdentifierMethod& identifiers>
Oracle make_complete(const TestMethodContext& context, const TestMethodOptions& options) {
  CompleteMethodOptions method{.seed = options.seed};
  method.runner.batch_size = options.batch_size;
  set(method.extra_states, options.extra_states);
  set(method.runner.max_tests, options.max_tests);
  return std::make_unique<CompleteMethod>(context.oracle, identifiers, method);
}

template <const IdentifierMethod& identifiers>
Oracle make_random(const TestMethodContext& context, const TestMethodOptions& options) {
  RandomMethodOptions method{.seed = options.seed, .batch_size = options.batch_size};
  set(method.infix.min, options.infix_min);
  set(method.infix.mean, options.infix_mean);
  set(method.infix.inputs, options.infix_inputs);
  set(method.ends.prefix, options.prefix_states);
  set(method.ends.suffix, options.suffix_words);
  set(method.max_tests, options.max_tests);
  return std::make_unique<RandomMethod>(context.oracle, identifiers, method);
}

Oracle make_random_words(const TestMethodContext& context, const TestMethodOptions& options) {
  RandomWordsOptions method{.seed = options.seed, .batch_size = options.batch_size};
  set(method.max_tests, options.max_tests);
  set(method.min_length, options.min_length);
  set(method.max_length, options.max_length);
  return std::make_unique<RandomWords>(context.oracle, method);
}

Oracle make_random_walk(const TestMethodContext& context, const TestMethodOptions& options) {
  RandomWalkOptions method{.seed = options.seed, .batch_size = options.batch_size};
  set(method.max_tests, options.max_tests);
  set(method.max_length, options.max_length);
  set(method.restart_probability, options.restart_probability);
  return std::make_unique<RandomWalk>(context.oracle, method);
}

template <Covered covered>
Oracle make_coverage(const TestMethodContext& context, const TestMethodOptions& options) {
  CoverageOptions method{.covered = covered, .ways = covered == Covered::states ? 1U : 2U};
  TestRunnerOptions runner{.batch_size = options.batch_size};
  set(method.ways, options.ways);
  if (covered == Covered::states) method.walks = CoverageOptions::walks_of_state_cover;
  set(method.walks, options.walks);
  set(method.walk_length, options.walk_length);
  set(runner.max_tests, options.max_tests);
  return std::make_unique<CoverageMethod>(context.oracle, method, runner, options.seed);
}

Oracle make_perfect(const TestMethodContext& context, const TestMethodOptions&) {
  if (context.reference == nullptr) {
    throw UsageError("the perfect oracle needs a simulated system (sim:FILE.dot)");
  }
  return std::make_unique<PerfectOracle>(*context.reference);
}

constexpr std::string_view random_options =
    "prefix-states infix-min infix-mean infix-inputs suffix-words max-tests seed";

constexpr std::string_view coverage_options = "ways walks walk-length max-tests seed";

constexpr std::array table{
    TestMethodEntry{"standard",
                    "hads for one extra state or more, random-hads, and chains and repetitions of "
                    "looping inputs",
                    "extra-states max-tests seed", make_standard},
    TestMethodEntry{"w", "W-method (Chow, Vasilevskii), complete for extra-states",
                    "extra-states max-tests", make_complete<w_identifiers>},
    TestMethodEntry{"wp", "the same by fewer tests: each state's own part of the set (Fujiwara)",
                    "extra-states max-tests", make_complete<wp_identifiers>},
    TestMethodEntry{"hsi", "the same by fewer tests: harmonised identifiers (Petrenko)",
                    "extra-states max-tests", make_complete<hsi_identifiers>},
    TestMethodEntry{"hads", "the same by fewest tests: adaptive words, hybrid ADS (Smeenk et al.)",
                    "extra-states max-tests seed", make_complete<hads_identifiers>},
    TestMethodEntry{"random-w", "access word, random infix, word of the W-method", random_options,
                    make_random<w_identifiers>},
    TestMethodEntry{"random-wp", "the same with the words of Wp", random_options,
                    make_random<wp_identifiers>},
    TestMethodEntry{"random-hsi", "the same with those of HSI", random_options,
                    make_random<hsi_identifiers>},
    TestMethodEntry{"random-hads", "the same with those of hybrid ADS", random_options,
                    make_random<hads_identifiers>},
    TestMethodEntry{"transition-cover",
                    "each path of extra-states + 1 transitions from each state; identifies nothing",
                    "extra-states max-tests", make_complete<no_identifiers>},
    TestMethodEntry{"state-cover", "each state, or each so many in each order (ways), and walks",
                    coverage_options, make_coverage<Covered::states>},
    TestMethodEntry{"k-way", "each 2 transitions, or so many (ways), in each order, and a walk",
                    coverage_options, make_coverage<Covered::transitions>},
    TestMethodEntry{"random-words", "independent random words",
                    "max-tests min-length max-length seed", make_random_words},
    TestMethodEntry{"random-walk", "random inputs with random resets",
                    "max-tests max-length restart-probability seed", make_random_walk},
    TestMethodEntry{"perfect", "compares with the simulated model; sends nothing", "",
                    make_perfect},
};

}  // namespace

std::span<const TestMethodEntry> test_methods() { return table; }

const TestMethodEntry& find_test_method(std::string_view name) {
  return find_row(test_methods(), "equivalence method", name);
}

std::string methods_with(std::string_view option) {
  std::vector<std::string> names;
  for (const TestMethodEntry& method : table) {
    if (method.options.find(option) != std::string_view::npos) names.emplace_back(method.name);
  }
  return join(names);
}

}  // namespace maide
