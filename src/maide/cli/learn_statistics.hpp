// What a learning run cost, by phase and by hypothesis: as a table, as JSON, and as a plot.
#pragma once

#include <string>

#include "maide/base/json.hpp"
#include "maide/workflow/experiment.hpp"

namespace maide::cli {

// Lines for the summary of a run; of many hypotheses the first and the last.
std::string describe_statistics(const ExperimentResult& run);

// Adds the members "phases" and "hypotheses".
void add_statistics(Json& json, const ExperimentResult& run);

// States of the hypothesis over symbols given to the system, as SVG.
std::string draw_hypotheses(const ExperimentResult& run, const std::string& title);

}  // namespace maide::cli
