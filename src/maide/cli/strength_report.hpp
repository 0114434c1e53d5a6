// What `maide learn` says of the strength of a model (automata/strength.hpp): in numbers as JSON,
// in words for people. For a weak model it also says what to type next.
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

// One line, for a weak model: that it is weak, what was not tried, and what that would cost in
// words, symbols and time (at the speed of this run). Empty for any other model.
std::string describe_weakness(const ExperimentResult& run);

struct NextCommand {
  std::uint64_t effort = 1;  // of this run
  std::string model;         // the file that it wrote; "" if none
};
// A command line that goes on from a weak model: the parsed one, changed. It starts from the
// model's file and tests by the default method. If this run did so, too, it has the effort that the
// missing tests need, or ten times this run's if their cost is unknown. Empty if no effort is
// enough.
std::string describe_next_command(const CommandLine& line, const ExperimentResult& run,
                                  const NextCommand& next);

// "extra-states=2 (reached: 1), pumped=64 (reached: 0)": where the model falls short of what was
// demanded; empty: nowhere.
std::string describe_missing(const TestedStrength& tested);

}  // namespace maide::cli
