// Several equivalence oracles one after the other, cheap ones first: each is asked only if those
// before it found nothing.
#pragma once

#include <memory>
#include <vector>

#include "maide/learn/equivalence_oracle.hpp"

namespace maide {

class ChainOracle : public EquivalenceOracle {
 public:
  explicit ChainOracle(std::vector<std::unique_ptr<EquivalenceOracle>> links)
      : links_(std::move(links)) {}

  std::optional<Word> find_counterexample(const Mealy& hypothesis,
                                          const RunControl& control = {}) override;
  // Those of all links, joined by "; ".
  std::string guarantee() const override;
  // In each dimension the most that a link reached.
  Strength strength() const override;
  // That of the link that misses most.
  TestCost cost_of_missing() const override;

 private:
  std::vector<std::unique_ptr<EquivalenceOracle>> links_;
};

}  // namespace maide
