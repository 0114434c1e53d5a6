// Two test suites in turn, one test of each, after a head start of the first. Nobody knows which of
// them a system needs; like this, whichever it is, it costs at most twice its tests and the head
// start.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>

#include "maide/conformance/test_suite.hpp"

namespace maide {

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

  bool next(Word& word) override;
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
