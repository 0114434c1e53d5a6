// `maide learn --from-traces LOG` without a system: a model from the log alone.
#pragma once

#include <string>

#include "maide/base/error.hpp"
#include "maide/base/run_control.hpp"
#include "maide/cli/context.hpp"

namespace maide::cli {

// `output`: the model's file; empty: standard output.
ExitStatus learn_from_traces(const std::string& log, const std::string& output,
                             const RunControl& control, Context& context);

}  // namespace maide::cli
