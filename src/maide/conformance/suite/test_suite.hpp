// Conformance test suites: words that a method wants to see run, made one at a time. To make tests
// and to run them are two things, so suites can be counted, printed, cut off, and run by whoever
// has a system. TestRunner runs them here. `AlternatingSuite` makes one suite of two.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>

#include "maide/automata/alphabet.hpp"

namespace maide {

// The words of one method, in its order.
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

// Two test suites in turn, one test of each, after a head start of the first. Whichever of them
// finds the difference, both together cost at most twice its tests and the head start.
class AlternatingSuite : public TestSuite {
 public:
  // A suite, and how many of its tests to run at most.
  struct Part {
    TestSuite& suite;
    std::uint64_t max_tests;
  };

  // `head_start` tests of the first before any of the second. Keeps references to both suites.
  AlternatingSuite(Part first, Part second, std::uint64_t head_start)
      : parts_{{first.suite, limit(first)}, {second.suite, limit(second)}},
        head_start_(std::min(head_start, parts_[0].max_tests)) {}

  bool next(Word& word) override {
    const auto is_left = [&](std::size_t part) { return made_[part] < parts_[part].max_tests; };
    const bool is_ahead = made_[0] > head_start_ + made_[1];
    const std::size_t turn = (is_ahead && is_left(1)) || !is_left(0) ? 1 : 0;
    if (!is_left(turn)) return false;
    ++made_[turn];
    return parts_[turn].suite.next(word);
  }
  std::optional<std::uint64_t> size() const override {
    return parts_[0].max_tests + parts_[1].max_tests;
  }

  // Tests made so far of the first suite, and of the second.
  std::uint64_t made_of_first() const { return made_[0]; }
  std::uint64_t made_of_second() const { return made_[1]; }

 private:
  static std::uint64_t limit(const Part& part) {
    return std::min(part.max_tests, part.suite.size().value_or(part.max_tests));
  }

  Part parts_[2];
  std::uint64_t head_start_;
  std::uint64_t made_[2] = {0, 0};
};

}  // namespace maide
