// The number is handed in by the build, for this file alone.
#include "maide/base/version.hpp"

namespace maide {

std::string_view version() noexcept { return MAIDE_VERSION; }

}  // namespace maide
