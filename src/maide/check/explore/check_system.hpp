// Checks a system: runs an engine on each property and says what the verdicts rest on. A "holds" is
// weakened to inconclusive where it leans on what was not learned: on an input beyond the bound, on
// a call that really blocks while its return is not in the model, or on a weak model.
#pragma once

#include <string>
#include <vector>

#include "maide/base/error.hpp"
#include "maide/check/explore/engine.hpp"

namespace maide {

struct CheckRequest {
  std::vector<std::string> properties;  // names; none: `deadlock`, `stuck` and those of the file
  EngineOptions options;
};

struct CheckReport {
  Verdict verdict = Verdict::holds;  // violated before inconclusive before holds
  std::vector<std::string> assumptions;
  std::vector<PropertyResult> properties;  // in the order asked for
};

// Throws UsageError, before anything is run, for a property that is not there or that the engine
// cannot check; only `stuck` is left out silently - but for an assumption - unless it is asked for
// by name. An interruption makes what is left inconclusive, and so does an error of Maide's own
// with the one property that it struck.
CheckReport check_system(const System& system, Engine& engine, const CheckRequest& request = {});

// Of the command that made the report: a violation comes before an error of Maide's own.
ExitStatus exit_status_of(const CheckReport& report);

// The property of that name, the built-in ones included; throws UsageError for others.
Property find_property(const System& system, const std::string& name);

// "via was learned for at most 6 messages in flight".
std::string describe_bound(const ModelInstance& model);

// "via.write -> written", in the system file's words.
std::string describe_edge(const System& system, const ProgramEdge& edge);

}  // namespace maide
