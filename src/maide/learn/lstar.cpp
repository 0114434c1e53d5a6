#include "maide/learn/lstar.hpp"

namespace maide {

// Rows do it, not suffixes: those that consistency needs are in the table when this returns.
std::vector<Word> LStar::suffixes_of(const Word& counterexample, Symbol /*last_output*/,
                                     const RunControl& control) {
  table_.add_short_rows(counterexample);
  table_.close(control);
  while (const std::optional<Word> suffix = table_.find_inconsistency()) {
    table_.add_suffix(*suffix);
    table_.close(control);
  }
  return {};
}

}  // namespace maide
