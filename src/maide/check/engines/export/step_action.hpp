// The action of a step: what a step does, without where it is done. An exported system shows
// actions as letters. Two steps that differ in anything but the states before and after have
// different actions. So a state's steps and the transitions of an export are one to one.
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "maide/check/system/system.hpp"
#include "maide/formats/names.hpp"

namespace maide {

struct StepAction {
  std::uint32_t actor = 0;  // a program, or nobody, whose actions are of Kind::combined
  ProgramEdge::Kind kind = ProgramEdge::Kind::choice;
  std::uint32_t model = 0;  // of a step that uses one model alone
  // The input, the output, the model's own action, the number of the combined step or of nobody's
  // action; 0 and 1 for the `if *` and the `else` of a choice.
  std::uint32_t index = 0;
  bool is_beyond = false;  // an input where it was never tried
  auto operator<=>(const StepAction&) const = default;
};

StepAction action_of(const System& system, const Step& step);

// The input was never tried, and the run is cut: an export stays where it is.
bool is_cut(const System& system, const StepAction& action);

// The names of actions, no two alike: "planner via?write", "planner via!message", "planner via
// quiet", "planner if", "planner else", "planner n = 3" (where another action of the program has
// the same text: with " #4" behind it); behind an input that was never tried "beyond" (the run is
// cut there) or "dropped". Names that are no identifiers are in double quotes.
class ActionNames {
 public:
  // Keeps a reference. O(edges x log edges).
  explicit ActionNames(const System& system);
  std::string of(const StepAction& action) const;
  // " #4" of a combined step whose text another action of the actor has, too.
  std::string number_of_combined(const StepAction& action) const;

 private:
  const System& system_;
  // By actor, nobody last: how many of its actions have that text.
  std::vector<std::map<std::string, std::size_t>> texts_;
};

// Identifiers of another language for names made of several parts; the same for the same parts.
class ExportNames {
 public:
  // Keeps a reference to the system.
  ExportNames(const System& system, std::span<const std::string_view> reserved)
      : actions_(system), identifiers_(reserved) {}
  const std::string& of(std::initializer_list<std::string_view> parts);
  // The name for people, of any step (ActionNames).
  std::string of(const StepAction& action) const { return actions_.of(action); }
  // The name of a step's action: "in_via_write", "do_n_3", and with `of_program`
  // "planner_in_via_write".
  const std::string& of(const StepAction& action, const System& system, bool of_program);

 private:
  ActionNames actions_;
  std::map<std::vector<std::string>, std::string> known_;
  Identifiers identifiers_;
};

}  // namespace maide
