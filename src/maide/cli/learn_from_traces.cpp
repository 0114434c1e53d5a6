#include "maide/cli/learn_from_traces.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "maide/base/file.hpp"
#include "maide/base/printable.hpp"
#include "maide/formats/dot.hpp"
#include "maide/learn/rpni.hpp"
#include "maide/workflow/read_traces.hpp"

namespace maide::cli {

ExitStatus learn_from_traces(const std::string& log, const std::string& output,
                             const RunControl& control, Context& context) {
  if (!output.empty()) check_can_write(output);
  const TraceLog traces = read_traces(log, control);
  PassiveModel learned = learn_passively(traces, control);
  Mealy& machine = learned.machine;
  machine.origin["algorithm"] = "rpni";
  machine.origin["passive"] =
      fmt::format("learned from {} traces alone: no system was asked", traces.traces.size());
  std::ostringstream dot;
  write_dot(dot, machine);

  std::string summary = fmt::format(
      "{}: {} traces\n"
      "  Mealy machine        {} states, {} inputs (passive: RPNI)\n"
      "  never seen           {} transitions, drawn as loops that answer 'unexplored'\n"
      "  result               agrees with every trace; what it says beyond them is a guess\n",
      log, traces.traces.size(), machine.size(), machine.inputs().size(),
      learned.unseen_transitions);
  Json result{{"algorithm", "rpni"},
              {"passive", true},
              {"traces", traces.traces.size()},
              {"states", machine.size()},
              {"transitions", machine.size() * machine.inputs().size()},
              {"unseen_transitions", learned.unseen_transitions},
              {"model", output.empty() ? Json() : Json(output)}};
  if (output.empty()) {
    if (!context.json() && !context.quiet()) fmt::print(stderr, "{}", printable(summary));
    context.print_data(dot.str());
    result["dot"] = dot.str();
  } else {
    write_file_atomically(output, dot.str());
    if (context.quiet()) summary = fmt::format("{}: {} states (passive)\n", output, machine.size());
    context.print(context.quiet() ? summary
                                  : summary + fmt::format("  model                {}\n", output));
  }
  context.set_result(result);
  return ExitStatus::ok;
}

}  // namespace maide::cli
