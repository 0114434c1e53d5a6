// Random systems: random interface automata with marks, and random program texts over them.
#pragma once

#include "maide/base/random.hpp"
#include "maide/check/system.hpp"

namespace maide::test {

// One or two models of 2 to 5 states, one to three programs, each a dozen statements at most. The
// programs have labels `l0`, `l1`, ... each.
System random_system(Random& random);

}  // namespace maide::test
