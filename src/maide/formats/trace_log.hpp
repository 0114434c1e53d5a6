// Logs of what a system did. A line is one trace: a JSON array of steps. A step is an input and its
// output.
//
//   [["write", "quiet"], ["read", "message"]]
//
// A trace begins in the initial state, after a reset. Empty lines are skipped.
#pragma once

#include <iosfwd>
#include <string>
#include <string_view>
#include <vector>

#include "maide/automata/alphabet.hpp"
#include "maide/base/run_control.hpp"

namespace maide {

struct TraceLog {
  struct Trace {
    Word inputs, outputs;  // as many outputs as inputs
  };
  Alphabet inputs, outputs;  // in the order in which they appear, unless known otherwise
  std::vector<Trace> traces;
  std::string file = {};  // for messages; empty: it came from elsewhere
};

// `what` with the log's file, if it has one, as errors name it.
std::string located(const std::string& what, const TraceLog& log);

// Throws ParseError (file:line:column), Interrupted.
TraceLog read_trace_log(std::string_view text, const std::string& file,
                        const RunControl& control = {});

void write_trace_log(std::ostream& out, const TraceLog& log);

}  // namespace maide
