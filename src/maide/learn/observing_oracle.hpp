// An oracle that keeps what was answered in an observation tree: a learner on top of it asks
// nothing twice, and finds in the tree what tells states apart.
#pragma once

#include "maide/base/error.hpp"
#include "maide/learn/observation_tree.hpp"
#include "maide/learn/oracle_decorator.hpp"

namespace maide {

class ObservingOracle : public OracleDecorator {
 public:
  // Keeps a reference to `system`.
  explicit ObservingOracle(OutputOracle& system)
      : OracleDecorator(system), tree_(system.inputs().size()) {}

  const ObservationTree& tree() const { return tree_; }
  std::uint64_t output_queries() const { return output_queries_; }  // that reached the system

  using OutputOracle::ask;
  std::vector<MealyAnswer> ask(std::span<const Query> batch, const RunControl& control = {},
                               const PartialSink& on_early_end = {}) override;

 private:
  bool look_up(const Query& query, MealyAnswer& answer) const;
  void keep(const MealyAnswer& answer);

  ObservationTree tree_;
  std::uint64_t output_queries_ = 0;
};

// An answer contradicts what the tree holds at its symbol `place`: for insert(), which found out.
NondeterminismError contradiction(const ObservationTree& tree, const MealyAnswer& answer,
                                  std::size_t place, const OutputOracle& oracle);

}  // namespace maide
