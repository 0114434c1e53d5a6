// Reads what runs start from: Mealy machines out of model files of either kind, and logs of a
// system. Learners are measured on such machines, and runs start from the model of an earlier
// version.
#pragma once

#include <filesystem>

#include "maide/automata/alphabet.hpp"
#include "maide/automata/mealy.hpp"
#include "maide/base/run_control.hpp"
#include "maide/formats/trace_log.hpp"
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

// The log of a system in a file: lines of JSON (formats/trace_log.hpp), or the cache of a learning
// run (learn/cache/cache_file.hpp), which its first bytes tell. Throws UsageError if the file
// cannot be read, ParseError for its text, Interrupted.
TraceLog read_traces(const std::filesystem::path& path, const RunControl& control = {});

}  // namespace maide
