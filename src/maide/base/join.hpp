// Lists in messages: "a, b, c".
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace maide {

// The names with the separator between them; "" for none.
inline std::string join(std::span<const std::string> names, std::string_view separator = ", ") {
  std::string text;
  for (const std::string& name : names) {
    if (&name != &names.front()) text += separator;
    text += name;
  }
  return text;
}

}  // namespace maide
