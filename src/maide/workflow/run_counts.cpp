#include "maide/workflow/run_counts.hpp"

#include <algorithm>

namespace maide {
namespace {

double to_seconds(std::chrono::microseconds duration) {
  return std::chrono::duration<double>(duration).count();
}

}  // namespace

void CountedProgress::on_progress(const Progress& progress) {
  last_ = progress;
  repeat();
}

void CountedProgress::set_hypothesis(std::size_t states) {
  last_ = {};
  last_.states = states;
}

void CountedProgress::repeat() {
  if (observer_ == nullptr) return;
  if (last_.total == 0) last_.phase = to_string(counter_.phase());
  const QueryCounts counts = counter_.statistics().total();
  last_.words = counts.queries;
  last_.symbols = counts.symbols;
  observer_->on_progress(last_);
}

void fill_counts(ExperimentResult& result, const Statistics& statistics,
                 std::chrono::steady_clock::time_point start) {
  const QueryCounts total = statistics.total();
  result.experiments = total.queries;
  result.symbols = total.symbols;
  result.resets = total.resets;
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  result.seconds_in_system = to_seconds(total.in_system);
  result.seconds_in_reset = to_seconds(total.in_reset);
  result.seconds_in_reset_wait = to_seconds(total.in_reset_wait);
  result.seconds_in_settling = to_seconds(total.in_settling);
  result.seconds_in_learner = std::max(0.0, result.seconds - to_seconds(total.asking));
  result.statistics = statistics;
}

}  // namespace maide
