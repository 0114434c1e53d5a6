#include "maide/learn/suffix_one_by_one.hpp"

#include "maide/automata/words.hpp"

namespace maide {

// Adds them itself; nothing is left to add when it returns.
std::vector<Word> SuffixOneByOne::suffixes_of(const Word& counterexample, Symbol /*last_output*/,
                                              const RunControl& control) {
  table_.close(control);  // what an interruption left
  for (std::size_t start = counterexample.size(); start-- > 0;) {
    const Word suffix = tail(counterexample, start);
    if (!table_.add_suffix(suffix)) continue;
    table_.close(control);
    if (table_.state_count() != hypothesis().size()) break;
  }
  return {};
}

}  // namespace maide
