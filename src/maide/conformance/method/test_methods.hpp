// The methods of equivalence testing and their options, by name: the one place that the command
// line, its help, `--eq`, system files and experiments read.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "maide/conformance/method/test_runner.hpp"
#include "maide/conformance/suite/random_identifier_suite.hpp"
#include "maide/learn/cache/cache.hpp"
#include "maide/learn/oracle/equivalence_oracle.hpp"
#include "maide/learn/oracle/output_oracle.hpp"

namespace maide {

// What is not set is the method's own default. Each is a row of test_options(), which says what it
// means; sizes, budget and batch size are not for people.
struct TestMethodOptions {
  std::optional<std::size_t> extra_states, infix_min, ways, walks, walk_length, min_length,
      max_length;
  std::optional<std::uint64_t> max_tests;
  std::optional<double> infix_mean, restart_probability;
  std::optional<InfixInputs> infix_inputs;
  std::optional<PrefixStates> prefix_states;
  std::optional<SuffixWords> suffix_words;
  std::string strength;      // as parse_demand reads it
  std::uint64_t effort = 1;  // how many times `budget` may be spent
  std::uint64_t seed = 0;
  std::vector<std::size_t> sizes;  // of standard: the numbers that the system's options name
  TestCost budget;                 // of standard: most words and symbols; 0: its own
  std::size_t batch_size = TestRunnerOptions{}.batch_size;

  // `budget` times `effort`, saturating.
  TestCost whole_budget() const;
};

// An option of test methods: `--KEY VALUE` of the commands that test, `KEY=VALUE` of a method in
// `--eq`, a key of `learning:` in a system file. Help, checks and documentation are made from the
// row.
struct TestOption {
  std::string_view key;    // "extra-states"
  std::string_view value;  // what a value looks like, for help: "N", "X", "NAME"
  std::string_view help;
  // Throws UsageError for a text that is no value of it.
  void (*set)(TestMethodOptions& options, const std::string& value);
  bool is_of_run = false;  // it means something whatever the method
};

// All of them, in the order of the help.
std::span<const TestOption> test_options();

// Throws UsageError if there is none of this key.
const TestOption& find_test_option(std::string_view key);
// Throws UsageError, as that and for a text that is no value of it.
void set_test_option(TestMethodOptions& options, std::string_view key, const std::string& value);

// What a method tests on.
struct TestMethodContext {
  OutputOracle& oracle;              // the tests are run here
  Cache* cache = nullptr;            // if given, a TestChain compares hypotheses with it first
  const Mealy* reference = nullptr;  // the system as a machine, where it is known (simulations)
};

struct TestMethodEntry {
  std::string_view name;         // as in `--eq NAME`
  std::string_view description;  // one line, for help
  std::string_view options;      // the keys of those it looks at, separated by spaces
  std::unique_ptr<EquivalenceOracle> (*make)(const TestMethodContext&, const TestMethodOptions&);
};

// All of them, the default first.
std::span<const TestMethodEntry> test_methods();

// The method of this name; throws UsageError that lists the known ones. What it makes keeps
// references to the context's parts; `make` throws UsageError where the method cannot work on it
// (`perfect` without a reference).
const TestMethodEntry& find_test_method(std::string_view name);

// Whether the method looks at the option of this key.
bool heeds(const TestMethodEntry& method, std::string_view option);

// The names of the methods that look at an option: "w, wp, hsi".
std::string methods_with(std::string_view option);

}  // namespace maide
