// Random numbers that are the same everywhere. (The standard library's distributions differ between
// implementations, so a seed would not mean the same run.) The generator is xoshiro256** 1.0,
// seeded by splitmix64 (Blackman & Vigna, "Scrambled linear pseudorandom number generators", ACM
// TOMS 2021). Bounded integers are drawn by rejection, so they carry no bias.
#pragma once

#include <cstddef>
#include <cstdint>
#include <iterator>
#include <limits>
#include <utility>

namespace maide {

class Random {
 public:
  using result_type = std::uint64_t;  // a UniformRandomBitGenerator

  explicit Random(std::uint64_t seed) {
    for (std::uint64_t& word : state_) word = next_splitmix(seed);
  }

  static constexpr result_type min() { return 0; }
  static constexpr result_type max() { return std::numeric_limits<result_type>::max(); }

  // The next 64 random bits.
  result_type operator()() {
    const std::uint64_t result = rotate_left(state_[1] * 5, 7) * 9;
    const std::uint64_t shifted = state_[1] << 17;
    state_[2] ^= state_[0];
    state_[3] ^= state_[1];
    state_[1] ^= state_[2];
    state_[0] ^= state_[3];
    state_[2] ^= shifted;
    state_[3] = rotate_left(state_[3], 45);
    return result;
  }

  // Uniform in [0, bound). `bound` must not be 0.
  std::uint64_t below(std::uint64_t bound) {
    const std::uint64_t rejected = (std::uint64_t{0} - bound) % bound;  // 2^64 mod bound
    while (true) {
      const std::uint64_t bits = (*this)();
      if (bits >= rejected) return bits % bound;
    }
  }

  // Uniform in [low, high], both included; low <= high.
  std::uint64_t between(std::uint64_t low, std::uint64_t high) {
    return high - low == max() ? (*this)() : low + below(high - low + 1);
  }

  // Uniform in [0, 1), a multiple of 2^-53.
  double unit() { return static_cast<double>((*this)() >> 11) * 0x1.0p-53; }

  // True with this probability.
  bool chance(double probability) { return unit() < probability; }

  // A generator for a sub-task, independent of how many numbers are drawn here later.
  Random split() { return Random((*this)()); }

  // Fisher-Yates, the same for the same seed everywhere.
  template <typename Range>
  void shuffle(Range& range) {
    using std::swap;
    for (std::size_t i = std::size(range); i > 1; --i) swap(range[i - 1], range[below(i)]);
  }

 private:
  static std::uint64_t rotate_left(std::uint64_t bits, int by) {
    return (bits << by) | (bits >> (64 - by));
  }
  static std::uint64_t next_splitmix(std::uint64_t& state) {
    std::uint64_t bits = (state += 0x9e3779b97f4a7c15);
    bits = (bits ^ (bits >> 30)) * 0xbf58476d1ce4e5b9;
    bits = (bits ^ (bits >> 27)) * 0x94d049bb133111eb;
    return bits ^ (bits >> 31);
  }

  std::uint64_t state_[4];
};

}  // namespace maide
