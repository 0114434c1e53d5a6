#include "test_speed.hpp"

#include "cpu_seconds.hpp"
#include "maide/conformance/method/test_runner.hpp"

namespace maide::bench {

TestSpeed measure_tests(const Mealy& model, const IdentifierMethod& method, const InfixLaw& law,
                        std::uint64_t inputs, std::uint64_t seed) {
  const double start = cpu_seconds();
  const StateIdentifiers identifiers = method.compute(model, Random(seed));
  RandomIdentifierSuite suite(model, identifiers, law, Random(seed));
  MachineRunner runner(model);
  const double ready = cpu_seconds();
  runner.run(suite, model, inputs);
  return {ready - start, cpu_seconds() - ready, runner.tests(), runner.symbols()};
}

}  // namespace maide::bench
