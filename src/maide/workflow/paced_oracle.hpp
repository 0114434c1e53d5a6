// Between the cache and the system: cuts large batches into portions, so that a limit on the number
// of words is kept exactly and somebody can watch the counts grow.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>

#include "maide/learn/oracle_decorator.hpp"

namespace maide {

struct PaceOptions {
  std::size_t portion = 64;  // words given to the system at once
  std::uint64_t max_queries = std::numeric_limits<std::uint64_t>::max();
  std::function<void()> after_portion;  // called when a portion is answered
};

class PacedOracle : public OracleDecorator {
 public:
  // Keeps a reference to `system`.
  PacedOracle(OutputOracle& system, PaceOptions options)
      : OracleDecorator(system), options_(std::move(options)) {}

  using OutputOracle::ask;
  // Throws Interrupted when max_queries were answered and another is asked.
  std::vector<MealyAnswer> ask(std::span<const Query> batch, const RunControl& control = {},
                               const PartialSink& on_early_end = {}) override;

 private:
  PaceOptions options_;
  std::uint64_t answered_ = 0;
};

}  // namespace maide
