// What `maide bench` prints: an aligned table with other tools' figures beside ours, means, CSV,
// JSON. Numbers only; what is measured, and how, is workflow/learner_bench.hpp.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "maide/base/json.hpp"
#include "maide/workflow/learner_bench.hpp"

namespace maide::cli {

// The table, a piece at a time, so that it can be watched.
class BenchTable {
 public:
  // Keeps references to both.
  BenchTable(const std::vector<BenchModel>& models, const BenchOptions& options);

  std::string head() const;
  // A run's line; before the first line of a model, what other tools take for the one before.
  std::string line(const BenchRun& run);
  // What is left after the last run, and the means.
  std::string end(std::span<const BenchRun> runs);

 private:
  std::string peers();
  std::string legend() const;

  const std::vector<BenchModel>& models_;
  const BenchOptions& options_;
  bool is_perfect_;
  bool has_peers_ = false;  // other tools' figures were printed
  std::size_t name_width_ = 0;
  std::size_t model_;  // of the line before; behind the last: none
};

// A head and a line for each run.
std::string bench_csv(const std::vector<BenchModel>& models, std::span<const BenchRun> runs);

// `is_complete`: nothing was dropped.
Json bench_json(const BenchFolder& folder, const BenchOptions& options,
                std::span<const BenchRun> runs, bool is_complete);

}  // namespace maide::cli
