#include "maide/base/invariant.hpp"

#include <stdexcept>
#include <string>
#include <string_view>

namespace maide {

void fail_check(const char* condition, const char* file, int line) {
  std::string_view place = file;
  const std::size_t source = place.rfind("/maide/");
  if (source != std::string_view::npos) place.remove_prefix(source + 1);
  throw std::logic_error("check failed: " + std::string(condition) + " (" + std::string(place) +
                         ":" + std::to_string(line) + ")");
}

}  // namespace maide
