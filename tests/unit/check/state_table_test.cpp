// The compact table against a plain set: it may forget nothing and invent nothing, at every size.
#include "maide/check/packed/state_table.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <map>
#include <numeric>
#include <vector>

#include "maide/base/random.hpp"

namespace maide {
namespace {

TEST(Scrambler, IsABijection) {
  Random random(1);
  for (unsigned bits = 24; bits <= 64; ++bits) {
    const Scrambler scrambler(bits);
    const std::uint64_t mask = bits == 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << bits) - 1;
    for (int i = 0; i < 1000; ++i) {
      const std::uint64_t x = random() & mask;
      ASSERT_LE(scrambler.apply(x), mask);
      ASSERT_EQ(scrambler.invert(scrambler.apply(x)), x) << bits;
    }
  }
}

struct Shape {
  unsigned address_bits, payload_bits;
  bool is_dense;  // neighbouring numbers instead of random ones
};

template <std::size_t words>
void compare_with_map(const Shape& shape, std::size_t count, std::uint64_t seed) {
  Random random(seed);
  constexpr std::size_t used_words = words > most_own_words ? words / 4 : words;
  StateTable<words> table(shape.address_bits, shape.payload_bits, used_words);
  std::map<PackedState<words>, std::uint64_t> expected;
  const auto mask = [](unsigned bits) {
    return bits == 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << bits) - 1;
  };
  for (std::size_t i = 0; i < count; ++i) {
    PackedState<words> state{};
    for (std::size_t word = 0; word < used_words; ++word) {
      state[word] = shape.is_dense ? random.below(64) : random();
    }
    state[0] = (shape.is_dense ? random.below(count) : random()) & mask(shape.address_bits);
    const std::uint64_t payload = random() & mask(shape.payload_bits);
    const auto insertion = table.insert(state, payload);
    const auto [place, is_new] = expected.emplace(state, payload);
    ASSERT_EQ(insertion.is_new, is_new);
    ASSERT_EQ(insertion.payload, place->second);
    if (std::has_single_bit(i)) table.check_invariants();
  }
  table.check_invariants();
  ASSERT_EQ(table.size(), expected.size());
  for (const auto& [state, payload] : expected) {
    std::uint64_t found = 0;
    ASSERT_TRUE(table.find(state, found));
    ASSERT_EQ(found, payload);
  }
  std::size_t visited = 0;
  table.for_each([&](const PackedState<words>& state, std::uint64_t payload) {
    ++visited;
    const auto place = expected.find(state);
    ASSERT_NE(place, expected.end());
    ASSERT_EQ(place->second, payload);
  });
  EXPECT_EQ(visited, expected.size());
  // States that are not there are not found.
  for (std::size_t i = 0; i < 1000; ++i) {
    PackedState<words> state{};
    for (std::uint64_t& word : state) word = random();
    state[0] &= mask(shape.address_bits);
    std::uint64_t found = 0;
    ASSERT_EQ(table.find(state, found), expected.contains(state));
  }
}

TEST(StateTable, IsTheSetOfWhatWasInserted) {
  std::uint64_t seed = 0;
  for (const Shape& shape : {Shape{0, 0, true}, Shape{5, 3, true}, Shape{24, 8, false},
                             Shape{36, 6, false}, Shape{36, 6, true}, Shape{44, 32, false},
                             Shape{50, 16, false}, Shape{64, 8, false}, Shape{64, 12, true}}) {
    compare_with_map<1>(shape, 60'000, ++seed);
  }
  for (const Shape& shape : {Shape{10, 4, true}, Shape{44, 32, false}, Shape{40, 9, false}}) {
    compare_with_map<2>(shape, 30'000, ++seed);
    compare_with_map<4>(shape, 15'000, ++seed);
    compare_with_map<16>(shape, 5'000, ++seed);
  }
}

// The numbers of one home differ in few bits: the worst that quotienting can meet.
TEST(StateTable, KeepsStatesThatShareAHomeApart) {
  StateTable<1> table(40, 4);
  for (std::uint64_t i = 0; i < 1'000'000; ++i) ASSERT_TRUE(table.insert({i}, i & 15).is_new);
  for (std::uint64_t i = 0; i < 1'000'000; ++i) ASSERT_FALSE(table.insert({i}, 0).is_new);
  table.check_invariants();
  EXPECT_EQ(table.size(), 1'000'000U);
  EXPECT_LT(table.bytes(), 1'000'000U * 9);
}

// More than one home can hold near it, in any order: the table grows until they fit.
TEST(StateTable, GrowsWhereNeighboursCrowd) {
  constexpr unsigned bits = 24;
  const Scrambler scrambler(bits);
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Random random(seed);
    std::vector<std::uint64_t> numbers(600);
    std::iota(numbers.begin(), numbers.end(), random.below(1 << 16));
    random.shuffle(numbers);
    StateTable<1> table(bits, 4);
    for (const std::uint64_t number : numbers) {
      ASSERT_TRUE(table.insert({scrambler.invert(number)}, number & 15).is_new);
    }
    table.check_invariants();
    for (const std::uint64_t number : numbers) {
      std::uint64_t payload = 0;
      ASSERT_TRUE(table.find({scrambler.invert(number)}, payload));
      ASSERT_EQ(payload, number & 15);
    }
  }
}

}  // namespace
}  // namespace maide
