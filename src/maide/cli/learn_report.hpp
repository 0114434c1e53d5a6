// What `maide learn` says of a run and of the model that came out: as JSON, as text, as a line.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "maide/base/json.hpp"
#include "maide/cli/command_line.hpp"
#include "maide/conformance/method/known_words.hpp"
#include "maide/experiment/experiment.hpp"
#include "maide/experiment/learn_model.hpp"
#include "maide/experiment/open_system.hpp"
#include "maide/learn/oracle/vote.hpp"

namespace maide::cli {

// What a learning run says of words that were answered in several ways, or otherwise than a log
// says.
Json contradictions_as_json(const std::vector<Contradiction>& contradictions);

// A line each, the least certain first, and how they were decided; "" if there are none.
std::string describe_contradictions(const std::vector<Contradiction>& contradictions,
                                    const VoteOptions& vote);

// Words that a log has wrong (--from-traces).
Json contradictions_as_json(const std::vector<LogContradiction>& contradictions);
// One line; "" if there are none.
std::string describe_contradictions(const std::vector<LogContradiction>& contradictions);

// What a learning run cost, by phase and by hypothesis: as a table, as JSON, and as a plot.

// Lines for the summary of a run; of many hypotheses the first and the last.
std::string describe_statistics(const ExperimentResult& run);

// Adds the members "phases" and "hypotheses".
void add_statistics(Json& json, const ExperimentResult& run);

// States of the hypothesis over symbols given to the system, as SVG.
std::string draw_hypotheses(const ExperimentResult& run, const std::string& title);

// `jobs`: systems that were asked at once. `path`: where the model is; "" if in no file.
Json learned_as_json(const LearnedModel& learned, std::size_t jobs, const std::string& path);

// A line for each thing worth knowing. `vote`: how contradictions were decided.
std::string describe_learned(const LearnedModel& learned, const SystemSpec& spec,
                             const VoteOptions& vote, std::size_t jobs, const std::string& path);

// One line, for --quiet.
std::string describe_briefly(const LearnedModel& learned, const std::string& path);

// What `maide learn` says of the strength of a model (automata/strength.hpp): in numbers as JSON,
// in words for people. For a weak model it also says what to type next.

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
