// A counterexample in one sentence of plain words: who waits for what, what became of the messages,
// who could still change that, or where a run breaks a formula. The sentence is made from facts
// alone (check/verdict/waiting.hpp). It knows nothing of particular middlewares.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "maide/check/system/system.hpp"
#include "maide/check/system/trace.hpp"
#include "maide/check/verdict/check_system.hpp"

namespace maide {

// Where a run breaks a formula, in words: "planner@sent holds after step 7, but controller@done
// never holds from then on". The idea: walk down the formula along the reasons for its value. The
// walk goes to the first position at which a temporal operator was broken, and ends at something
// that a person sees in the trace.

// A clause without a full stop. `trace` violates `formula`; `states` are replay()'s.
std::string describe_violation(const System& system, const Formula& formula, const Trace& trace,
                               const std::vector<GlobalState>& states);

// "controller waits at line 13 for message 2 of 6 from via, which holds none: planner wrote 6, 1
// was read and 5 were lost, ...". Without a full stop. `trace` is a counterexample for `property`.
// O(steps x programs).
std::string explain(const System& system, const Property& property, const Trace& trace);

// "controller waits at line 13 for a message from via; via holds none; only planner would write to
// via": what keeps one of blocked_programs() from stepping where a run ends that repeats nothing.
std::string explain_waiting(const System& system, const Trace& trace, std::uint32_t program);

// What is left to say of a property whose run was shown as that of `before`: "planner@sent holds
// after step 7, but controller@done never holds from step 7 on: the same run as deadlock"; and why
// that is, where the sentence on `before` begins with something else.
std::string explain_again(const System& system, const Property& property, const Trace& trace,
                          const PropertyResult& before);

}  // namespace maide
