// The learning algorithms by name: the one place that the command line, its help and the
// benchmarks read.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "maide/learn/learner.hpp"
#include "maide/learn/output_oracle.hpp"

namespace maide {

struct LearnerEntry {
  std::string_view name;         // as in `--algorithm NAME`
  std::string_view description;  // one line, for help
  std::unique_ptr<Learner> (*make)(OutputOracle& oracle);
  // The same, starting from a model of an earlier version of the system; null: the algorithm has no
  // use for one, see make_learner() and first_words().
  std::unique_ptr<Learner> (*make_from)(OutputOracle& oracle, const Mealy& old_model,
                                        const RunControl& control,
                                        std::span<const Word> first_words) = nullptr;
  // The algorithm to take where the system answers words alone; empty: this one asks no decision
  // trees.
  std::string_view by_words = "";
};

// All of them, the default first.
std::span<const LearnerEntry> learners();

// The algorithm of this name; throws UsageError that lists the known ones.
const LearnerEntry& find_learner(std::string_view name);

// A learner of the algorithm; it starts from `old_model`, a model of an earlier version of the
// system, if that is not null and the algorithm can; then it asks `first_words` before all else
// (see LSharp).
std::unique_ptr<Learner> make_learner(const LearnerEntry& algorithm, OutputOracle& oracle,
                                      const Mealy* old_model, const RunControl& control = {},
                                      std::span<const Word> first_words = {});
// If it cannot: words to test the first hypothesis with, which show whatever states of `old_model`
// are still there in a system with these inputs. Else none.
std::vector<Word> first_words(const LearnerEntry& algorithm, const Mealy* old_model,
                              const Alphabet& inputs, const RunControl& control = {});

}  // namespace maide
