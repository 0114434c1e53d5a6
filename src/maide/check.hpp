// Checking programs that use models. A system file (docs/systems.md) names models, programs in a
// small language, and properties. check() explores everything that they can do together.
//
//   const maide::Checked checked = maide::check("examples/case-study-1/strict-6.yaml");
//   for (const maide::CheckedProperty& property : checked.properties) {
//     std::cout << property.name << ": " << to_string(property.verdict) << '\n'
//               << property.explanation << '\n';
//   }
//
// A verdict is about the models. "violated" comes with a run that shows it. "holds" is as good as
// the models, and `assumptions` says what it leans on. "inconclusive" is an answer, too: a limit
// was reached, a run leaves what was learned, or a model is weak.
//
// Errors: ParseError (file:line:column) for the system file. UsageError for a property or an engine
// that is not there. WrapperError if a model is to be learned and its system fails. Limits and
// interruptions are no errors: the properties that are left are inconclusive.
//
// Cost: time and memory grow with the reachable states, some 5 bytes each and a million a second.
// Formulas of LTL multiply the states by those of their automaton. Nothing is kept between calls
// but the learned models, which lie beside the system file.
//
// All that comes back are values: nothing refers to the file or to a system in memory. What is said
// here is what `maide check` prints, and what maide.check() of Python returns.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "maide/base/error.hpp"
#include "maide/base/run_control.hpp"
#include "maide/check/engines/verdict.hpp"
#include "maide/check/reduce/reduction_kind.hpp"

namespace maide {

struct CheckOptions {
  std::vector<std::string> properties;  // names; none: `deadlock`, `stuck` and those of the file
  std::string engine = "native";        // or "spin", "ltsmin"
  // Whether runs that differ in the order of independent steps alone are left out where the
  // property allows it: fewer states, the same verdict.
  Reduction reduction = Reduction::none;
  std::optional<std::uint64_t> memory_mib;  // none: three quarters of the machine's
  unsigned threads = 0;                     // of a search; 0: one a processor
  std::size_t jobs = 0;                     // of systems that are learned, as in LearnOptions
  // Other values for constants of the file, as in "n=5". UsageError: there is no such constant, or
  // its value is no number and neither "true" nor "false".
  std::vector<std::string> set;
  RunControl control;
};

struct CheckedProperty {
  std::string name;
  Verdict verdict = Verdict::inconclusive;
  std::string reason;  // of an inconclusive verdict, one line; else mostly empty
  // Of a property `possible`: it holds if some run comes there, and has that run.
  bool is_possibility = false;
  std::string explanation;  // of a violation, one sentence: who waits for what, and why
  std::string run;          // of a violation: its steps, a line each, with places in the file
  std::string same_run_as;  // of a violation: an earlier property that has the same run; or empty
  std::uint64_t states = 0, transitions = 0;
  double seconds = 0;
};

struct Checked {
  Verdict verdict = Verdict::holds;         // violated before inconclusive before holds
  std::vector<std::string> assumptions;     // what it rests on, one line each
  std::vector<std::string> doubts;          // those of them that say what is weak or not known
  std::vector<std::string> remarks;         // what is no violation, but looks like an oversight
  std::vector<CheckedProperty> properties;  // in the order asked for
  // What is sent later and may come first, a line each, whatever the properties say of it. Only of
  // the engine "native".
  std::vector<std::string> races;
};

// Checks the system of a file. Models that it asks to `learn:` are learned, or taken from
// maide-models beside the file where they were.
Checked check(const std::filesystem::path& system_file, const CheckOptions& options = {});

}  // namespace maide
