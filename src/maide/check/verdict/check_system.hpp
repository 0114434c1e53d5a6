// Checks a system: runs an engine on each property, component by component
// (language/components.hpp), and says what the verdicts rest on. A "holds" is weakened to
// inconclusive where a run ends at an error, and where it leans on what was not learned: an input
// beyond the bound, a call that really blocks while its return is not in the model, a weak model.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "maide/base/error.hpp"
#include "maide/check/engines/engine.hpp"
#include "maide/check/verdict/races.hpp"

namespace maide {

struct CheckRequest {
  // Names; none: `deadlock`, `stuck` and those of the file. `fed` means all of `fed[0]`,
  // `fed[1]`... `error` is checked in any case, if some program can come to an error.
  std::vector<std::string> properties;
  EngineOptions options;
  bool finds_races = false;  // which connections race, too (races.hpp); only of the native engine
};

struct CheckReport {
  Verdict verdict = Verdict::holds;          // violated before inconclusive before holds
  std::vector<std::string> assumptions;      // what it rests on, one line each
  std::vector<std::string> doubts;           // those of them that say what is weak or not known
  std::map<std::string, std::string> brief;  // a short form of those that are long
  std::vector<PropertyResult> properties;    // in the order asked for
  std::vector<std::string> remarks;          // one line each: what is no violation, but looks odd
  std::optional<Races> races;                // if they were asked for, and something is late
  // What was visited of each component, in the order of its first program.
  struct Component {
    std::vector<std::uint32_t> programs;
    std::uint64_t states = 0,
                  transitions = 0;  // of the first property decided in each; 0: none was
    // Those of `deadlock`, `stuck` and `error` that were checked.
    std::map<std::string, Verdict> verdicts;
  };
  std::vector<Component> components;
};

// Throws UsageError, before anything is run, for a property that is not there or that the engine
// cannot check; only `stuck` is left out silently - but for an assumption - unless it is asked for
// by name. An interruption makes what is left inconclusive, and so does an error of Maide's own
// with the one property that it struck. Until the deadline each property, and of it each component,
// has its share of the time that is left; what ran out of its share and would get more than it had
// is checked once more. Where a violation that was found before shows another property violated,
// too, by a run that is not longer, both have that run.
CheckReport check_system(const System& system, Engine& engine, const CheckRequest& request = {});

// The remarks on the system file, then those of its check.
std::vector<std::string> all_remarks(const System& system, const CheckReport& report);

// "holds", or of whether something is possible "possible" and "not possible".
std::string describe_verdict(const PropertyResult& result);

// The exit status of the command that made the report: a violation comes before an error of Maide's
// own.
ExitStatus exit_status_of(const CheckReport& report);

// The property of that name, the built-in ones included; throws UsageError for others.
Property find_property(const System& system, const std::string& name);
// Those that the name means: itself, or the instances `name[...]`. Throws UsageError if there are
// none.
std::vector<Property> find_properties(const System& system, const std::string& name);

// Whether the run shows, in one of the system's components or in those of the formula, that the
// property does not hold: find_flaw() of the best of them.
std::string find_flaw_in_parts(const System& system, const Property& property, const Trace& trace);

// The part of the system that the result is about, with its property and its trace, as reports show
// them.
struct Shown {
  SystemPart part;
  Property property;
  Trace trace;
};
// The result has a trace. Keeps a reference to the system.
Shown shown_part(const System& system, const PropertyResult& result);

// The first of the results before this one, of the same report, that show the same run; null if
// there is none.
const PropertyResult* find_same_run(const CheckReport& report, const PropertyResult& result);

}  // namespace maide
