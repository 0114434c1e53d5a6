// Numbers of things that may be more than 64 bits can count: then they are 2^64 - 1.
#pragma once

#include <cstdint>
#include <limits>

namespace maide {

inline constexpr std::uint64_t saturated = std::numeric_limits<std::uint64_t>::max();

inline std::uint64_t saturating_product(std::uint64_t left, std::uint64_t right) {
  std::uint64_t result;
  return __builtin_mul_overflow(left, right, &result) ? saturated : result;
}

inline std::uint64_t saturating_sum(std::uint64_t left, std::uint64_t right) {
  std::uint64_t result;
  return __builtin_add_overflow(left, right, &result) ? saturated : result;
}

}  // namespace maide
