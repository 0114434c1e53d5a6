#include "maide/conformance/suite/test_suite.hpp"

namespace maide {

bool AlternatingSuite::next(Word& word) {
  const auto is_left = [&](std::size_t part) { return made_[part] < parts_[part].max_tests; };
  const bool is_ahead = made_[0] > head_start_ + made_[1];
  const std::size_t turn = (is_ahead && is_left(1)) || !is_left(0) ? 1 : 0;
  if (!is_left(turn)) return false;
  ++made_[turn];
  return parts_[turn].suite.next(word);
}

}  // namespace maide
