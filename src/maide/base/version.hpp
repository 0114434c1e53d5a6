// The version of Maide: one number for the library, the command line and the wrappers; it comes
// from the project() line of the build.
#pragma once

#include <string_view>

namespace maide {

// "major.minor.patch" (Semantic Versioning).
std::string_view version() noexcept;

}  // namespace maide
