#include "maide/report/program_listing.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <ostream>
#include <set>
#include <string>
#include <vector>

#include "maide/check/waiting.hpp"
#include "maide/report/markup.hpp"

namespace maide {
namespace {

// The text of the program, line by line as it stands in its file.
std::vector<std::string> lines_of(const System& system, const Program& program) {
  const auto source = system.sources.find(program.position.file);
  std::vector<std::string> lines;
  if (source == system.sources.end()) return lines;
  const std::string& text = source->second;
  std::size_t begin = 0;
  for (int line = 1; line <= program.last_line && begin <= text.size(); ++line) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    if (line >= program.position.line) lines.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return lines;
}

// Where a program is in the end.
struct Standing {
  std::set<int> waits;  // lines at which it stands
  std::set<int> loops;  // lines that it repeats for ever
  std::string note;
};

Standing find_standing(const System& system, const Trace& trace, const GlobalState& last,
                       std::uint32_t index) {
  const Program& program = system.programs[index];
  Standing standing;
  if (trace.loop_start) {
    for (std::size_t at = *trace.loop_start; at < trace.steps.size(); ++at) {
      if (trace.steps[at].program != index) continue;
      standing.loops.insert(program.edges[trace.steps[at].edge].line);
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
  for (const ProgramEdge& edge : program.edges_of(control)) standing.waits.insert(edge.line);
  const auto blocked = blocked_programs(system, last);
  const bool is_blocked = std::find(blocked.begin(), blocked.end(), index) != blocked.end();
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
    const std::vector<std::string> lines = lines_of(system, program);
    if (lines.empty()) continue;
    const Standing standing = find_standing(system, trace, last, index);
    out << fmt::format("<h3>{} <small>{}</small></h3>\n<pre class=\"program\">",
                       escape_markup(program.name), escape_markup(standing.note));
    int number = program.position.line;
    for (const std::string& line : lines) {
      std::string text = fmt::format("{:>5}  {}", number, escape_markup(line));
      if (standing.waits.contains(number)) text = "<mark class=\"waits\">" + text + "</mark>";
      if (standing.loops.contains(number)) text = "<mark class=\"loops\">" + text + "</mark>";
      out << text << "\n";
      ++number;
    }
    out << "</pre>\n";
  }
}

}  // namespace maide
