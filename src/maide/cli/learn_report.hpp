// What `maide learn` says of a run and of the model that came out: as JSON, as text, as a line.
#pragma once

#include <cstddef>
#include <string>

#include "maide/base/json.hpp"
#include "maide/learn/vote.hpp"
#include "maide/workflow/learn_model.hpp"
#include "maide/workflow/system_spec.hpp"

namespace maide::cli {

// `jobs`: systems that were asked at once. `path`: where the model is; "" if in no file.
Json learned_as_json(const LearnedModel& learned, std::size_t jobs, const std::string& path);

// A line for each thing worth knowing. `vote`: how contradictions were decided.
std::string describe_learned(const LearnedModel& learned, const SystemSpec& spec,
                             const VoteOptions& vote, std::size_t jobs, const std::string& path);

// One line, for --quiet.
std::string describe_briefly(const LearnedModel& learned, const std::string& path);

}  // namespace maide::cli
