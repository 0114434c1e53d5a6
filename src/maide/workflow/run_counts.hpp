// What the learning runs of this layer share in keeping count of themselves.
#pragma once

#include <chrono>

#include "maide/base/run_control.hpp"
#include "maide/learn/counting_oracle.hpp"
#include "maide/workflow/experiment.hpp"

namespace maide {

// Passes on what learner and tests report, with the counts of what has reached the system; and the
// last report again whenever those have grown.
class CountedProgress : public ProgressObserver {
 public:
  // `observer` may be null. Keeps both.
  CountedProgress(ProgressObserver* observer, const CountingOracle& counter)
      : observer_(observer), counter_(counter) {}

  void on_progress(const Progress& progress) override;
  void set_hypothesis(std::size_t states);
  void repeat();

 private:
  ProgressObserver* observer_;
  const CountingOracle& counter_;
  Progress last_;
};

// Fills in the counts and times of a run that began at `start`; but not what the learner counts,
// nor the cache.
void fill_counts(ExperimentResult& result, const Statistics& statistics,
                 std::chrono::steady_clock::time_point start);

}  // namespace maide
