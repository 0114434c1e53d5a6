#include "maide/learn/lm_plus.hpp"

namespace maide {

std::vector<Word> LmPlus::suffixes_of(const Word& counterexample, Symbol /*last_output*/,
                                      const RunControl& /*control*/) {
  std::vector<Word> suffixes;
  const std::size_t row = table_.longest_row_prefix(counterexample);
  for (std::size_t start = counterexample.size(); start > row; --start) {
    suffixes.emplace_back(counterexample.begin() + static_cast<std::ptrdiff_t>(start) - 1,
                          counterexample.end());
  }
  return suffixes;
}

}  // namespace maide
