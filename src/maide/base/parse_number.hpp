// A number that is the whole of a text, as options and files have them.
#pragma once

#include <charconv>
#include <optional>
#include <string_view>
#include <system_error>

namespace maide {

// Nothing unless all of `text` is a number that Number holds: no blanks, no sign +, no rest.
template <typename Number>
std::optional<Number> parse_number(std::string_view text) {
  Number value{};
  const char* const end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc() || rest != end) return std::nullopt;
  return value;
}

}  // namespace maide
