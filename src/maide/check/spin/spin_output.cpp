// From the lines that `spin -t -p` prints back to steps. Each transition stands in a line of its
// own in the Promela, so a line number says all: a rendezvous is two of them, a `d_step` is one
// that may be printed several times.
#include <cstdlib>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string_view>
#include <utility>

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

// Where a line of the run says that a process moved.
struct Place {
  std::uint64_t move = 0;  // its number in the run: statements of one d_step have the same
  std::size_t line = 0;    // of the text
  bool operator==(const Place&) const = default;
};

// Of "  7:	proc  3 (name:1) system.pml:N (state 5)	[...]"; nothing for other lines.
std::optional<Place> place_of(const std::string& line) {
  const std::size_t proc = line.find(":\tproc ");
  const std::size_t file = line.find(".pml:");
  if (proc == std::string::npos || file == std::string::npos || file < proc) return std::nullopt;
  if (line.find("(state ") == std::string::npos || line.find('[') == std::string::npos) {
    return std::nullopt;
  }
  return Place{std::strtoull(line.c_str(), nullptr, 10),
               std::strtoull(line.c_str() + file + 5, nullptr, 10)};
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

// Collects the steps of a run.
class RunReader {
 public:
  RunReader(const PromelaSystem& promela, const System& system)
      : promela_(promela), system_(system), state_(initial_state(system)) {}

  void begin_loop() { trace_.loop_start = trace_.steps.size(); }

  // What another line of the run stands for. False: the run ends there.
  bool read(const Place& place) {
    const PromelaLine& meaning = promela_.lines[place.line];
    if (meaning.kind == Kind::none) return true;
    if (meaning.kind == Kind::step) {
      if (last_ == place) return true;
      last_ = place;
      return read_step(promela_.steps[meaning.index]);
    }
    if (half_ != nullptr) return add(join_halves(*std::exchange(half_, nullptr), meaning, system_));
    if (is_alone(meaning, system_)) return add({meaning.owner, meaning.index, {}, false, false});
    half_ = &meaning;
    return true;
  }

  Trace finish() {
    if (half_ != nullptr) throw std::logic_error("the run of spin ends in half a rendezvous");
    // A loop without steps: the run has ended and its last state repeats.
    if (trace_.loop_start == trace_.steps.size()) trace_.loop_start.reset();
    return std::move(trace_);
  }

 private:
  bool read_step(const PromelaSystem::Step& found) {
    const auto step = promela_.rules->step_of(found.rule, found.ranks, state_);
    if (!step) throw std::logic_error("the run of spin shows a step that is not possible");
    state_ = apply(system_, state_, *step);
    return add(*step);
  }

  // A run that is cut, or comes to an error, ends there; what SPIN appends is of no meaning.
  bool add(Step step) {
    const Program& program = system_.programs[step.program];
    const bool is_last = step.is_cut || program.is_error(program.edges[step.edge].target);
    trace_.steps.push_back(std::move(step));
    if (is_last) trace_.loop_start.reset();
    return !is_last;
  }

  const PromelaSystem& promela_;
  const System& system_;
  GlobalState state_;  // of the form with steps
  std::optional<Place> last_;
  const PromelaLine* half_ = nullptr;
  Trace trace_;
};

}  // namespace

Trace read_spin_run(const std::string& text, const PromelaSystem& promela, const System& system) {
  RunReader reader(promela, system);
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (line.find("<<<START OF CYCLE>>>") != std::string::npos) reader.begin_loop();
    // What follows is the state at the end, in which lines stand for where processes are.
    if (line.find("trail ends after") != std::string::npos) break;
    const auto place = place_of(line);
    if (!place || place->line >= promela.lines.size()) continue;
    if (!reader.read(*place)) break;
  }
  return reader.finish();
}

}  // namespace maide
