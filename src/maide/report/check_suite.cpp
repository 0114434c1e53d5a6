#include "maide/report/check_suite.hpp"

#include <filesystem>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "maide/base/version.hpp"
#include "maide/report/explanation.hpp"
#include "maide/report/trace_text.hpp"

namespace maide {
namespace {

void add_violation(JUnitCase& one, const System& system, const CheckReport& report,
                   const PropertyResult& result) {
  one.failure = result.is_possibility ? result.reason : "violated";
  if (!result.trace) return;
  const Shown shown = shown_part(system, result);
  const System& part = shown.part.system();
  if (const PropertyResult* same = find_same_run(report, result)) {
    one.failure = explain_again(part, shown.property, shown.trace, *same) + ".";
    return;
  }
  one.failure = explain(part, shown.property, shown.trace) + ".";
  std::ostringstream run;
  write_shown_text(run, shown, TraceFormat::steps);
  one.details = run.str();
}

}  // namespace

JUnitSuite make_check_suite(const System& system, const CheckReport& report) {
  JUnitSuite suite;
  suite.name = std::filesystem::path(system.file).stem().string();
  suite.properties = {{"system", system.file},
                      {"verdict", std::string(to_string(report.verdict))},
                      {"maide", std::string(version())}};
  for (const auto& [name, value] : system.settings) {
    suite.properties.emplace_back("constant " + name, value);
  }
  const auto add_all = [&](std::string_view name, const std::vector<std::string>& lines) {
    for (const std::string& line : lines) suite.properties.emplace_back(name, line);
  };
  add_all("assumption", report.assumptions);
  add_all("remark", all_remarks(system, report));
  for (const PropertyResult& result : report.properties) {
    JUnitCase one;
    one.name = result.name;
    one.seconds = result.seconds;
    suite.seconds += result.seconds;
    if (result.verdict == Verdict::violated) add_violation(one, system, report, result);
    if (result.verdict == Verdict::inconclusive) {
      one.error = result.reason.empty() ? "inconclusive" : result.reason;
    }
    suite.cases.push_back(std::move(one));
  }
  return suite;
}

}  // namespace maide
