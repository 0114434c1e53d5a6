// Numbers of bits.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>

namespace maide {

// The lowest `count` bits, 0..64.
constexpr std::uint64_t low_bits(unsigned count) {
  return count >= 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << count) - 1;
}

// What it takes to tell `count` things apart.
constexpr unsigned bits_for(std::size_t count) {
  return count <= 1 ? 0 : static_cast<unsigned>(std::bit_width(count - 1));
}

}  // namespace maide
