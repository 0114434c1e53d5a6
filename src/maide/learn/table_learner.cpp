#include "maide/learn/table_learner.hpp"

#include <stdexcept>

#include "maide/base/error.hpp"
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
    hypothesis_ = table_.make_hypothesis();
    length = first_mismatch(hypothesis(), counterexample, outputs);
  }
}

std::uint64_t TableLearner::output_queries() const {
  return table_.output_queries() + counterexample_queries_;
}

}  // namespace maide
