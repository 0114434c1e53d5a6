// How hypotheses are tested, as a person types it: `--eq`, the options of its methods, how strong
// the model is to be, and how much that may cost.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "maide/conformance/test_methods.hpp"

namespace CLI {
class App;
}  // namespace CLI

namespace maide::cli {

struct TestArguments {
  std::string method{test_methods().front().name};
  std::optional<std::size_t> extra_states;
  std::optional<std::uint64_t> max_tests;
  std::optional<std::size_t> infix_min;
  std::optional<double> infix_mean;
  std::string infix_inputs;
  std::string prefix_states;
  std::string suffix_words;
  std::optional<std::size_t> ways;
  std::optional<std::size_t> walks;
  std::optional<std::size_t> walk_length;
  std::string strength;
  std::optional<std::uint64_t> effort;

  // Throws UsageError for an unknown method, an option that no method of `method` looks at, and a
  // malformed strength. `algorithm` may be nstar, which has tests of its own.
  void check(const std::string& algorithm) const;
  // Without seed, sizes and budget, which depend on the system.
  TestMethodOptions read() const;
};

// Declares all of them. `arguments` must live as long as the app.
void add_test_options(CLI::App& app, TestArguments& arguments);

// "lmplus: Shahbaz's L*M+; rs: ...", for help texts.
template <typename Entries>
std::string describe_entries(const Entries& entries) {
  std::string text;
  for (const auto& entry : entries) {
    if (!text.empty()) text += "; ";
    text.append(entry.name).append(": ").append(entry.description);
  }
  return text;
}

}  // namespace maide::cli
