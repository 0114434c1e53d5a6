#include "maide/check/unroll/make_program.hpp"

#include <cstdint>
#include <utility>

#include "maide/check/language/unreachable.hpp"
#include "maide/check/unroll/unroller.hpp"

namespace maide {

namespace program_syntax {

Program unroll(const Tree& tree, const Unrolled& program, ModelActions& actions, const Names& names,
               const RunControl& control) {
  return Unroller(tree, program, actions, names, control).run();
}

Program make_program(const Tree& tree, const Unrolled& program, int last_line,
                     ModelActions& actions, const Names& names, const RunControl& control) {
  Program made = unroll(tree, program, actions, names, control);
  made.unreachable = find_unreachable(tree, made.position.file);
  made.last_line = last_line;
  return made;
}

}  // namespace program_syntax
}  // namespace maide
