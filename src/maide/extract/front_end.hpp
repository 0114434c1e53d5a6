// Reads C++ by `cppcheck --dump`, a program of Debian that needs neither headers nor a build. It
// runs nothing of what it reads.
//
// It fails closed. A version whose dumps are not known is refused. A fault of the sources is each
// message of cppcheck, and each file that it refuses. So is a conditional of the preprocessor
// around code. So is a call that stands in the text and in no dump.
#pragma once

#include <filesystem>
#include <functional>
#include <set>
#include <string>
#include <vector>

#include "maide/base/run_control.hpp"
#include "maide/extract/sources.hpp"

namespace maide::extract {

struct FrontEndOptions {
  std::vector<std::string> include_folders;
  std::string macro_definitions;  // lines of `#define`, in front of each file
  std::set<std::string> macro_names;
  std::function<void(std::size_t done, std::size_t of, const std::string& file)> progress;
};

// The C++ sources of files and folders, in order of their names. Throws UsageError if there is
// none.
std::vector<std::filesystem::path> find_sources(const std::vector<std::string>& arguments);

// Throws UsageError if cppcheck is not there or of a version that is not known, Interrupted if
// `control` says stop.
Sources read_sources(const std::vector<std::filesystem::path>& files,
                     const FrontEndOptions& options, const RunControl& control);

}  // namespace maide::extract
