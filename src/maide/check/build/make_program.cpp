#include "maide/check/build/make_program.hpp"

#include <cstdint>
#include <utility>

#include "maide/check/build/code_resolver.hpp"
#include "maide/check/build/unroller.hpp"
#include "maide/check/language/code_parser.hpp"
#include "maide/check/language/unreachable.hpp"

namespace maide {

Program parse_program(const std::string& name, const ScalarText& text, System& system) {
  Names names;
  for (std::uint32_t index = 0; index < system.models.size(); ++index) {
    names.models.emplace(system.models[index].name, ModelName{index, {}, false, {}});
  }
  const auto number = static_cast<std::uint32_t>(system.programs.size());
  const syntax::Code code = syntax::parse_program(text);
  const program_syntax::Tree tree = program_syntax::resolve_program(
      code, {system.models, names, system.words, number, {}, {}, nullptr, nullptr, {}});
  ModelActions actions(system);
  return program_syntax::make_program(tree, {name, number, text.position(0), false}, code.last.line,
                                      actions, names);
}

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
