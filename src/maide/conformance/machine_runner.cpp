#include "maide/conformance/machine_runner.hpp"

#include <numeric>

#include "maide/base/error.hpp"

namespace maide {

std::vector<MachineRunner::Step> MachineRunner::flatten(const Mealy& machine,
                                                        const std::vector<Symbol>& outputs) {
  const auto inputs = static_cast<std::uint32_t>(machine.inputs().size());
  std::vector<Step> steps;
  steps.reserve(machine.size() * inputs);
  for (StateId state = 0; state < machine.size(); ++state) {
    for (Symbol input = 0; input < inputs; ++input) {
      steps.push_back(
          {machine.target(state, input) * inputs, outputs[machine.output(state, input)]});
    }
  }
  return steps;
}

MachineRunner::MachineRunner(const Mealy& system)
    : inputs_(system.inputs()), outputs_(system.outputs()) {
  std::vector<Symbol> same(outputs_.size());
  std::iota(same.begin(), same.end(), Symbol{0});
  system_ = flatten(system, same);
  initial_ = system.initial() * static_cast<std::uint32_t>(inputs_.size());
}

std::optional<Word> MachineRunner::run(TestSuite& suite, const Mealy& hypothesis,
                                       std::uint64_t max_symbols, const RunControl& control) {
  if (!(hypothesis.inputs() == inputs_)) {
    throw UsageError("the model has other inputs than the system");
  }
  std::vector<Symbol> outputs;  // the hypothesis' in the system's numbering; others match none
  for (const std::string& name : hypothesis.outputs().names()) {
    outputs.push_back(outputs_.find(name).value_or(~Symbol{0}));
  }
  const std::vector<Step> expected = flatten(hypothesis, outputs);
  const auto first = hypothesis.initial() * static_cast<std::uint32_t>(inputs_.size());
  Word word;
  for (std::uint64_t played = 0; played < max_symbols && suite.next(word);) {
    if (tests_++ % 4096 == 0) control.check("the equivalence test");
    std::uint32_t here = initial_, there = first;
    for (std::size_t i = 0; i < word.size(); ++i) {
      const Step real = system_[here + word[i]], guess = expected[there + word[i]];
      if (real.output != guess.output) {
        symbols_ += i + 1;
        word.resize(i + 1);
        return word;
      }
      here = real.target;
      there = guess.target;
    }
    played += word.size();
    symbols_ += word.size();
  }
  return std::nullopt;
}

}  // namespace maide
