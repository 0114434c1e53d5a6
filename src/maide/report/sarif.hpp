// SARIF, the format in which editors and pages of code reviews read what a tool found in sources
// (OASIS, Static Analysis Results Interchange Format 2.1.0, 2020).
#pragma once

#include <span>
#include <string>

#include "maide/base/error.hpp"
#include "maide/base/json.hpp"
#include "maide/check/system/system.hpp"
#include "maide/check/verdict/check_system.hpp"

namespace maide {

// What is said of a place beside the results: a hole of what was read from sources.
struct SarifNote {
  std::string text;
  SourcePosition place;
};

// One run with a rule a property. A violated property is an error where its run ends, with the
// sentence that explains it and its steps as a flow; an inconclusive one is a warning with the
// reason, and so is each note. `file`: what was checked, a system file or the first of its sources;
// steps that stand in neither have no place. O(steps of the runs x programs).
Json make_sarif(const System& system, const CheckReport& report, const std::string& file,
                std::span<const SarifNote> notes);

}  // namespace maide
