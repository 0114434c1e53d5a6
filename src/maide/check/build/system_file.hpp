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
// What a file names but does not contain - model files, models to be learned - is asked of a
// ModelSource, so that checking knows nothing of learning.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "maide/base/run_control.hpp"
#include "maide/check/system/system.hpp"

namespace maide {

// What the system file says about where a model comes from: a file, or a system to be learned.
struct ModelRequest {
  std::string instance;
  std::filesystem::path file;                             // relative to the system file's folder
  std::string learn;                                      // the system; empty: `file` is meant
  std::vector<std::pair<std::string, std::string>> with;  // its options, in order
  // How it is learned, where that is not left to the defaults: names and values of options of
  // `maide learn`, in order.
  std::vector<std::pair<std::string, std::string>> learning;
  // What programs write, "3" or "3,go", where the model is to carry these values: with `write(3)`
  // in place of `write`. Empty: the model as it is learned.
  std::vector<std::string> values;
  SourcePosition position;  // of `file:` or `learn:`
};

using ModelSource = std::function<InterfaceAutomaton(const ModelRequest&)>;

// Reads model files; a model to be learned is a ParseError that says to learn it first.
InterfaceAutomaton read_requested_model(const ModelRequest& request);

// Parses the text of a system file; `file` is for messages and the folder of its models. Throws
// ParseError (file:line:column) for everything that is not as it should be, unknown keys included.
// The search for the states of large queues (queue_growth.hpp) gives up when the control's time is
// up; its stop token interrupts it (throws Interrupted).
System parse_system(std::string_view text, const std::string& file,
                    const ModelSource& source = read_requested_model,
                    const RunControl& control = {});

// Reads and parses. Throws UsageError if the file cannot be read. A pipe is waited for until
// `control` says stop (throws Interrupted).
System read_system(const std::filesystem::path& path,
                   const ModelSource& source = read_requested_model,
                   const RunControl& control = {});

}  // namespace maide
