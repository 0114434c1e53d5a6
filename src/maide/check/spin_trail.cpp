// From the lines that `spin -t -p` prints back to steps. Each transition stands in a line of its
// own in the Promela, so a line number says all: a rendezvous is two of them.
#include <cctype>
#include <sstream>
#include <stdexcept>
#include <string_view>

#include "maide/check/spin_engine.hpp"

namespace maide {
namespace {

using Kind = PromelaLine::Kind;

// The N of "  7:	proc  3 (name:1) system.pml:N (state 5)	[...]"; 0 for other lines.
std::size_t source_line(const std::string& line) {
  const std::size_t proc = line.find(":\tproc ");
  const std::size_t file = line.find(".pml:");
  if (proc == std::string::npos || file == std::string::npos || file < proc) return 0;
  if (line.find("(state ") == std::string::npos || line.find('[') == std::string::npos) return 0;
  std::size_t number = 0;
  for (std::size_t at = file + 5;
       at < line.size() && std::isdigit(static_cast<unsigned char>(line[at])); ++at) {
    number = number * 10 + static_cast<std::size_t>(line[at] - '0');
  }
  return number;
}

bool is_alone(const PromelaLine& half, const System& system) {
  return half.kind == Kind::program_edge &&
         system.programs[half.owner].edges[half.index].kind == ProgramEdge::Kind::choice;
}

Step join_halves(const PromelaLine& first, const PromelaLine& second, const System& system) {
  const bool program_first = first.kind == Kind::program_edge;
  const PromelaLine& program = program_first ? first : second;
  const PromelaLine& model = program_first ? second : first;
  if (program.kind != Kind::program_edge || model.kind != Kind::model_transition ||
      system.programs[program.owner].edges[program.index].model != model.owner) {
    throw std::logic_error("the run of spin shows half a rendezvous");
  }
  return {program.owner, program.index, model.model_target, model.is_beyond};
}

}  // namespace

Trace read_spin_run(const std::string& text, const PromelaSystem& promela, const System& system) {
  Trace trace;
  const PromelaLine* half = nullptr;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (line.find("<<<START OF CYCLE>>>") != std::string::npos) {
      trace.loop_start = trace.steps.size();
    }
    // What follows is the state at the end, in which lines stand for where processes are.
    if (line.find("trail ends after") != std::string::npos) break;
    const std::size_t number = source_line(line);
    if (number == 0 || number >= promela.lines.size()) continue;
    const PromelaLine& meaning = promela.lines[number];
    if (meaning.kind == Kind::none) continue;
    if (half == nullptr) {
      half = &meaning;
      if (is_alone(*half, system)) {
        trace.steps.push_back({half->owner, half->index, 0, false});
        half = nullptr;
      }
      continue;
    }
    trace.steps.push_back(join_halves(*half, meaning, system));
    half = nullptr;
    // A run that is cut ends there; what SPIN appends is of no meaning.
    const Step& step = trace.steps.back();
    const ProgramEdge& edge = system.programs[step.program].edges[step.edge];
    if (step.is_beyond && system.models[edge.model].when_unexplored == WhenUnexplored::stop) {
      trace.loop_start.reset();
      return trace;
    }
  }
  if (half != nullptr) throw std::logic_error("the run of spin ends in half a rendezvous");
  // A loop without steps: the run has ended and its last state repeats.
  if (trace.loop_start == trace.steps.size()) trace.loop_start.reset();
  return trace;
}

}  // namespace maide
