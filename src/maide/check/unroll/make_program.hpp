// From a program's syntax tree to its automaton (unroller.hpp), with what is known from its text.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "maide/base/run_control.hpp"
#include "maide/check/language/program.hpp"
#include "maide/check/language/program_tree.hpp"
#include "maide/check/language/system_names.hpp"
#include "maide/check/system/model_actions.hpp"
#include "maide/check/system/system.hpp"

namespace maide {

namespace program_syntax {

// What a program's automaton has besides its tree.
struct Unrolled {
  std::string name;
  std::uint32_t number = 0;  // of the program
  SourcePosition position;
  bool may_die = false;
  std::vector<std::string> nodes{};  // whose callbacks it runs
};

// Unrolls the tree into an automaton. A program that may die has a death in every state. Throws
// ParseError, and Interrupted when the control says stop.
Program unroll(const Tree& tree, const Unrolled& program, ModelActions& actions, const Names& names,
               const RunControl& control = {});
// As unroll() does, with what is known from the program's text.
Program make_program(const Tree& tree, const Unrolled& program, int last_line,
                     ModelActions& actions, const Names& names, const RunControl& control = {});

}  // namespace program_syntax
}  // namespace maide
