// Traces as text: what `maide check --trace` writes and other commands read. A step is named by
// what a person sees of it - the actor, its line in the system file, the model and what happens
// there - so a trace says by itself whether it belongs to a system: each of its steps must be
// possible where it is taken.
//
//   {"version": 2, "system": "...", "property": "deadlock", "loop_start": null,
//    "steps": [{"actor": "planner", "line": 8, "model": "via", "event": "?write"},
//              {"actor": null, "line": 3, "model": null, "event": "image arrives"}, ...]}
//
// `set`, if it is there, has the values of constants that are not the file's: {"n": "5"}. No actor
// is nobody. A step may have further members, which follow from the system and are not
// read: `values` (of variables that it changes), `origin` (its place in another file), `on_its_way`
// (behind it, by wire) and `lost` (by it). Version 1 has no `version`, and `program` for `actor`.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "maide/base/json.hpp"
#include "maide/base/run_control.hpp"
#include "maide/check/system/steps.hpp"
#include "maide/check/system/trace.hpp"

namespace maide {

// A variable that a step changed, or that came into scope, and its value afterwards.
struct ChangedValue {
  std::string name;
  Value value = 0;
  ValueKind kind = ValueKind::integer;
  std::optional<Value> before{};  // none: it was not in scope
};
// What changed among the variables of the actor, who took the step, and the shared ones.
std::vector<ChangedValue> find_changes(const System& system, const GlobalState& before,
                                       const GlobalState& after, std::uint32_t actor);

// {"program", "line", "model", "event"}; null is nobody, no line, no model.
Json step_to_json(const StepText& step);
// A list of these, as `--json` has it, each with what else a step of a file may have, but for
// `actor`.
Json trace_to_json(const System& system, const Trace& trace);
inline constexpr std::uint64_t trace_file_version = 2;
// What a file has: the trace by which `property` is violated.
Json trace_file_to_json(const System& system, const std::string& property, const Trace& trace);

struct TraceFile {
  std::string property;  // as in the file; "" if it names none
  Trace trace;
};

// The constants' values that the trace was found with: `set`. `file` is for messages. Throws
// UsageError.
std::vector<ConstantSetting> settings_of_trace(const Json& trace, const std::string& file);

// Finds the steps that the text names in the system; `file` is for messages. Where a model is
// nondeterministic a text may stand for several runs: it is one of them. Throws ParseError for what
// is no JSON, UsageError for what is no trace, or one of another system, with the number of the
// step, or with other values of constants. O(steps x models + enabled steps).
TraceFile parse_trace(std::string_view text, const std::string& file, const System& system);

// Reads and parses. Throws UsageError if the file cannot be read. A pipe is waited for until
// `control` says stop (throws Interrupted).
TraceFile read_trace(const std::string& path, const System& system, const RunControl& control = {});

}  // namespace maide
