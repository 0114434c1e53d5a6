#include "maide/report/html_report.hpp"

#include <fmt/format.h>

#include <ostream>
#include <sstream>

#include "maide/report/explanation.hpp"
#include "maide/report/markup.hpp"
#include "maide/report/program_listing.hpp"
#include "maide/report/sequence_chart.hpp"
#include "maide/report/trace_chart.hpp"
#include "maide/report/trace_text.hpp"

namespace maide {
namespace {

constexpr const char* style =
    "body{font-family:sans-serif;max-width:70em;margin:2em auto;padding:0 1em;color:#222}"
    "table{border-collapse:collapse}td,th{text-align:left;padding:.2em 1em .2em 0}"
    ".violated{color:#a00000;font-weight:bold}.holds{color:#006000;font-weight:bold}"
    ".inconclusive{color:#8a5a00;font-weight:bold}"
    ".why{font-size:1.15em}mark{background:none;color:inherit}"
    "mark.waits{background:#fbd5d5}mark.loops{background:#fbe6d0}h3 small{font-weight:normal}"
    "pre{background:#f6f6f6;padding:.8em;overflow-x:auto}svg{max-width:100%;height:auto}";

std::string verdict_cell(Verdict verdict) {
  const std::string text = to_string(verdict);
  return fmt::format("<span class=\"{0}\">{0}</span>", text);
}

void write_table(std::ostream& out, const CheckReport& report) {
  out << "<table><tr><th>property</th><th>verdict</th><th>states</th><th>transitions</th>"
         "<th>seconds</th></tr>\n";
  for (const PropertyResult& result : report.properties) {
    out << fmt::format("<tr><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{:.2f}</td></tr>\n",
                       escape_markup(result.name), verdict_cell(result.verdict), result.states,
                       result.transitions, result.seconds);
    if (!result.reason.empty()) {
      out << fmt::format("<tr><td></td><td colspan=\"4\">{}</td></tr>\n",
                         escape_markup(result.reason));
    }
  }
  out << "</table>\n";
}

void write_counterexample(std::ostream& out, const System& system, const PropertyResult& result) {
  out << fmt::format("<h2>{}: how it is violated</h2>\n", escape_markup(result.name));
  const std::string sentence = explain(system, find_property(system, result.name), *result.trace);
  out << fmt::format("<p class=\"why\">{}.</p>\n", escape_markup(sentence));
  write_sequence_chart_svg(out, make_trace_chart(system, *result.trace, ""));
  std::ostringstream text;
  write_trace_text(text, system, *result.trace, TraceFormat::steps);
  out << "<details><summary>step by step</summary><pre>" << escape_markup(text.str())
      << "</pre></details>\n";
  write_program_listing(out, system, *result.trace);
}

}  // namespace

void write_html_report(std::ostream& out, const System& system, const CheckReport& report,
                       const ModelPainter& paint) {
  out << fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>{0}</title>"
      "<style>{1}</style></head>\n<body><h1>{0}: {2}</h1>\n",
      escape_markup(system.file), style, verdict_cell(report.verdict));
  write_table(out, report);
  if (!report.assumptions.empty()) {
    out << "<p>This rests on:</p><ul>\n";
    for (const std::string& assumption : report.assumptions) {
      out << "<li>" << escape_markup(assumption) << "</li>\n";
    }
    out << "</ul>\n";
  }
  for (const PropertyResult& result : report.properties) {
    if (result.trace) write_counterexample(out, system, result);
  }
  for (const ModelInstance& model : system.models) {
    const std::string picture = paint ? paint(model.automaton) : "";
    out << fmt::format("<h2>model {}</h2>\n<p>{} states, {} transitions, from {}</p>\n{}\n",
                       escape_markup(model.name), model.automaton.size(),
                       model.automaton.transition_count(), escape_markup(model.origin), picture);
  }
  out << "</body></html>\n";
}

}  // namespace maide
