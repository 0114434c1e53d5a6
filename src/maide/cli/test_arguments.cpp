#include "maide/cli/test_arguments.hpp"

#include <CLI/CLI.hpp>
#include <array>
#include <utility>

#include "maide/automata/strength.hpp"
#include "maide/base/error.hpp"
#include "maide/cli/argument_check.hpp"
#include "maide/conformance/test_chain.hpp"
#include "maide/workflow/nondeterministic_run.hpp"

namespace maide::cli {
namespace {

// The options of methods that were given, by their names there.
std::vector<std::string> given_options(const TestArguments& arguments) {
  const std::pair<const char*, bool> all[]{{"extra-states", arguments.extra_states.has_value()},
                                           {"max-tests", arguments.max_tests.has_value()},
                                           {"infix-min", arguments.infix_min.has_value()},
                                           {"infix-mean", arguments.infix_mean.has_value()},
                                           {"infix-inputs", !arguments.infix_inputs.empty()},
                                           {"prefix-states", !arguments.prefix_states.empty()},
                                           {"suffix-words", !arguments.suffix_words.empty()},
                                           {"ways", arguments.ways.has_value()},
                                           {"walks", arguments.walks.has_value()},
                                           {"walk-length", arguments.walk_length.has_value()}};
  std::vector<std::string> given;
  for (const auto& [name, is_given] : all) {
    if (is_given) given.emplace_back(name);
  }
  return given;
}

void check_nondeterministic(const TestArguments& arguments) {
  std::vector<std::string> given = given_options(arguments);
  if (!arguments.strength.empty()) given.emplace_back("strength");
  if (arguments.effort) given.emplace_back("effort");
  for (const std::string& option : given) {
    if (option == "extra-states" || option == "max-tests") continue;
    throw UsageError("the tests of " + std::string(nstar_name) + " have no option '" + option +
                     "'; they have: extra-states max-tests");
  }
}

}  // namespace

void TestArguments::check(const std::string& algorithm) const {
  if (algorithm == nstar_name) return check_nondeterministic(*this);
  const TestChain chain(method);
  for (const std::string& option : given_options(*this)) chain.require(option);
  const std::string_view standard = test_methods().front().name;
  if (effort && !chain.has(standard)) {
    throw UsageError("--effort is for the equivalence method '" + std::string(standard) +
                     "', not for '" + method + "'");
  }
  if (!strength.empty()) parse_demand(strength, {});
}

TestMethodOptions TestArguments::read() const {
  TestMethodOptions options;
  options.extra_states = extra_states;
  options.max_tests = max_tests;
  options.infix_min = infix_min;
  options.infix_mean = infix_mean;
  if (!infix_inputs.empty()) options.infix_inputs = find_infix_inputs(infix_inputs);
  if (!prefix_states.empty()) options.prefix_states = find_prefix_states(prefix_states);
  if (!suffix_words.empty()) options.suffix_words = find_suffix_words(suffix_words);
  options.ways = ways;
  options.walks = walks;
  options.walk_length = walk_length;
  options.strength = strength;
  return options;
}

void add_test_options(CLI::App& app, TestArguments& arguments) {
  app.add_option("--eq", arguments.method,
                 describe_entries(test_methods()) +
                     ". Several with commas between are asked in turn, each with options of its "
                     "own: w:extra-states=1,random-hads:max-tests=5000");
  app.add_option("--extra-states", arguments.extra_states,
                 "How many states more than the hypothesis the system may have for the tests to "
                 "find it (--eq " +
                     methods_with("extra-states") + ")")
      ->check(check_count);
  app.add_option("--infix-min", arguments.infix_min,
                 "Fewest random inputs in the middle of a test (--eq random-w, random-wp, "
                 "random-hsi, random-hads)")
      ->check(check_count);
  app.add_option("--infix-mean", arguments.infix_mean,
                 "How many more there are on average (likewise)")
      ->check(CLI::Range(0.0, 1e6));
  app.add_option("--infix-inputs", arguments.infix_inputs,
                 "How they are drawn: off-sinks (seldom those that lead where most transitions "
                 "lead), off-loops (seldom those that change nothing), few (four inputs at most), "
                 "replayed (pieces of the counterexamples so far), mixed (for each test another "
                 "one of these; the default), uniform (likewise)")
      ->check(CLI::IsMember({"mixed", "off-sinks", "off-loops", "few", "replayed", "uniform"}));
  app.add_option("--prefix-states", arguments.prefix_states,
                 "Where a test begins: uniform (in each state alike; the default), deep (in the "
                 "farther of two), transitions (behind each transition alike) (likewise)")
      ->check(CLI::IsMember({"uniform", "deep", "transitions"}));
  app.add_option("--suffix-words", arguments.suffix_words,
                 "How a test ends: own (by a word that identifies the state reached; the "
                 "default), any (by one of a random state), none (at once) (likewise)")
      ->check(CLI::IsMember({"own", "any", "none"}));
  app.add_option("--ways", arguments.ways,
                 "How many states or transitions a test passes, in each order (--eq " +
                     methods_with("ways") + "; default: 1, 2)")
      ->check(check_count);
  app.add_option("--walks", arguments.walks,
                 "How many tests pass the same states or transitions (likewise; default: 10, 1)")
      ->check(check_count);
  app.add_option("--walk-length", arguments.walk_length,
                 "How many random inputs follow in each (likewise; default: 10)")
      ->check(check_count);
  app.add_option("--max-tests", arguments.max_tests,
                 "Most tests of one equivalence query, of each of its methods")
      ->check(check_count);
  app.add_option("--strength", arguments.strength,
                 "What the tests must reach, or the exit status is 3: extra-states=N (no machine "
                 "with N states more behaves differently), chained=N (in each state, all words of "
                 "N inputs that loop there), pumped=N (each of them N times in a row), random=N "
                 "(random tests), with commas between; for what is not named: what every model "
                 "must reach not to be weak");
  app.add_option("--effort", arguments.effort,
                 "How many times the usual number of words and symbols the tests may cost before "
                 "a model is left weak (usual: 10^6 words and 3*10^7 symbols for a simulated "
                 "system, 20,000 words and 10^6 symbols for a real one); 1 to 1000, default: 1")
      ->check(CLI::Range(1, 1000));
}

}  // namespace maide::cli
