// The system file: model instances, programs and properties in one YAML file.
//
//   models:
//     via:  {file: strict-6.dot, when_unexplored: wait, when_weak: accept}
//     sync: {learn: cyclonedds, with: {history: keep_last, depth: 1}}
//   programs:
//     planner: |
//       loop { repeat 6 { via.write; } @sent sync.read -> message; }
//   properties:
//     acknowledged: "G (planner@sent -> F controller@done)"
//     nothing_lost: {ltl: "G !via!gap", fairness: none}
//     no_gap: {always: "!via!gap"}
//     ordered: {never: bad-order.hoa}
//
// The way from text to system: read_tree() checks keys and parses all texts, declare() resolves the
// file's own names, find_models() asks for models, build_system() unrolls programs. A slip in the
// file is told before anybody is asked for a model. What a stage hands on can be written out, and
// stand where a file may stand (stage_dump.hpp).
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "maide/base/run_control.hpp"
#include "maide/check/build/model_source.hpp"
#include "maide/check/system/system.hpp"

namespace maide {

// Parses the text of a system file; `file` is for messages and the folder of its models. Throws
// ParseError (file:line:column) for everything that is not as it should be, unknown keys included.
// The search for the states of large queues (queue_growth.hpp) gives up when the control's time is
// up; its stop token interrupts it (throws Interrupted). `settings` are other values of constants
// (constant_settings.hpp); a dump has its own, and UsageError is thrown where these are others.
System parse_system(std::string_view text, const std::string& file,
                    const ModelSource& source = read_requested_model,
                    const RunControl& control = {},
                    const std::vector<ConstantSetting>& settings = {},
                    Deliveries deliveries = Deliveries::as_said);

// Reads and parses. Throws UsageError if the file cannot be read. A pipe is waited for until
// `control` says stop (throws Interrupted).
System read_system(const std::filesystem::path& path,
                   const ModelSource& source = read_requested_model, const RunControl& control = {},
                   const std::vector<ConstantSetting>& settings = {},
                   Deliveries deliveries = Deliveries::as_said);

}  // namespace maide
