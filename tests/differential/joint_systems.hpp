// Random systems with what the second edition of the language has: shared variables, steps that use
// several models, arms with the output that follows, deaths, errors, statements to rest at. Built
// in memory, on top of random_system.hpp.
#pragma once

#include <string>

#include "maide/base/random.hpp"
#include "maide/check/system/system.hpp"
#include "random_system.hpp"

namespace maide::test {

// What may be in a system, beside joint steps and a shared variable.
struct JointSystemKinds {
  bool errors = false, deaths = false, rests = false, groups = false;
  // Up to three actions of nobody, some fair, some no progress if there are deaths, and a program
  // with other flags than the usual ones.
  bool nobody = false;
};
System random_joint_system(Random& random, const RandomSystemSize& size = {},
                           const JointSystemKinds& kinds = {});

// Every edge and what each use of a model does in each of its states.
std::string show(const System& system);

}  // namespace maide::test
