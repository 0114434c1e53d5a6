#include "maide/workflow/read_machine.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <utility>

#include "maide/base/error.hpp"
#include "maide/base/join.hpp"
#include "maide/formats/model_file.hpp"
#include "maide/sul/ia_translation.hpp"

namespace maide {

Mealy read_machine(const std::filesystem::path& path, Translation translation) {
  Model model = read_model(path);
  if (auto* machine = std::get_if<Mealy>(&model)) return std::move(*machine);
  const auto* automaton = std::get_if<InterfaceAutomaton>(&model);
  if (automaton == nullptr) {
    throw UsageError("the model is nondeterministic (" + path.string() + ")");
  }
  try {
    return to_mealy(*automaton, translation);
  } catch (const UsageError& error) {
    throw UsageError(fmt::format("{} ({})", error.what(), path.string()));
  }
}

bool shares_inputs(const Mealy& machine, const Alphabet& inputs) {
  const auto is_known = [&](const std::string& name) { return inputs.find(name).has_value(); };
  return std::any_of(machine.inputs().names().begin(), machine.inputs().names().end(), is_known);
}

Alphabet input_alphabet(const SulInfo& system) {
  Alphabet inputs;
  for (const SulInput& input : system.inputs) inputs.intern(input.name);
  return inputs;
}

Mealy read_old_machine(const std::filesystem::path& path, Translation translation,
                       const Alphabet& inputs) {
  Mealy machine = read_machine(path, translation);
  if (shares_inputs(machine, inputs)) return machine;
  throw UsageError(
      fmt::format("a run cannot start from a model with none of the system's inputs, "
                  "which are {} ({})",
                  join(inputs.names()), path.string()));
}

}  // namespace maide
