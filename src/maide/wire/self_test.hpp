// Is the middleware of a wrapper usable on this machine? One real word answers that: a reset with
// the default options and each input once, in the order in which the wrapper lists them (a write,
// then a read). For `maide doctor`; a wrapper's executable runs it as --self-test.
#pragma once

#include <string>

#include "maide/wire/system_wrapper.hpp"

namespace maide {

// What was found, in one line: "cyclonedds 0.10.2: write -> quiet, read -> message". Throws
// WrapperError, one line, if the word did not end well or nothing at all was observed. Ends the
// process with status 4 if the reset, or the end of it, hangs.
std::string run_self_test(SystemWrapper& wrapper);

}  // namespace maide
