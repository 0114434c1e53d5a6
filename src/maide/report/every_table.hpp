// What came of a check with each value of a number (join/check_every.hpp), as a table.
#pragma once

#include <string>
#include <vector>

#include "maide/base/json.hpp"
#include "maide/join/check_every.hpp"

namespace maide {

// A line for each value, with the verdict on each property; then one for each property: "deadlock:
// violated up to 11, holds from 12 on"; at last what is known of larger values.
std::string describe_every(const CheckedValues& checked);

Json every_to_json(const CheckedValues& checked);

// The worst of all: violated, then inconclusive, then holds.
Verdict verdict_of(const CheckedValues& checked);
// Of the worst report.
ExitStatus exit_status_of(const CheckedValues& checked);

}  // namespace maide
