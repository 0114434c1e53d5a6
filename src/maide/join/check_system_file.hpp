// From a system file to a verdict: the file is read, its models are loaded or learned, the system
// is checked, and what is shown are runs that executors can do. The command line, maide::check()
// and Python all come here, so what one of them says, all say.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "maide/check/build/system_file.hpp"
#include "maide/check/verdict/check_system.hpp"
#include "maide/join/learned_models.hpp"

namespace maide {

struct CheckedSystem {
  System system;
  CheckReport report;
};

// Throws UsageError, before anything is read, for options that do not fit the engine; then what
// reading, learning and checking throw. `request.options.control` limits all of it. `settings` are
// other values of constants.
CheckedSystem check_system_file(const std::filesystem::path& path, Engine& engine,
                                const CheckRequest& request, const LearnedModelsOptions& models,
                                const std::vector<ConstantSetting>& settings = {});

// Checks the text of a file, for who reads it once and checks it again with other models.
CheckedSystem check_system_text(std::string_view text, const std::string& file, Engine& engine,
                                const CheckRequest& request, const ModelSource& models,
                                const std::vector<ConstantSetting>& settings = {});

}  // namespace maide
