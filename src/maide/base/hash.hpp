// FNV-1a with 64 bits (G. Fowler, L. C. Noll, K.-P. Vo; RFC draft "The FNV Non-Cryptographic Hash
// Algorithm"): the same on every machine, for hash tables and to notice that a text has changed. No
// protection against somebody who looks for a collision.
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

// Of the text's bytes. O(length).
constexpr std::uint64_t hash_text(std::string_view text) {
  std::uint64_t hash = hash_start;
  for (const char byte : text) hash = hash_step(hash, static_cast<unsigned char>(byte));
  return hash;
}

}  // namespace maide
