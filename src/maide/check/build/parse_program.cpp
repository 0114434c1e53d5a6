#include "maide/check/build/parse_program.hpp"

#include <cstdint>

#include "maide/check/build/code_resolver.hpp"
#include "maide/check/language/code_parser.hpp"
#include "maide/check/unroll/make_program.hpp"

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

}  // namespace maide
