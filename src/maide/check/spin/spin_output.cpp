// From the lines that `spin -t -p` prints back to steps. Each transition stands in a line of its
// own in the Promela, so a line number says all: a rendezvous is two of them.
#include <cctype>
#include <cstdlib>
#include <sstream>
#include <stdexcept>
#include <string_view>

#include "maide/check/spin/spin_engine.hpp"

namespace maide {
namespace {

bool contains(const std::string& text, const char* part) {
  return text.find(part) != std::string::npos;
}

// The number at the start of the line, if `rest` follows it.
bool read_count(const std::string& line, const char* rest, std::uint64_t& count) {
  if (!contains(line, rest)) return false;
  char* end = nullptr;
  const double value = std::strtod(line.c_str(), &end);  // large counts come as 1.9867e+06
  if (end == line.c_str() || value < 0) return false;
  count = static_cast<std::uint64_t>(value);
  return true;
}

}  // namespace

std::optional<PanOutput> parse_pan_output(const std::string& text) {
  PanOutput output;
  bool has_errors = false, has_states = false;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    const std::size_t errors = line.find("errors: ");
    if (errors != std::string::npos && line.starts_with("State-vector")) {
      output.errors = std::strtoull(line.c_str() + errors + 8, nullptr, 10);
      has_errors = true;
    } else if (read_count(line, "states, stored", output.states)) {
      has_states = true;
    } else if (read_count(line, "transitions (=", output.transitions)) {
    } else if (contains(line, "total actual memory usage")) {
      output.peak_bytes =
          static_cast<std::uint64_t>(std::strtod(line.c_str(), nullptr) * 1024 * 1024);
    } else if (line.starts_with("pan:") && contains(line, "(at depth")) {
      if (output.first_error.empty()) output.first_error = line.substr(line.find(' ') + 1);
    }
  }
  output.is_depth_truncated = contains(text, "max search depth too small");
  output.is_memory_exhausted = contains(text, "reached -DMEMLIM bound") ||
                               contains(text, "out of memory") || contains(text, "cannot allocate");
  output.is_complete = has_errors && has_states && !output.is_depth_truncated &&
                       !output.is_memory_exhausted && !contains(text, "Search not completed") &&
                       !contains(text, "hash-compact") && !contains(text, "Bit statespace search");
  if (!has_errors && !output.is_memory_exhausted) return std::nullopt;
  return output;
}

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
  const ModelStep met{model.model_target, model.is_beyond};
  return {program.owner,
          program.index,
          {met.target},
          met.is_beyond,
          cuts(system.models[model.owner], met)};
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
        trace.steps.push_back({half->owner, half->index, {}, false, false});
        half = nullptr;
      }
      continue;
    }
    trace.steps.push_back(join_halves(*half, meaning, system));
    half = nullptr;
    // A run that is cut ends there; what SPIN appends is of no meaning.
    if (trace.steps.back().is_cut) {
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
