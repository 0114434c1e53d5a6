// Where a simulation stands, in words: what can come next, who waits for what, what models hold.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "maide/check/system/simulation.hpp"

namespace maide {

// A line for each step that can come next, with its number from 1, who would take it, where it
// stands, and the text there if it fits into that many columns.
std::string describe_choices(const Simulation& simulation, std::size_t width);

// "step 7: planner via.write (line 9)": the last that was taken.
std::string describe_last_step(const Simulation& simulation);

// Of each program whether it can go on, or what it waits for and who could change that, and the
// values of its variables; of each model what it holds.
std::string describe_situation(const Simulation& simulation);

// Why nothing follows, in one sentence: "a deadlock: planner waits at line 9 ..."; "" where
// something does.
std::string explain_end(const Simulation& simulation);

// "ended", "at rest", "deadlock", "error", "cut"; "" of End::none.
std::string_view to_string(Simulation::End end);

}  // namespace maide
