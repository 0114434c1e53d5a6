// The methods of equivalence testing by name: the one place that the command line, its help and the
// experiments read.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "maide/conformance/random_identifier_suite.hpp"
#include "maide/conformance/test_runner.hpp"
#include "maide/learn/cache.hpp"
#include "maide/learn/equivalence_oracle.hpp"
#include "maide/learn/output_oracle.hpp"

namespace maide {

// What is not set is the method's own default; what a method does not use, it does not look at.
struct TestMethodOptions {
  std::optional<std::size_t> extra_states;    // w, wp, hsi, hads, transition-cover, standard
  std::optional<std::uint64_t> max_tests;     // of one equivalence query
  std::optional<std::size_t> min_length;      // random-words
  std::optional<std::size_t> max_length;      // random-words, random-walk
  std::optional<double> restart_probability;  // random-walk
  std::optional<std::size_t> infix_min;       // random-w, random-wp, random-hsi, random-hads
  std::optional<double> infix_mean;           // likewise
  std::optional<InfixInputs> infix_inputs;    // likewise
  std::optional<PrefixStates> prefix_states;  // likewise
  std::optional<SuffixWords> suffix_words;    // likewise
  std::optional<std::size_t> ways;            // state-cover, k-way
  std::optional<std::size_t> walks;           // likewise
  std::optional<std::size_t> walk_length;     // likewise
  std::string strength;            // of standard: what to reach instead, as parse_demand reads it
  std::vector<std::size_t> sizes;  // of standard: the numbers that the system's options name
  TestCost budget;                 // of standard: most words and symbols; 0: its own
  std::uint64_t seed = 0;
  std::size_t batch_size = TestRunnerOptions{}.batch_size;
};

// What a method tests on.
struct TestMethodContext {
  OutputOracle& oracle;              // the tests are run here
  Cache* cache = nullptr;            // if given, a TestChain compares hypotheses with it first
  const Mealy* reference = nullptr;  // the system as a machine, where it is known (simulations)
};

struct TestMethodEntry {
  std::string_view name;         // as in `--eq NAME`
  std::string_view description;  // one line, for help
  std::string_view options;      // the options it looks at, separated by spaces
  std::unique_ptr<EquivalenceOracle> (*make)(const TestMethodContext&, const TestMethodOptions&);
};

// All of them, the default first.
std::span<const TestMethodEntry> test_methods();

// The method of this name; throws UsageError that lists the known ones. What it makes keeps
// references to the context's parts; `make` throws UsageError where the method cannot work on it
// (`perfect` without a reference).
const TestMethodEntry& find_test_method(std::string_view name);

// The names of the methods that look at an option: "w, wp, hsi".
std::string methods_with(std::string_view option);

}  // namespace maide
