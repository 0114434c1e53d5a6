// What a learning run says of words that were answered in several ways, or otherwise than a log
// says.
#pragma once

#include <string>
#include <vector>

#include "maide/base/json.hpp"
#include "maide/conformance/logged_traces.hpp"
#include "maide/learn/vote.hpp"

namespace maide::cli {

Json contradictions_as_json(const std::vector<Contradiction>& contradictions);

// A line each, the least certain first, and how they were decided; "" if there are none.
std::string describe_contradictions(const std::vector<Contradiction>& contradictions,
                                    const VoteOptions& vote);

// Words that a log has wrong (--from-traces).
Json contradictions_as_json(const std::vector<LogContradiction>& contradictions);
// One line; "" if there are none.
std::string describe_contradictions(const std::vector<LogContradiction>& contradictions);

}  // namespace maide::cli
