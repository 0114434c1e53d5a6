// A conformance test suite: the words that a method wants to see run, made one at a time. Making
// tests and running them are apart, so suites can be counted, printed, cut off, and run by whoever
// has a system; `TestRunner` is who runs them here.
#pragma once

#include <cstdint>
#include <optional>

#include "maide/automata/alphabet.hpp"

namespace maide {

class TestSuite {
 public:
  virtual ~TestSuite() = default;

  // Puts the next test into `word`; false when there is none left, or never, for endless suites.
  virtual bool next(Word& word) = 0;

  // The number of tests in all, words that are prefixes of others included; nothing if endless.
  // Saturates at 2^64-1. O(1).
  virtual std::optional<std::uint64_t> size() const = 0;

  // The inputs of all tests; nothing if endless, or not known. Saturates likewise. O(1).
  virtual std::optional<std::uint64_t> symbols() const { return std::nullopt; }
};

}  // namespace maide
