// Sets of programs, marks and fair groups as bits: one word of 64, or sixteen of them where there
// are more. A search for fair cycles is compiled for both, so that the usual one pays nothing for
// the other. All functions are for both kinds.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "maide/base/invariant.hpp"
#include "maide/base/numbers.hpp"

namespace maide {

class WideBits {
 public:
  static constexpr std::size_t word_count = 16;

  WideBits() = default;
  WideBits(std::uint64_t first) { words_[0] = first; }  // NOLINT(*-explicit-*): as one word is

  std::uint64_t& word(std::size_t index) { return words_[index]; }
  std::uint64_t word(std::size_t index) const { return words_[index]; }

  friend WideBits operator|(WideBits left, const WideBits& right) { return left |= right; }
  friend WideBits operator&(WideBits left, const WideBits& right) { return left &= right; }
  friend WideBits operator~(WideBits bits) {
    for (std::uint64_t& word : bits.words_) word = ~word;
    return bits;
  }
  WideBits& operator|=(const WideBits& other) {
    for (std::size_t i = 0; i < word_count; ++i) words_[i] |= other.words_[i];
    return *this;
  }
  WideBits& operator&=(const WideBits& other) {
    for (std::size_t i = 0; i < word_count; ++i) words_[i] &= other.words_[i];
    return *this;
  }
  bool operator==(const WideBits&) const = default;

 private:
  std::array<std::uint64_t, word_count> words_{};
};

// How many bits there are.
template <typename Bits>
inline constexpr std::size_t bit_count_of = 8 * sizeof(Bits);

template <typename Bits>
Bits bit_of(std::size_t index) {
  MAIDE_CHECK(index < bit_count_of<Bits>);
  return std::uint64_t{1} << index;
}
template <>
inline WideBits bit_of<WideBits>(std::size_t index) {
  MAIDE_CHECK(index < bit_count_of<WideBits>);
  WideBits bits;
  bits.word(index / 64) = std::uint64_t{1} << index % 64;
  return bits;
}

// The lowest `count` bits.
template <typename Bits>
Bits first_bits(std::size_t count) {
  return low_bits(static_cast<unsigned>(count));
}
template <>
inline WideBits first_bits<WideBits>(std::size_t count) {
  WideBits bits;
  for (std::size_t i = 0; i < WideBits::word_count && 64 * i < count; ++i) {
    bits.word(i) = low_bits(static_cast<unsigned>(std::min<std::size_t>(count - 64 * i, 64)));
  }
  return bits;
}

inline bool has_bit(std::uint64_t bits, std::size_t index) { return (bits >> index & 1) != 0; }
inline bool has_bit(const WideBits& bits, std::size_t index) {
  return has_bit(bits.word(index / 64), index % 64);
}

inline bool is_none(std::uint64_t bits) { return bits == 0; }
inline bool is_none(const WideBits& bits) { return bits == WideBits(); }

// The first 64 bits.
inline std::uint64_t lowest_word(std::uint64_t bits) { return bits; }
inline std::uint64_t lowest_word(const WideBits& bits) { return bits.word(0); }

// Each bit moved up by `places`, less than 64; those at the end are lost.
inline std::uint64_t moved_up(std::uint64_t bits, unsigned places) { return bits << places; }
inline WideBits moved_up(WideBits bits, unsigned places) {
  if (places == 0) return bits;
  for (std::size_t i = WideBits::word_count - 1; i > 0; --i) {
    bits.word(i) = bits.word(i) << places | bits.word(i - 1) >> (64 - places);
  }
  bits.word(0) <<= places;
  return bits;
}

}  // namespace maide
