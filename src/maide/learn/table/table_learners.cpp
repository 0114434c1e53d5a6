#include "maide/learn/table/table_learners.hpp"

#include <stdexcept>

#include "maide/automata/alphabet.hpp"
#include "maide/base/error.hpp"
#include "maide/base/invariant.hpp"
#include "maide/learn/counterexample.hpp"

namespace maide {

void TableLearner::start(const RunControl& control) {
  table_.close(control);
  hypothesis_ = table_.make_hypothesis();
}

void TableLearner::refine(const Word& counterexample, const RunControl& control) {
  ++counterexample_queries_;
  const Word outputs = oracle_.ask(counterexample, control);
  std::size_t length = first_mismatch(hypothesis(), counterexample, outputs);
  if (length == 0) {
    throw std::invalid_argument("the hypothesis agrees with the system on this word");
  }
  while (length != 0) {
    const Word cut(counterexample.begin(),
                   counterexample.begin() + static_cast<std::ptrdiff_t>(length));
    for (const Word& suffix : suffixes_of(cut, outputs[length - 1], control)) {
      table_.add_suffix(suffix);
    }
    table_.close(control);
    // Every counterexample shows a new state, unless the system answers now one way, now another.
    if (table_.state_count() == hypothesis().size()) {
      throw NondeterminismError(to_string(cut, oracle_.inputs()),
                                to_string(hypothesis().output_word(cut), oracle_.outputs()),
                                to_string(std::span(outputs).first(length), oracle_.outputs()));
    }
    MAIDE_CHECK(table_.state_count() > hypothesis().size());
    hypothesis_ = table_.make_hypothesis();
    length = first_mismatch(hypothesis(), counterexample, outputs);
  }
}

void TableLearner::check_invariants() const {
  table_.check_invariants();
  MAIDE_CHECK_ALWAYS(hypothesis().size() == table_.state_count());
  for (StateId state = 0; state < hypothesis().size(); ++state) {
    MAIDE_CHECK_ALWAYS(hypothesis().run(hypothesis_.access.at(state)) == state);
  }
}

std::uint64_t TableLearner::output_queries() const {
  return table_.output_queries() + counterexample_queries_;
}

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

std::vector<Word> RivestSchapire::suffixes_of(const Word& counterexample, Symbol last_output,
                                              const RunControl& control) {
  const Decomposition split =
      decompose(hypothesis(), hypothesis_.access, counterexample, last_output, oracle_, control);
  counterexample_queries_ += split.output_queries;
  MAIDE_CHECK(split.position + 1 < counterexample.size() || counterexample.size() == 1);
  return {tail(counterexample, split.position + 1)};
}

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
