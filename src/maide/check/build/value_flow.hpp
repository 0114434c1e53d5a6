// Which values programs write into queues. A type alone says which may be written: `x` of 0..800
// and `x + 1` come to 802 values, of which one may occur. So each program is walked through for the
// values that queues can offer: what is written into a queue is offered to all places that wait at
// it, and these may write more. No model restricts a walk but by the names of its outputs, and a
// queue offers for ever what was once written into it: what is found is at least what occurs.
//
// Example: of `p.write(5)`, and `p.read -> message(x); q.write(x)` with x in 0..800, p and q
// carry 5. Not so good: `n` counted to 800 and written into a queue that is read into `last` and
// `now` comes to 801 values, and to their pairs, of which 801 occur. Cost: O(places x (values
// offered there + values of what the place chooses)).
#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <vector>

#include "maide/base/run_control.hpp"
#include "maide/check/build/models.hpp"

namespace maide {

// By queue of Names::carried: what is written, each as the places of its values in their types. In
// the order of the types.
using OccurringValues = std::map<std::uint32_t, std::set<std::vector<std::uint64_t>>>;

// The models are as they are before they have values. Throws ParseError (a program is too large,
// goes round without a step, ...), and Interrupted when the control says stop.
OccurringValues find_occurring_values(const Declarations& file, Models& models,
                                      const RunControl& control);

}  // namespace maide
