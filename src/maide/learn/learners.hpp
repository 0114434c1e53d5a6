// The learning algorithms by name: the one place that the command line, its help and the
// benchmarks read.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "maide/learn/learner.hpp"
#include "maide/learn/output_oracle.hpp"

namespace maide {

struct LearnerEntry {
  std::string_view name;         // as in `--algorithm NAME`
  std::string_view description;  // one line, for help
  std::unique_ptr<Learner> (*make)(OutputOracle& oracle);
  // The same, starting from a model of an earlier version of the system; null: the algorithm has no
  // use for one, and the words of old_model.hpp are tested first instead.
  std::unique_ptr<Learner> (*make_from)(OutputOracle& oracle, const Mealy& old_model,
                                        const RunControl& control) = nullptr;
  // The algorithm to take where the system answers words alone; empty: this one asks no decision
  // trees.
  std::string_view by_words = "";
};

// All of them, the default first.
std::span<const LearnerEntry> learners();

// The algorithm of this name; throws UsageError that lists the known ones.
const LearnerEntry& find_learner(std::string_view name);

}  // namespace maide
