// Maide learns models of running systems and checks programs against them. This header is all of
// its public face. For a shorter compile time, include the part that you use:
//
//   maide/learn.hpp    learn a model of a running system, or of an object of the program's own
//   maide/check.hpp    check programs that use models: deadlocks, formulas
//   maide/wrapper.hpp  write a wrapper, through which a middleware is learned
//
// Everything is in namespace maide. Errors are exceptions derived from maide::Error. what() is one
// line, "what is wrong (where)". Numbers of states, inputs and outputs are 32 bits wide.
//
// Threads: objects have no locks. Two threads may use two objects, or read one. An object that
// changes must be used by one thread at a time. Functions have no global state but the log and the
// handlers of an Interrupt.
//
// Versions: before 1.0 a minor version may change the interface; a patch version does not.
#pragma once

#define MAIDE_VERSION_MAJOR 0
#define MAIDE_VERSION_MINOR 2
#define MAIDE_VERSION_PATCH 0
// As one number, for #if: 200 for 0.2.0, 10000 for 1.0.0.
#define MAIDE_VERSION_NUMBER \
  (MAIDE_VERSION_MAJOR * 10000 + MAIDE_VERSION_MINOR * 100 + MAIDE_VERSION_PATCH)

#include "maide/base/version.hpp"
#include "maide/check.hpp"
#include "maide/learn.hpp"
#include "maide/wrapper.hpp"
