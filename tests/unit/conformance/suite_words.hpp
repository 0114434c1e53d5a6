// What a test suite makes, as a list.
#pragma once

#include <vector>

#include "maide/conformance/suite/test_suite.hpp"

namespace maide::test {

// Its words, at most so many of them.
inline std::vector<Word> list(TestSuite& suite, std::size_t limit = 1'000'000) {
  std::vector<Word> words;
  Word word;
  while (words.size() < limit && suite.next(word)) words.push_back(word);
  return words;
}

}  // namespace maide::test
