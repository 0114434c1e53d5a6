// How fast random tests of a machine are made and played on itself, in memory, on one core.
#pragma once

#include <cstdint>

#include "maide/automata/mealy.hpp"
#include "maide/conformance/suite/random_identifier_suite.hpp"

namespace maide::bench {

struct TestSpeed {
  double seconds_to_prepare = 0;  // of the processor: identifiers, laws of the infixes
  double seconds = 0;             // of the processor
  std::uint64_t tests = 0, inputs = 0;

  double inputs_a_second() const { return static_cast<double>(inputs) / seconds; }
};

// About `inputs` inputs.
TestSpeed measure_tests(const Mealy& model, const IdentifierMethod& method, const InfixLaw& law,
                        std::uint64_t inputs, std::uint64_t seed);

}  // namespace maide::bench
