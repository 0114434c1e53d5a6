// Oracles for tests of decorators.
#pragma once

#include <functional>
#include <vector>

#include "maide/learn/oracle/mealy_oracle.hpp"

namespace maide {

// Remembers every query that reaches it.
class RecordingOracle : public MealyOracle {
 public:
  using MealyOracle::ask;
  using MealyOracle::MealyOracle;
  std::vector<MealyAnswer> ask(std::span<const Query> batch, const RunControl& control,
                               const PartialSink& sink) override {
    asked.insert(asked.end(), batch.begin(), batch.end());
    return MealyOracle::ask(batch, control, sink);
  }
  std::vector<Query> asked;
};

// Answers as it is told.
class ScriptedOracle : public OutputOracle {
 public:
  using Script =
      std::function<std::vector<MealyAnswer>(std::span<const Query>, const PartialSink&)>;
  ScriptedOracle(Alphabet inputs, Alphabet outputs) : inputs_(inputs), outputs_(outputs) {}
  using OutputOracle::ask;
  const Alphabet& inputs() const override { return inputs_; }
  const Alphabet& outputs() const override { return outputs_; }
  Symbol intern_output(std::string_view name) override { return outputs_.intern(name); }
  std::vector<MealyAnswer> ask(std::span<const Query> batch, const RunControl&,
                               const PartialSink& sink) override {
    return script(batch, sink);
  }
  Script script;

 private:
  Alphabet inputs_, outputs_;
};

}  // namespace maide
