// Models in files: the format is seen from the name's extension (.dot, .gv or .aut).
#pragma once

#include <filesystem>

#include "maide/formats/labelled_graph.hpp"

namespace maide {

// Throws UsageError if the file cannot be read or has another extension, ParseError for its text.
Model read_model(const std::filesystem::path& path);
// As above; a model of the other kind is a UsageError that names the file.
Mealy read_mealy(const std::filesystem::path& path);
InterfaceAutomaton read_interface_automaton(const std::filesystem::path& path);

}  // namespace maide
