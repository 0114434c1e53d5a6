// The action of a step: what a step does, without where it is done. An exported system shows
// actions as letters. Two steps that differ in anything but the states before and after have
// different actions. So a state's steps and the transitions of an export are one to one.
#pragma once

#include <compare>
#include <cstdint>
#include <initializer_list>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "maide/check/language/system.hpp"
#include "maide/formats/names.hpp"

namespace maide {

struct StepAction {
  std::uint32_t program = 0;
  ProgramEdge::Kind kind = ProgramEdge::Kind::choice;
  std::uint32_t model = 0;  // of a step that uses one model alone
  // The input, the output, the model's own action, the program's joint; of a choice: 0 for `if *`,
  // 1 for `else`.
  Symbol symbol = 0;
  bool is_beyond = false;  // an input where it was never tried
  auto operator<=>(const StepAction&) const = default;
};

StepAction action_of(const System& system, const Step& step);

// The input was never tried, and the run is cut: an export stays where it is.
bool is_cut(const System& system, const StepAction& action);

// "planner via?write", "planner via!message", "planner via quiet", "planner if", "planner else",
// "planner n = 3" (where another joint step of the program has the same text: with " #4" behind
// it); behind an input that was never tried "beyond" (the run is cut there) or "dropped". Names
// that are no identifiers are in double quotes.
std::string to_string(const StepAction& action, const System& system);

// Identifiers of another language for names made of several parts; the same for the same parts.
class ExportNames {
 public:
  explicit ExportNames(std::span<const std::string_view> reserved) : identifiers_(reserved) {}
  const std::string& of(std::initializer_list<std::string_view> parts);
  // Of a step's action: "in_via_write", "do_n_3", and with `of_program` "planner_in_via_write".
  const std::string& of(const StepAction& action, const System& system, bool of_program);

 private:
  std::map<std::vector<std::string>, std::string> known_;
  Identifiers identifiers_;
};

}  // namespace maide
