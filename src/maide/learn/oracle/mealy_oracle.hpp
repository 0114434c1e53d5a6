// A known Mealy machine as an output oracle, without translator, wrapper or wire. For benchmarks,
// tests, and learning from models.
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "maide/automata/mealy.hpp"
#include "maide/learn/oracle/output_oracle.hpp"

namespace maide {

class MealyOracle : public OutputOracle {
 public:
  // Keeps a reference to `machine`, which must be complete.
  explicit MealyOracle(const Mealy& machine) : machine_(machine), outputs_(machine.outputs()) {}

  using OutputOracle::ask;
  const Alphabet& inputs() const override { return machine_.inputs(); }
  const Alphabet& outputs() const override { return outputs_; }
  Symbol intern_output(std::string_view name) override { return outputs_.intern(name); }
  // Looks at the stop token once in 1024 words.
  std::vector<MealyAnswer> ask(std::span<const Query> batch, const RunControl& control = {},
                               const PartialSink& on_early_end = {}) override;

 private:
  const Mealy& machine_;
  Alphabet outputs_;
};

}  // namespace maide
