// Small helpers over numbers: bits and their count, counts that saturate, and a number read from a
// text.
#pragma once

#include <bit>
#include <charconv>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string_view>
#include <system_error>

namespace maide {

// The lowest `count` bits, 0..64.
constexpr std::uint64_t low_bits(unsigned count) {
  return count >= 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << count) - 1;
}

// The bits that it takes to tell `count` things apart.
constexpr unsigned bits_for(std::size_t count) {
  return count <= 1 ? 0 : static_cast<unsigned>(std::bit_width(count - 1));
}

// Counts that may exceed 64 bits saturate: the largest is 2^64 - 1.

inline constexpr std::uint64_t saturated = std::numeric_limits<std::uint64_t>::max();

inline std::uint64_t saturating_product(std::uint64_t left, std::uint64_t right) {
  std::uint64_t result;
  return __builtin_mul_overflow(left, right, &result) ? saturated : result;
}

inline std::uint64_t saturating_sum(std::uint64_t left, std::uint64_t right) {
  std::uint64_t result;
  return __builtin_add_overflow(left, right, &result) ? saturated : result;
}

// The number that `text` is. Nothing unless all of `text` is a number that Number holds: no blanks,
// no sign +, no rest.
template <typename Number>
std::optional<Number> parse_number(std::string_view text) {
  Number value{};
  const char* const end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc() || rest != end) return std::nullopt;
  return value;
}

}  // namespace maide
