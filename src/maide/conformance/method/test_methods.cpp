#include "maide/conformance/method/test_methods.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "maide/automata/strength.hpp"
#include "maide/base/error.hpp"
#include "maide/base/numbers.hpp"
#include "maide/base/text.hpp"
#include "maide/conformance/method/complete_method.hpp"
#include "maide/conformance/method/perfect_oracle.hpp"
#include "maide/conformance/method/standard_method.hpp"
#include "maide/conformance/suite/coverage_suite.hpp"
#include "maide/conformance/suite/random_words.hpp"

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
  if (options.budget.words != 0) method.budget = options.whole_budget();
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
                    "extra-states max-tests strength effort seed", make_standard},
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

std::uint64_t read_count(const std::string& value, std::uint64_t least = 0,
                         std::uint64_t most = ~std::uint64_t{0}) {
  const auto number = parse_number<std::uint64_t>(value);
  if (number && *number >= least && *number <= most) return *number;
  throw UsageError(fmt::format("'{}' is not a whole number from {} to {}", value, least, most));
}

double read_number(const std::string& value, double least, double most) {
  const auto number = parse_number<double>(value);
  if (number && *number >= least && *number <= most) return *number;
  throw UsageError(fmt::format("'{}' is not a number from {} to {}", value, least, most));
}

// Sets a field that has a number.
template <auto field>
void set_count(TestMethodOptions& options, const std::string& value) {
  options.*field = read_count(value);
}

using Options = TestMethodOptions;

constexpr std::array options_table{
    TestOption{"extra-states", "N",
               "How many states more than the hypothesis the system may have for the tests to find "
               "it",
               set_count<&Options::extra_states>},
    TestOption{"prefix-states", "NAME",
               "Where a test begins: uniform (in each state alike; the default), deep (in the "
               "farther of two), transitions (behind each transition alike)",
               [](Options& options, const std::string& value) {
                 options.prefix_states = find_prefix_states(value);
               }},
    TestOption{"infix-min", "N", "Fewest random inputs in the middle of a test",
               set_count<&Options::infix_min>},
    TestOption{"infix-mean", "X", "How many random inputs more there are on average",
               [](Options& options, const std::string& value) {
                 options.infix_mean = read_number(value, 0, 1e6);
               }},
    TestOption{"infix-inputs", "NAME",
               "How these inputs are drawn: off-sinks (seldom those that lead where most "
               "transitions lead), off-loops (seldom those that change nothing), few (four inputs "
               "at most), replayed (pieces of the counterexamples so far), mixed (for each test "
               "another one of these; the default), uniform",
               [](Options& options, const std::string& value) {
                 options.infix_inputs = find_infix_inputs(value);
               }},
    TestOption{"suffix-words", "NAME",
               "How a test ends: own (by a word that identifies the state reached; the default), "
               "any (by one of a random state), none (at once)",
               [](Options& options, const std::string& value) {
                 options.suffix_words = find_suffix_words(value);
               }},
    TestOption{"ways", "N",
               "How many states or transitions a test passes, in each order (default: 1, 2)",
               set_count<&Options::ways>},
    TestOption{"walks", "N", "How many tests pass the same states or transitions (default: 10, 1)",
               set_count<&Options::walks>},
    TestOption{"walk-length", "N", "How many random inputs follow in each of them (default: 10)",
               set_count<&Options::walk_length>},
    TestOption{"min-length", "N", "Fewest inputs of a random word",
               set_count<&Options::min_length>},
    TestOption{"max-length", "N", "Most inputs of a random word or walk",
               set_count<&Options::max_length>},
    TestOption{"restart-probability", "X", "How often a walk begins again, at each input",
               [](Options& options, const std::string& value) {
                 options.restart_probability = read_number(value, 0, 1);
               }},
    TestOption{"max-tests", "N", "Most tests of one equivalence query, of each of its methods",
               set_count<&Options::max_tests>},
    TestOption{
        "strength", "TEXT",
        "What the tests must reach, or the exit status is 3: extra-states=N (no machine with "
        "N states more behaves differently), chained=N (in each state, all words of N "
        "inputs that loop there), pumped=N (each of them N times in a row), random=N (random "
        "tests), with commas between; for what is not named: what every model must reach "
        "not to be weak",
        [](Options& options, const std::string& value) {
          parse_demand(value, {});
          options.strength = value;
        },
        true},
    TestOption{"effort", "N",
               "How many times the usual number of words and symbols the tests may cost before a "
               "model is left weak (usual: 10^6 words and 3*10^7 symbols for a simulated system, "
               "20,000 words and 10^6 symbols for a real one); 1 to 1000, default: 1",
               [](Options& options, const std::string& value) {
                 options.effort = read_count(value, 1, 1000);
               }},
    TestOption{"seed", "N", "Seed of the random tests",
               [](Options& options, const std::string& value) { options.seed = read_count(value); },
               true},
};

}  // namespace

TestCost TestMethodOptions::whole_budget() const {
  return {saturating_product(budget.words, effort), saturating_product(budget.symbols, effort)};
}

std::span<const TestOption> test_options() { return options_table; }

const TestOption& find_test_option(std::string_view key) {
  for (const TestOption& option : options_table) {
    if (option.key == key) return option;
  }
  std::vector<std::string> keys;
  for (const TestOption& option : options_table) keys.emplace_back(option.key);
  throw UsageError("tests have no option '" + std::string(key) + "'; they may have: " + join(keys) +
                   did_you_mean(key, keys));
}

void set_test_option(TestMethodOptions& options, std::string_view key, const std::string& value) {
  try {
    find_test_option(key).set(options, value);
  } catch (const UsageError& error) {
    throw UsageError(std::string(key) + ": " + error.what());
  }
}

std::span<const TestMethodEntry> test_methods() { return table; }

const TestMethodEntry& find_test_method(std::string_view name) {
  return find_row(test_methods(), "equivalence method", name);
}

bool heeds(const TestMethodEntry& method, std::string_view option) {
  const std::vector<std::string_view> keys = split(method.options, ' ');
  return std::ranges::find(keys, option) != keys.end();
}

std::string methods_with(std::string_view option) {
  std::vector<std::string> names;
  for (const TestMethodEntry& method : table) {
    if (heeds(method, option)) names.emplace_back(method.name);
  }
  return join(names);
}

}  // namespace maide
