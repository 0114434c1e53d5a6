// Plays output queries on a system: through an IaTranslator (wrappers, simulated systems), or on
// any object of the program's own that can be reset and stepped:
//
//   class CoffeeMachine {
//    public:
//     maide::Alphabet inputs() const;              // what it takes
//     void reset();                                // back to the start
//     std::string step(const std::string& input);  // the output
//   };
//   CoffeeMachine machine;
//   maide::SulOracle system{machine};
#pragma once

#include <chrono>
#include <concepts>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "maide/learn/oracle/output_oracle.hpp"

namespace maide {

template <typename Machine>
concept SteppableMachine = requires(Machine& machine, const std::string& input) {
  { machine.inputs() } -> std::convertible_to<Alphabet>;
  machine.reset();
  { machine.step(input) } -> std::convertible_to<std::string>;
};

class SulOracle : public OutputOracle {
 public:
  // Keeps a reference to `translator`.
  explicit SulOracle(IaTranslator& translator) : translator_(&translator) {}

  // Keeps a reference to `machine`. What it throws passes through.
  template <SteppableMachine Machine>
  explicit SulOracle(Machine& machine)
      : machine_{
            machine.inputs(),
            {},
            [&machine] { machine.reset(); },
            [&machine](const std::string& input) -> std::string { return machine.step(input); }} {}

  using OutputOracle::ask;
  const Alphabet& inputs() const override;
  const Alphabet& outputs() const override;
  Symbol intern_output(std::string_view name) override;
  std::vector<MealyAnswer> ask(std::span<const Query> batch, const RunControl& control = {},
                               const PartialSink& on_early_end = {}) override;

 private:
  struct Machine {
    Alphabet inputs, outputs;
    std::function<void()> reset;
    std::function<std::string(const std::string&)> step;
  };
  void play_on_machine(const Query& query, MealyAnswer& answer);

  IaTranslator* translator_ = nullptr;  // null: `machine_` is played on
  Machine machine_;
};

}  // namespace maide
