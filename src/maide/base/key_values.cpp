// The first '=' separates: a value may contain others.
#include "maide/base/key_values.hpp"

#include <algorithm>

#include "maide/base/error.hpp"

namespace maide {

std::string normalised_key(std::string_view key) {
  std::string normalised(key);
  std::replace(normalised.begin(), normalised.end(), '-', '_');
  return normalised;
}

std::map<std::string, std::string> parse_key_values(std::span<const std::string> words) {
  std::map<std::string, std::string> given;
  for (const std::string& word : words) {
    const std::size_t equals = word.find('=');
    if (equals == std::string::npos || equals == 0) {
      throw UsageError("'" + word + "' is not an option of the form key=value");
    }
    const std::string key = word.substr(0, equals);
    if (!given.emplace(normalised_key(key), word.substr(equals + 1)).second) {
      throw UsageError("option '" + key + "' is given twice");
    }
  }
  return given;
}

}  // namespace maide
