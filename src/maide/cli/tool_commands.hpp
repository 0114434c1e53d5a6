// Commands whose work is done by a program of its own, which lies beside `maide` or in
// ../libexec/maide: `maide bench` is maide-bench, `maide reproduce` is maide-reproduce. They serve
// who measures Maide, so they are not in the library. Options are declared here once, for both
// sides: `maide` checks them, has their help, manual page and completion, and starts the program
// with the same words.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "maide/cli/command.hpp"
#include "maide/cli/command_line.hpp"
#include "maide/cli/test_arguments.hpp"

namespace maide::cli {

struct BenchArguments {
  std::string folder;
  std::string csv;
  std::string start_from;
  TestArguments tests{.method = "perfect", .values = {}};
  std::vector<std::string> algorithms;  // none: all
  std::uint64_t seed = 1;
  double seconds = 60;                // most of one run
  std::uint64_t max_experiments = 0;  // most words of one run that reach the system; 0: no limit
  std::size_t jobs = 0;               // runs at once; 0: one for each processor
  bool no_cache = false;
};

struct ReproduceArguments {
  std::string what;
  std::vector<std::string> systems;
  std::string algorithm = "lmplus";  // the paper's
  std::string test_method;
  std::uint64_t seed = 1;
  std::size_t jobs = 0;
};

// The systems that Table 1 can be learned from, in the order of reproduce/paper.yaml.
inline constexpr std::array<std::string_view, 7> reproduced_systems{
    "yarp", "port", "cyclonedds", "fastdds", "zeromq", "ros1", "mqtt"};

// `arguments` must live as long as the line.
void declare_bench(CommandLine& line, BenchArguments& arguments);
void declare_reproduce(CommandLine& line, ReproduceArguments& arguments);

// The main() of such a program: parses the words behind its name as those of `maide NAME`, and
// calls what `set_up` returns. Never throws. Returns the exit status.
int run_tool(std::string_view name, RunFunction (*set_up)(CommandLine& line), int argc,
             const char* const* argv) noexcept;

}  // namespace maide::cli
