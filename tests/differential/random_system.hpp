// Random systems: random interface automata with marks, and random program texts over them.
#pragma once

#include "maide/base/random.hpp"
#include "maide/check/system/system.hpp"

namespace maide::test {

// At least one model, `m`, then `n`, `o`, ..., each of 2 to 5 states; programs `p`, `q`, ..., each
// a dozen statements at most, with labels `l0`, `l1`, ...
struct RandomSystemSize {
  std::size_t least_programs = 1, most_programs = 3;
  std::size_t most_models = 2;
  double counters = 0;  // chance that a model counts: i0 up, i1 down and o0, all in order
  double loops = 0;     // chance that a program goes on for ever, with whatever input
  // Chance that a model is a mailbox: i0 puts a message in; i1 takes one out, which is o0, or waits
  // for it.
  double mailboxes = 0;
};
System random_system(Random& random, const RandomSystemSize& size = {});

}  // namespace maide::test
