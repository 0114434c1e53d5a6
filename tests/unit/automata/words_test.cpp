// Words: prefixes, joins and parts.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "maide/automata/alphabet.hpp"
#include "maide/base/random.hpp"

namespace maide {
namespace {

TEST(Words, PrefixesAndJoins) {
  EXPECT_TRUE(is_prefix(Word{}, Word{}));
  EXPECT_TRUE(is_prefix(Word{1, 2}, Word{1, 2}));
  EXPECT_TRUE(is_prefix(Word{1}, Word{1, 2}));
  EXPECT_FALSE(is_prefix(Word{1, 2}, Word{1}));
  EXPECT_FALSE(is_prefix(Word{2}, Word{1, 2}));
  EXPECT_EQ(joined({1}, {2, 3}), (Word{1, 2, 3}));
  EXPECT_EQ(joined({}, {}), Word());
}

TEST(Words, Parts) {
  const Word word{1, 2, 3};
  EXPECT_EQ(head(word, 0), Word());
  EXPECT_EQ(head(word, 2), (Word{1, 2}));
  EXPECT_EQ(tail(word, 2), (Word{3}));
  EXPECT_EQ(tail(word, 3), Word());
  EXPECT_EQ(count_common(word, Word{1, 2, 4, 3}), 2u);
  EXPECT_EQ(count_common(word, Word{1}), 1u);
  EXPECT_EQ(count_common(Word{}, word), 0u);
}

TEST(Words, WithoutPrefixesKeepsWhatNoneGoesOnFrom) {
  Random random(1);
  for (int round = 0; round < 500; ++round) {
    std::vector<Word> words(random.below(12));
    for (Word& word : words) {
      word.resize(random.below(5));
      for (Symbol& symbol : word) symbol = static_cast<Symbol>(random.below(2));
    }
    std::set<Word> expected;
    for (const Word& word : words) {
      const bool goes_on = std::any_of(words.begin(), words.end(), [&](const Word& other) {
        return other != word && is_prefix(word, other);
      });
      if (!goes_on) expected.insert(word);
    }
    EXPECT_EQ(without_prefixes(words), std::vector<Word>(expected.begin(), expected.end()));
  }
}

}  // namespace
}  // namespace maide
