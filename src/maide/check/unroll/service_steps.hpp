// What a program does with services, as operations on their models: at a server's end, at a
// client's, and as a callback starts.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>

#include "maide/check/language/program_tree.hpp"
#include "maide/check/rules/service_model.hpp"
#include "maide/check/system/model_actions.hpp"

namespace maide::program_syntax {

class ServiceSteps {
 public:
  using Operation = ServiceModel::Operation;

  // `number`: of the program. Keeps references.
  ServiceSteps(std::uint32_t number, ModelActions& actions, const Names& names)
      : number_(number), actions_(actions), names_(names) {}

  // What the input or output is to the service, at this program's or callback's end.
  Operation operation_of(const Service& service, const std::string& name, bool is_input,
                         const Callback* callback) const;
  // What may be due when that input was given.
  static Operation due_behind(const Operation& given);
  // The number of this program among those whose answers are waited for.
  std::uint32_t caller_of(const Service& service) const;
  Uses events_of(std::uint32_t model, const std::string& input, const std::string& output) const;
  // The arm's use of the service, with the output that it takes, and what may be due before it is
  // given.
  struct Arm {
    Operation use;
    std::optional<std::string> output;
    std::optional<Operation> due;
  };
  // Throws ParseError: the arm's outputs never follow at once.
  Arm arm(const SelectArm& arm, std::uint32_t model, const SourcePosition& position) const;
  // A time-out beside that arm of a program's makes its requests overdue, if it receives answers.
  std::optional<ModelUse> time_out_of(const SelectArm& arm, std::uint32_t model) const;
  // How a callback can start that takes nothing from a model of the file; and its events.
  std::pair<Uses, Uses> start_of(const Callback& callback) const;
  // A client's callback is passed over for answers to others, which are thrown away.
  ModelUse discard_of(const Callback& callback) const;

 private:
  std::uint32_t number_ = 0;
  ModelActions& actions_;
  const Names& names_;
};

}  // namespace maide::program_syntax
