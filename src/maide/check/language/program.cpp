#include "maide/check/language/program.hpp"

#include <algorithm>

#include "maide/check/language/program_syntax.hpp"
#include "maide/check/language/shared_steps.hpp"

namespace maide {

std::string Program::place_of(int line) const {
  std::string text = "line " + std::to_string(line);
  const auto is_in = [&](const CallbackLines& of) { return of.first <= line && line <= of.last; };
  if (std::count_if(callbacks.begin(), callbacks.end(), is_in) != 1) return text;
  return text + " (" + std::find_if(callbacks.begin(), callbacks.end(), is_in)->name + ")";
}

bool Program::has_label(ControlState state, std::uint32_t label) const {
  const auto& set = label_sets[states[state].label_set];
  return std::binary_search(set.begin(), set.end(), label);
}

bool Program::may_end() const {
  for (ControlState state = 0; state < states.size(); ++state) {
    if (is_end(state)) return true;
  }
  return false;
}

bool Program::may_reach(std::uint32_t label) const {
  return std::any_of(label_sets.begin(), label_sets.end(), [&](const auto& set) {
    return std::binary_search(set.begin(), set.end(), label);
  });
}

Program parse_program(const std::string& name, const ScalarText& text, System& system) {
  Names names;
  for (std::uint32_t index = 0; index < system.models.size(); ++index) {
    names.models.emplace(system.models[index].name, ModelName{index, {}, false, {}});
  }
  const auto number = static_cast<std::uint32_t>(system.programs.size());
  const program_syntax::Tree tree = program_syntax::parse(
      text, {system.models, names, system.words, number, {}, {}, nullptr, nullptr, {}});
  SharedActions actions(system);
  return program_syntax::make_program(tree, {name, number, {}, false}, text, actions, names);
}

namespace program_syntax {

Program make_program(const Tree& tree, Unrolled program, const ScalarText& text,
                     SharedActions& actions, const Names& names) {
  program.position = text.position(0);
  Program made = unroll(tree, program, actions, names);
  made.unreachable = find_unreachable(tree, made.position.file);
  made.last_line = text.position(text.value().find_last_not_of(" \t\r\n")).line;
  return made;
}

}  // namespace program_syntax
}  // namespace maide
