#include "maide/check.hpp"

#include <sstream>

#include "maide/base/log.hpp"
#include "maide/join/learned_models.hpp"
#include "maide/report/explanation.hpp"
#include "maide/report/trace_text.hpp"

namespace maide {

Checked check(const std::filesystem::path& system_file, const CheckOptions& options) {
  const auto engine = make_engine(options.engine);
  CheckRequest request;
  request.properties = options.properties;
  request.options.memory_mib = options.memory_mib;
  request.options.threads = options.threads;
  request.options.reduction = options.reduction;
  request.options.control = options.control;
  const System system =
      read_system(system_file,
                  make_learning_source({system_file.parent_path(),
                                        [](const std::string& line) { log_note(line); },
                                        options.control, options.jobs}),
                  options.control);
  const CheckReport report = check_system(system, *engine, request);
  Checked checked{report.verdict, report.assumptions, {}};
  for (const PropertyResult& result : report.properties) {
    CheckedProperty& property = checked.properties.emplace_back();
    property.name = result.name;
    property.verdict = result.verdict;
    property.reason = result.reason;
    property.states = result.states;
    property.transitions = result.transitions;
    property.seconds = result.seconds;
    if (!result.trace) continue;
    const Shown shown = shown_part(system, result);
    property.explanation = explain(shown.part.system(), shown.property, shown.trace) + ".";
    std::ostringstream run;
    write_trace_text(run, shown.part.system(), shown.trace, TraceFormat::steps);
    property.run = run.str();
  }
  return checked;
}

}  // namespace maide
