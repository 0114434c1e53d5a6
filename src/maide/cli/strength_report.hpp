// What `maide learn` says of the strength of a model (automata/strength.hpp): in numbers as JSON,
// in words for people, and, where the model is weak, what to type next.
#pragma once

#include <cstdint>
#include <string>

#include "maide/base/json.hpp"
#include "maide/cli/command_line.hpp"
#include "maide/workflow/learn_model.hpp"

namespace maide::cli {

// "strength", "strength_demanded", "strength_missing", "cost_of_missing", "inputs_without_effect".
void add_strength(Json& json, const LearnedModel& learned);

// A line that names the strength, and one that names the inputs without effect, if there are any.
// The first is empty for a model without a strength.
std::string describe_strength(const LearnedModel& learned);

// One line, for a weak model: that it is weak, what was not tried, what that would cost in words,
// symbols and, at the speed of this run, time. Empty for any other model.
std::string describe_weakness(const ExperimentResult& run);

struct NextCommand {
  std::uint64_t effort = 1;  // of this run
  std::string model;         // the file that it wrote; "" if none
};
// The command line that was parsed, changed so that it goes on from a weak model: it
// starts from the file, tests by the default method, and, if this run did, with the effort that
// the missing tests need (ten times as much where their cost is unknown). Empty where no effort is
// enough.
std::string describe_next_command(const CommandLine& line, const ExperimentResult& run,
                                  const NextCommand& next);

// "extra-states=2 (reached: 1), pumped=64 (reached: 0)": where the model falls short of what was
// demanded; empty: nowhere.
std::string describe_missing(const TestedStrength& tested);

}  // namespace maide::cli
