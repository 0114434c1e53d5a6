#include "maide/automata/partition.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <memory>
#include <set>
#include <utility>
#include <vector>

#include "random_calls.hpp"

namespace maide {
namespace {

using test::promise;

// A partition beside sets of elements, which are split as the header says.
class SplitBlocks {
 public:
  explicit SplitBlocks(std::uint64_t seed) : elements_(seed % 40), partition_(elements_) {
    if (elements_ == 0) return;
    sets_.emplace_back();
    for (std::uint32_t element = 0; element < elements_; ++element) sets_[0].insert(element);
  }

  void call(const test::Call& call) {
    if (elements_ == 0) return;
    const auto block = call.value % partition_.blocks();
    switch (call.kind) {
      case 0: split(block); break;
      case 1: split_by(block, 1 + call.value / 64); break;
      default: mark(static_cast<std::uint32_t>(call.value % elements_));
    }
    compare();
  }

  void finish() {
    for (std::uint32_t block = 0; block < partition_.blocks(); ++block) split(block);
    compare();
  }

 private:
  std::uint32_t naive_block_of(std::uint32_t element) const {
    const auto has = [&](const auto& set) { return set.contains(element); };
    return static_cast<std::uint32_t>(std::find_if(sets_.begin(), sets_.end(), has) -
                                      sets_.begin());
  }

  void mark(std::uint32_t element) {
    auto& marked = marked_[naive_block_of(element)];
    const bool is_first = marked.empty();
    marked.insert(element);
    promise(partition_.mark(element) == (is_first && marked.size() == 1), "says what is first");
  }

  void split(std::uint32_t block) {
    const std::set<std::uint32_t> marked = std::exchange(marked_[block], {});
    const bool splits = !marked.empty() && marked.size() < sets_[block].size();
    const auto expected = static_cast<std::uint32_t>(splits ? sets_.size() : block);
    promise(partition_.split(block) == expected, "says which block is new");
    if (!splits) return;
    for (const std::uint32_t element : marked) sets_[block].erase(element);
    sets_.push_back(marked);
  }

  // By the element modulo a number, the greatest remainder first.
  void split_by(std::uint32_t block, std::uint32_t modulus) {
    split(block);  // takes its marks away
    const auto key = [&](std::uint32_t element) {
      return -static_cast<int>(element / 2 % modulus);
    };
    std::map<int, std::set<std::uint32_t>> parts;
    for (const std::uint32_t element : sets_[block]) parts[key(element)].insert(element);
    const std::size_t expected = sets_.size();
    sets_[block] = parts.begin()->second;
    for (auto part = std::next(parts.begin()); part != parts.end(); ++part) {
      sets_.push_back(part->second);
    }
    const std::size_t first_new = partition_.split_by(block, key);
    promise(first_new == expected, "says which block is the first new one");
    for (std::size_t fresh = first_new; fresh < partition_.blocks(); ++fresh) {
      const auto elements = partition_.elements(static_cast<std::uint32_t>(fresh));
      promise(std::is_sorted(elements.begin(), elements.end()), "elements ascend in each part");
    }
  }

  void compare() const {
    partition_.check_invariants();
    promise(partition_.blocks() == sets_.size(), "has as many blocks");
    for (std::uint32_t block = 0; block < partition_.blocks(); ++block) {
      const auto elements = partition_.elements(block);
      promise(partition_.size(block) == elements.size(), "knows the sizes");
      promise(std::set(elements.begin(), elements.end()) == sets_[block], "has the same blocks");
      for (const std::uint32_t element : elements) {
        promise(partition_.block_of(element) == block, "knows each element's block");
      }
    }
  }

  std::size_t elements_;
  Partition partition_;
  std::vector<std::set<std::uint32_t>> sets_;                // by block
  std::map<std::uint32_t, std::set<std::uint32_t>> marked_;  // by block
};

TEST(Partition, SplitsLikeSets) {
  const auto play = [](const test::Scenario& scenario) {
    return test::play_calls(scenario,
                            [](std::uint64_t seed) { return std::make_unique<SplitBlocks>(seed); });
  };
  // Of ten calls, eight mark.
  test::expect_no_failure({.seed = 1, .scenarios = 1000, .calls = 60, .kinds = 10, .values = 512},
                          play);
}

TEST(Partition, OfNothingHasNoBlocks) {
  const Partition partition(0);
  EXPECT_EQ(partition.blocks(), 0U);
  partition.check_invariants();
}

TEST(Partition, IsRefinedUntilSignaturesAgree) {
  // A line 0 <- 1 <- ... <- 9: each step tells one more from the rest.
  Partition partition(10);
  std::size_t rounds = 0;
  refine_by_signatures(partition, [&](std::uint32_t element) {
    if (element == 9) ++rounds;
    return std::pair(element == 0, partition.block_of(element == 0 ? 0 : element - 1));
  });
  EXPECT_EQ(partition.blocks(), 10U);
  EXPECT_GT(rounds, 1U);
  // Two rings: nothing tells their elements apart but the ring.
  Partition rings(9);
  refine_by_signatures(rings, [&](std::uint32_t element) {
    const std::uint32_t next = element < 4 ? (element + 1) % 4 : 4 + (element - 3) % 5;
    return std::pair(element < 4, rings.block_of(next));
  });
  EXPECT_EQ(rings.blocks(), 2U);
}

}  // namespace
}  // namespace maide
