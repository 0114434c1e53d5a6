// Mealy machines out of model files of either kind, for what works on machines: learners that are
// measured on known ones, and runs that start from the model of an earlier version.
#pragma once

#include <filesystem>

#include "maide/automata/alphabet.hpp"
#include "maide/automata/mealy.hpp"
#include "maide/sul/sul.hpp"

namespace maide {

// The machine in the file; of an interface automaton the one of `translation`. Throws what
// read_model() throws, and UsageError, with the file's name, where no machine stands for it.
Mealy read_machine(const std::filesystem::path& path, Translation translation);

// The same as ExperimentOptions::old_model of a system with these inputs. Throws UsageError, too,
// if the machine has none of them: then the file is hardly of the same system.
Mealy read_old_machine(const std::filesystem::path& path, Translation translation,
                       const Alphabet& inputs);

// Whether the machine has one of these inputs: nothing else of it is of use for such a system.
bool shares_inputs(const Mealy& machine, const Alphabet& inputs);

// The inputs of a system, in their order.
Alphabet input_alphabet(const SulInfo& system);

}  // namespace maide
