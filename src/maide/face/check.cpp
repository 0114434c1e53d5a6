// maide::check(): a system file checked as the command line does it.
#include "maide/check.hpp"

#include <filesystem>
#include <sstream>
#include <string>

#include "maide/base/log.hpp"
#include "maide/check/build/constant_settings.hpp"
#include "maide/join/check_system_file.hpp"
#include "maide/report/explanation.hpp"
#include "maide/report/trace_text.hpp"

namespace maide {
namespace {

CheckedProperty make_checked(const System& system, const CheckReport& report,
                             const PropertyResult& result) {
  CheckedProperty property;
  property.name = result.name;
  property.verdict = result.verdict;
  property.reason = result.reason;
  property.is_possibility = result.is_possibility;
  property.states = result.states;
  property.transitions = result.transitions;
  property.seconds = result.seconds;
  if (!result.trace) return property;
  const Shown shown = shown_part(system, result);
  property.explanation = explain(shown.part.system(), shown.property, shown.trace) + ".";
  std::ostringstream run;
  write_shown_text(run, shown, TraceFormat::steps);
  property.run = run.str();
  if (const PropertyResult* same = find_same_run(report, result)) property.same_run_as = same->name;
  return property;
}

}  // namespace

Checked check(const std::filesystem::path& system_file, const CheckOptions& options) {
  const auto engine = make_engine(options.engine);
  CheckRequest request;
  request.properties = options.properties;
  request.options.memory_mib = options.memory_mib;
  request.options.threads = options.threads;
  request.options.reduction = options.reduction;
  request.options.control = options.control;
  request.finds_races = true;
  const auto [system, report] = check_system_file(
      system_file, *engine, request,
      {{}, [](const std::string& line) { log_note(line); }, options.control, options.jobs},
      parse_settings(options.set));
  Checked checked{
      report.verdict, report.assumptions, report.doubts, all_remarks(system, report), {}, {}};
  if (report.races) checked.races = describe_races(*report.races);
  for (const PropertyResult& result : report.properties) {
    checked.properties.push_back(make_checked(system, report, result));
  }
  return checked;
}

}  // namespace maide
