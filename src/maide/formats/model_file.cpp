#include "maide/formats/model_file.hpp"

#include "maide/base/file.hpp"
#include "maide/formats/aut.hpp"
#include "maide/formats/dot.hpp"

namespace maide {

Model read_model(const std::filesystem::path& path) {
  const std::string extension = path.extension().string();
  if (extension == ".dot" || extension == ".gv") {
    return read_dot(read_file(path), path.string());
  }
  if (extension == ".aut") return read_aut(read_file(path), path.string());
  throw UsageError("a model's file ends in .dot, .gv or .aut (" + path.string() + ")");
}

Mealy read_mealy(const std::filesystem::path& path) {
  Model model = read_model(path);
  if (auto* machine = std::get_if<Mealy>(&model)) return std::move(*machine);
  if (std::holds_alternative<NondeterministicMealy>(model)) {
    throw UsageError("a nondeterministic Mealy machine where a deterministic one is needed (" +
                     path.string() + ")");
  }
  throw UsageError("an interface automaton where a Mealy machine is needed (" + path.string() +
                   ")");
}

InterfaceAutomaton read_interface_automaton(const std::filesystem::path& path) {
  Model model = read_model(path);
  if (auto* automaton = std::get_if<InterfaceAutomaton>(&model)) return std::move(*automaton);
  throw UsageError("a Mealy machine where an interface automaton is needed (" + path.string() +
                   ")");
}

}  // namespace maide
