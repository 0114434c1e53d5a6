// The base of oracles that stand between another and whoever asks it, and speak the same symbols
// (LearnLib's idea: statistics and limits are decorators). A decorator says what it does with a
// batch.
#pragma once

#include <string_view>

#include "maide/learn/output_oracle.hpp"

namespace maide {

class OracleDecorator : public OutputOracle {
 public:
  using OutputOracle::ask;
  const Alphabet& inputs() const override { return system_.inputs(); }
  const Alphabet& outputs() const override { return system_.outputs(); }
  Symbol intern_output(std::string_view name) override { return system_.intern_output(name); }

 protected:
  // Keeps a reference to `system`.
  explicit OracleDecorator(OutputOracle& system) : system_(system) {}

  OutputOracle& system_;
};

}  // namespace maide
