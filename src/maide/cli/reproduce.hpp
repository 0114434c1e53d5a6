// What the parts of `maide reproduce` share: its arguments, and learning as the paper did.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "maide/base/error.hpp"
#include "maide/cli/context.hpp"
#include "maide/workflow/learn_model.hpp"

namespace maide::cli {

struct ReproduceArguments {
  std::string what;
  std::vector<std::string> systems;
  std::string algorithm = "lmplus";  // the paper's
  std::string test_method;
  std::uint64_t seed = 1;
  std::size_t jobs = 0;
};

// Throws what ended the run early.
LearnedModel learn_for_reproduction(const std::string& system,
                                    const std::map<std::string, std::string>& options,
                                    const ReproduceArguments& arguments, const RunControl& control);

// The systems to learn from: those asked for, else all of `known` that are on this machine. Throws
// UsageError if one is unknown, or there is none.
std::vector<std::string> chosen_systems(const std::vector<std::string>& known,
                                        const ReproduceArguments& arguments, Context& context);

// Table 2: the two case studies, checked on models learned anew.
ExitStatus reproduce_table2(const ReproduceArguments& arguments, Context& context);

// Figure 3: what becomes of a write that waits when its port is interrupted.
ExitStatus reproduce_interrupt(const ReproduceArguments& arguments, Context& context);

}  // namespace maide::cli
