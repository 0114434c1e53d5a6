// How hypotheses are tested, as a person types it: `--algorithm`, `--eq`, and an option for each
// row of test_options().
#pragma once

#include <map>
#include <string>

#include "maide/cli/command_line.hpp"
#include "maide/conformance/method/test_methods.hpp"

namespace maide::cli {

struct TestArguments {
  std::string method{test_methods().front().name};
  std::map<std::string, std::string, std::less<>> values;  // by key; "": not given

  // Throws UsageError for an unknown algorithm or method, and for an option that neither looks at.
  void check(const std::string& algorithm) const;
  // Without sizes and budget, which depend on the system.
  TestMethodOptions read() const;
};

// Declares all of them but the seed, which commands have in common. `arguments` must live as long
// as the line.
void add_test_options(CommandLine& line, TestArguments& arguments);

}  // namespace maide::cli
