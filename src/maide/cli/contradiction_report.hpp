// What a learning run says of words that were answered in several ways.
#pragma once

#include <string>
#include <vector>

#include "maide/base/json.hpp"
#include "maide/learn/vote.hpp"

namespace maide::cli {

Json contradictions_as_json(const std::vector<Contradiction>& contradictions);

// A line each, the least certain first, and how they were decided; "" if there are none.
std::string describe_contradictions(const std::vector<Contradiction>& contradictions,
                                    const VoteOptions& vote);

}  // namespace maide::cli
