#include "maide/cli/test_arguments.hpp"

#include "maide/base/error.hpp"
#include "maide/conformance/method/test_chain.hpp"
#include "maide/experiment/experiment.hpp"
#include "maide/learn/learner.hpp"

namespace maide::cli {

void TestArguments::check(const std::string& algorithm) const {
  if (!find_learner(algorithm).is_nondeterministic()) TestChain known(method);  // or it throws
  for (const auto& [key, value] : values) {
    if (!value.empty()) require_test_option(algorithm, method, key);
  }
}

TestMethodOptions TestArguments::read() const {
  TestMethodOptions options;
  for (const auto& [key, value] : values) {
    if (!value.empty()) set_test_option(options, key, value);
  }
  return options;
}

void add_test_options(CommandLine& line, TestArguments& arguments) {
  line.add("--eq", arguments.method, "How hypotheses are tested ('maide help tests')")
      .offer(names_of(test_methods()))
      .value_name("METHOD");
  for (const TestOption& option : test_options()) {
    if (option.key == "seed") continue;
    const std::string key(option.key);
    line.add("--" + key, arguments.values[key],
             std::string(option.help) +
                 (option.is_of_run ? "" : " (--eq " + methods_with(option.key) + ")"))
        .check([&option](const std::string& value) {
          TestMethodOptions tried;
          try {
            option.set(tried, value);
          } catch (const UsageError& error) {
            return std::string(error.what());
          }
          return std::string();
        })
        .no_default()
        .value_name(std::string(option.value))
        .topic("tests");
  }
}

}  // namespace maide::cli
