// Hashes, the same on every machine. None protects against somebody who looks for a collision.
//
// hash_step and hash_text are FNV-1a with 64 bits (G. Fowler, L. C. Noll, K.-P. Vo; RFC draft "The
// FNV Non-Cryptographic Hash Algorithm"), to notice that a text has changed; files keep its values.
// hash_mix is for tables in memory.
#pragma once

#include <cstdint>
#include <string_view>

namespace maide {

// The hash of nothing; hash_step goes on from there.
inline constexpr std::uint64_t hash_start = 14695981039346656037ULL;

// The hash of what `hash` stands for, and then `value`. FNV proper takes one byte at a time.
constexpr std::uint64_t hash_step(std::uint64_t hash, std::uint64_t value) {
  return (hash ^ value) * 1099511628211ULL;
}

// Extends `hash` by `value`. The result is good for tables that take a place from some of its low
// bits: the product moves bits up, and the shift moves the upper half down. In a table of 2^b
// places, the only bits without influence on the place are those of the last value from 32 + b on.
constexpr std::uint64_t hash_mix(std::uint64_t hash, std::uint64_t value) {
  hash = (hash ^ value) * 0xd6e8feb86659fd93ULL;
  return hash ^ (hash >> 32);
}

// The hash of the text's bytes. O(length).
constexpr std::uint64_t hash_text(std::string_view text) {
  std::uint64_t hash = hash_start;
  for (const char byte : text) hash = hash_step(hash, static_cast<unsigned char>(byte));
  return hash;
}

}  // namespace maide
