#include "maide/report/html_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <ostream>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "maide/base/text.hpp"
#include "maide/check/verdict/waiting.hpp"
#include "maide/report/explanation.hpp"
#include "maide/report/sequence_chart.hpp"
#include "maide/report/trace_text.hpp"

namespace maide {

std::string escape_markup(std::string_view text) {
  std::string result;
  for (const char c : text) {
    switch (c) {
      case '&': result += "&amp;"; break;
      case '<': result += "&lt;"; break;
      case '>': result += "&gt;"; break;
      case '"': result += "&quot;"; break;
      case '\n':
      case '\t': result += c; break;
      default: result += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
    }
  }
  return result;
}

namespace {

// Where a program is in the end.
struct Standing {
  std::set<int> waits;  // lines at which it stands
  std::set<int> loops;  // lines that it repeats for ever
  std::string note;
};

// The text of the program, by lines of its file: of what runs callbacks, that of these; and where
// it is, which may be in a procedure.
std::map<int, std::string> lines_of(const System& system, const Program& program,
                                    const Standing& standing) {
  const auto source = system.sources.find(program.position.file);
  std::map<int, std::string> lines;
  if (source == system.sources.end()) return lines;
  const auto is_shown = [&](int line) {
    const auto is_within = [&](int first, int last) { return line >= first && line <= last; };
    if (standing.waits.contains(line) || standing.loops.contains(line)) return true;
    if (program.callbacks.empty()) return is_within(program.position.line, program.last_line);
    return std::ranges::any_of(program.callbacks, [&](const auto& callback) {
      return is_within(callback.first, callback.last);
    });
  };
  int line = 0;
  for (const std::string_view text : split(source->second, '\n')) {
    if (is_shown(++line)) lines.emplace(line, text);
  }
  return lines;
}

Standing find_standing(const System& system, const Trace& trace, const GlobalState& last,
                       std::uint32_t index) {
  const Program& program = system.programs[index];
  Standing standing;
  if (trace.loop_start) {
    for (std::size_t at = *trace.loop_start; at < trace.steps.size(); ++at) {
      if (trace.steps[at].actor != index) continue;
      standing.loops.insert(edge_of(system, trace.steps[at]).line);
    }
  }
  if (!standing.loops.empty()) {
    standing.note = "goes on for ever";
    return standing;
  }
  const ControlState control = last.programs[index];
  if (program.is_end(control)) {
    standing.note = "has ended";
    return standing;
  }
  if (program.is_error(control)) {
    const ProgramError& error = program.errors[program.states[control].error];
    standing.note = "error: " + error.text;
    standing.waits.insert(error.position.line);
    return standing;
  }
  const auto blocked = blocked_programs(system, last);
  const bool is_blocked = std::ranges::find(blocked, index) != blocked.end();
  if (program.may_rest(control) && !is_blocked) {
    standing.note = "rests";
    return standing;
  }
  for (const ProgramEdge& edge : program.edges_of(control)) standing.waits.insert(edge.line);
  standing.note = is_blocked ? "waits here" : "stands here";
  for (std::uint32_t at = program.states[control].round; at != 0; at = program.rounds[at].outer) {
    const Program::Round& round = program.rounds[at];
    if (round.count == 0) continue;
    standing.note += fmt::format(", in round {} of {} of the repeat in line {}", round.number,
                                 round.count, round.line);
  }
  return standing;
}

}  // namespace

void write_program_listing(std::ostream& out, const System& system, const Trace& trace) {
  const GlobalState last = replay(system, trace).back();
  for (std::uint32_t index = 0; index < system.programs.size(); ++index) {
    const Program& program = system.programs[index];
    const Standing standing = find_standing(system, trace, last, index);
    const std::map<int, std::string> lines = lines_of(system, program, standing);
    if (lines.empty()) continue;
    out << fmt::format("<h3>{} <small>{}</small></h3>\n<pre class=\"program\">",
                       escape_markup(program.name), escape_markup(standing.note));
    for (const auto& [number, line] : lines) {
      std::string text = fmt::format("{:>5}  {}", number, escape_markup(line));
      if (standing.waits.contains(number)) text = "<mark class=\"waits\">" + text + "</mark>";
      if (standing.loops.contains(number)) text = "<mark class=\"loops\">" + text + "</mark>";
      out << text << "\n";
    }
    out << "</pre>\n";
  }
}

namespace {

constexpr const char* style =
    "body{font-family:sans-serif;max-width:70em;margin:2em auto;padding:0 1em;color:#222}"
    "table{border-collapse:collapse}td,th{text-align:left;padding:.2em 1em .2em 0}"
    ".violated{color:#a00000;font-weight:bold}.holds{color:#006000;font-weight:bold}"
    ".inconclusive{color:#8a5a00;font-weight:bold}"
    ".why{font-size:1.15em}mark{background:none;color:inherit}"
    "mark.waits{background:#fbd5d5}mark.loops{background:#fbe6d0}h3 small{font-weight:normal}"
    "pre{background:#f6f6f6;padding:.8em;overflow-x:auto}svg{max-width:100%;height:auto}";

std::string verdict_cell(Verdict verdict, const std::string& text) {
  return fmt::format("<span class=\"{}\">{}</span>", to_string(verdict), text);
}

void write_table(std::ostream& out, const CheckReport& report) {
  out << "<table><tr><th>property</th><th>verdict</th><th>states</th><th>transitions</th>"
         "<th>seconds</th></tr>\n";
  for (const PropertyResult& result : report.properties) {
    out << fmt::format("<tr><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{:.2f}</td></tr>\n",
                       escape_markup(result.name),
                       verdict_cell(result.verdict, describe_verdict(result)), result.states,
                       result.transitions, result.seconds);
    if (!result.reason.empty()) {
      out << fmt::format("<tr><td></td><td colspan=\"4\">{}</td></tr>\n",
                         escape_markup(result.reason));
    }
  }
  out << "</table>\n";
}

void write_counterexample(std::ostream& out, const System& system, const CheckReport& report,
                          const PropertyResult& result) {
  out << fmt::format("<h2>{}: how it is {}</h2>\n", escape_markup(result.name),
                     result.is_possibility ? "possible" : "violated");
  const Shown shown = shown_part(system, result);
  const System& part = shown.part.system();
  const PropertyResult* same = find_same_run(report, result);
  const std::string sentence = same == nullptr
                                   ? explain(part, shown.property, shown.trace)
                                   : explain_again(part, shown.property, shown.trace, *same);
  out << fmt::format("<p class=\"why\">{}.</p>\n", escape_markup(sentence));
  if (same != nullptr) return;
  write_sequence_chart_svg(out, make_trace_chart(part, shown.trace, ""));
  std::ostringstream text;
  write_shown_text(text, shown, TraceFormat::steps);
  out << "<details><summary>step by step</summary><pre>" << escape_markup(text.str())
      << "</pre></details>\n";
  write_program_listing(out, part, shown.trace);
}

// Nothing for no lines.
void write_list(std::ostream& out, const std::string& title,
                const std::vector<std::string>& lines) {
  if (lines.empty()) return;
  out << "<p>" << title << "</p><ul>\n";
  for (const std::string& line : lines) out << "<li>" << escape_markup(line) << "</li>\n";
  out << "</ul>\n";
}

}  // namespace

void write_html_report(std::ostream& out, const System& system, const CheckReport& report,
                       const ModelPainter& paint) {
  out << fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>{0}</title>"
      "<style>{1}</style></head>\n<body><h1>{0}: {2}</h1>\n",
      escape_markup(system.title()), style,
      verdict_cell(report.verdict, to_string(report.verdict)));
  write_table(out, report);
  if (report.races) {
    write_list(out, "Races: what is sent later may come first.", describe_races(*report.races));
  }
  write_list(out, "This rests on:", report.assumptions);
  for (const PropertyResult& result : report.properties) {
    if (result.trace) write_counterexample(out, system, report, result);
  }
  for (const ModelInstance& model : system.models) {
    if (model.source == ModelInstance::Source::executor) continue;
    const std::string picture = paint ? paint(model.automaton) : "";
    const bool is_rule = model.source == ModelInstance::Source::service;
    const std::string origin = is_rule                ? ", by the rules of services"
                               : model.origin.empty() ? ""
                                                      : ", from " + model.origin;
    out << fmt::format("<h2>model {}</h2>\n<p>{} states, {} transitions{}</p>\n{}\n",
                       escape_markup(model.name), model.automaton.size(),
                       model.automaton.transition_count(), escape_markup(origin), picture);
  }
  out << "</body></html>\n";
}

}  // namespace maide
