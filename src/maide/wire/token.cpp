#include "maide/wire/token.hpp"

#include <algorithm>
#include <cstdlib>

#include "maide/base/error.hpp"
#include "maide/base/file.hpp"

namespace maide {

std::optional<std::string> read_token(const std::optional<std::string>& file) {
  if (!file) {
    const char* variable = std::getenv("MAIDE_TOKEN");
    if (variable == nullptr || *variable == '\0') return std::nullopt;
    return variable;
  }
  std::string token = read_file(*file);
  token.erase(std::min(token.find_first_of("\r\n"), token.size()));
  if (token.empty()) throw UsageError("there is no token in the file (" + *file + ")");
  return token;
}

}  // namespace maide
