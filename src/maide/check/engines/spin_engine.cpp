#include "maide/check/engines/spin_engine.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string_view>
#include <utility>
#include <vector>

#include "maide/check/engines/engine_folder.hpp"
#include "maide/check/engines/export/promela_system.hpp"
#include "maide/check/system/components.hpp"

namespace maide {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;
using Purpose = PromelaOptions::Purpose;

constexpr std::uint64_t first_depth = 100'000;
constexpr std::uint64_t last_depth = 1'000'000'000;
constexpr std::size_t largest_claim = 16'000;  // bytes of a formula; spin refuses shorter ones, too
constexpr std::chrono::seconds shortening_time{5};  // what "cheap" means

// One verification: a temporary folder in which SPIN's verifier is made and run.
class Verification {
 public:
  Verification(const SpinOptions& tools, const EngineOptions& options, const System& system,
               Purpose purpose, const Formula& formula, bool is_fair, std::string what)
      : tools_(tools),
        options_(options),
        system_(system),
        purpose_(purpose),
        is_fair_(is_fair),
        what_(std::move(what)),
        memory_mib_(memory_limit_mib(options)),
        promela_(write_promela(system, {purpose, formula, true})),
        folder_("spin", options.control) {
    std::string text = promela_.text;
    if (purpose_ == Purpose::ltl) text += never_claim();
    write_file_atomically(folder_.path() / "system.pml", text);
    folder_.run_tool({tools_.spin, "-a", "system.pml"}, "spin", "pan.c");
  }

  // Makes the verifier and runs it, deeper and deeper until nothing is cut off.
  PanOutput search() {
    compile({});
    std::uint64_t depth = first_depth;
    while (true) {
      const auto start = Clock::now();
      PanOutput output = run_pan({fmt::format("-m{}", depth)}, {});
      seconds_ += std::chrono::duration<double>(Clock::now() - start).count();
      if (!output.is_depth_truncated || output.errors > 0 || output.is_memory_exhausted ||
          depth == last_depth) {
        return output;
      }
      depth *= 10;
    }
  }

  // The counterexample that the last search left.
  Trace read_trace(const std::string& trail = "system.pml.trail") {
    const SubprocessResult result =
        folder_.run({tools_.spin, "-t", "-p", "-k", trail, "system.pml"});
    return read_spin_run(result.out, promela_, system_);
  }

  // A trace that is no longer than `trace`, and shortest if the time suffices: pan searches on for
  // errors at a smaller depth than the last one. Whatever goes wrong here, `trace` stays true.
  Trace shorten(Trace trace) {
    const fs::path trail = folder_.path() / "system.pml.trail";
    const fs::path first = folder_.path() / "first.trail";
    std::error_code error;
    fs::rename(trail, first, error);
    try {
      compile({"-DREACH"});
      // A step is at most two of pan's moves, and the processes have to be started.
      const std::size_t depth = 2 * trace.steps.size() + 2 * promela_.processes + 10;
      std::vector<std::string> command{"./pan", fmt::format("-m{}", depth), "-i", "-n"};
      command.emplace_back(what_to_ignore());
      folder_.run(command, shortening_time);
      if (!fs::exists(trail, error)) return trace;
      Trace shorter = read_trace();
      return shorter.steps.size() < trace.steps.size() ? shorter : trace;
    } catch (const std::logic_error&) {
      return trace;  // the trail was being written when the time was over
    } catch (const Error&) {
      return trace;  // interrupted, or out of disk
    }
  }

  // What pan counted, as states and transitions of the system; with a claim, of its product with
  // it.
  std::uint64_t states(const PanOutput& output) const {
    if (purpose_ == Purpose::ltl || output.states == 0) return output.states;
    if (promela_.has_start) return output.states - 1;
    return promela_.is_doubled ? output.states / 2 : output.states;
  }
  std::uint64_t transitions(const PanOutput& output) const {
    // With steps alone pan counts one too much: the initial state as stored.
    const bool is_exact = purpose_ != Purpose::ltl && promela_.rules && output.transitions > 0;
    return is_exact ? output.transitions - 1 : output.transitions;
  }
  double seconds() const { return seconds_; }
  std::uint64_t memory_mib() const { return memory_mib_; }

 private:
  // The never claim, which first lets processes be started.
  std::string never_claim() {
    SubprocessResult result;
    if (promela_.claim.size() <= largest_claim) {
      result = folder_.start_tool({tools_.spin, "-f", promela_.claim}, "spin");
    }
    const std::size_t begin = result.out.find("never");
    const std::size_t brace = result.out.find('{', begin);
    const std::size_t body = result.out.find('\n', brace);
    if (!result.succeeded() || begin == std::string::npos || body == std::string::npos) {
      throw UsageError(what_ +
                       " is too large for spin (once <-> and W are spelled out by U and R)");
    }
    const std::string start = promela_.has_start ? "  true;\n" : "";
    return "never {\n" + start + result.out.substr(body + 1);
  }

  void compile(const std::vector<std::string>& definitions) {
    // Optimising what comes of a long program takes longer than most searches in it.
    std::string optimisation = tools_.optimisation;
    if (optimisation.empty()) optimisation = promela_.lines.size() > 300 ? "-O0" : "-O1";
    // In two steps and through pipes: a compiler that is killed leaves no file elsewhere.
    std::vector<std::string> command{
        tools_.compiler, optimisation, "-w", "-pipe", "-c", "-o", "pan.o", "pan.c", "-DNOREDUCE"};
    if (purpose_ != Purpose::ltl) command.emplace_back("-DSAFETY");
    // pan keeps room for 4 NFAIR - 2 processes.
    if (is_fair_) command.push_back(fmt::format("-DNFAIR={}", (promela_.processes + 2) / 4 + 2));
    command.push_back(fmt::format("-DMEMLIM={}", memory_mib_));
    command.push_back(fmt::format("-DVECTORSZ={}", 1024 + 64 * promela_.processes));
    command.insert(command.end(), definitions.begin(), definitions.end());
    folder_.run_tool(command, "a C compiler", "pan.o");
    folder_.run_tool({tools_.compiler, "-o", "pan", "pan.o"}, "a C compiler", "pan");
  }

  // Assertions, or invalid end states.
  const char* what_to_ignore() const { return purpose_ == Purpose::deadlock ? "-A" : "-E"; }

  PanOutput run_pan(std::vector<std::string> arguments,
                    std::optional<std::chrono::milliseconds> limit) {
    arguments.insert(arguments.begin(), "./pan");
    arguments.emplace_back("-n");
    if (purpose_ == Purpose::ltl) arguments.emplace_back("-a");
    arguments.emplace_back(what_to_ignore());
    if (is_fair_) arguments.emplace_back("-f");
    const SubprocessResult result = folder_.run(arguments, limit);
    const auto output = parse_pan_output(result.out + result.err);
    if (!output) throw UsageError("spin's verifier failed: " + complaint(result));
    return *output;
  }

  const SpinOptions& tools_;
  const EngineOptions& options_;
  const System& system_;
  Purpose purpose_;
  bool is_fair_;
  std::string what_;  // is verified; for messages
  std::uint64_t memory_mib_;
  PromelaSystem promela_;
  EngineFolder folder_;
  double seconds_ = 0;
};

std::string why_incomplete(const PanOutput& output, std::uint64_t memory_mib) {
  if (output.is_memory_exhausted) {
    return fmt::format("the search needs more than {} MiB of memory", memory_mib);
  }
  if (output.is_depth_truncated) return "the search is deeper than SPIN can go";
  return "SPIN did not complete the search";
}

// A violation of a safety property shows on a prefix, and every prefix goes on to a fair run.
bool depends_on_fairness(const Property& property) {
  return property.kind == Property::Kind::ltl && property.fairness == Fairness::weak &&
         !is_syntactically_safe(property.formula);
}

Purpose purpose_of(const Property& property) {
  switch (property.kind) {
    case Property::Kind::deadlock: return Purpose::deadlock;
    case Property::Kind::error: return Purpose::error;
    default: return Purpose::ltl;
  }
}

}  // namespace

std::string SpinEngine::obstacle(const System& system, const Property& property) const {
  if (property.kind == Property::Kind::stuck)
    return "the engine spin does not check 'stuck' (--engine native does)";
  if (property.kind == Property::Kind::never) {
    return "the engine spin checks no automaton (--engine native does)";
  }
  if (property.kind != Property::Kind::ltl) return "";
  if (property.is_always_possible) {
    return "the engine spin does not check what is always possible (--engine native does)";
  }
  if (contains(property.formula, FormulaNode::Operator::next)) {
    return "the engine spin checks no formula with X (--engine native does)";
  }
  if (property.fairness == Fairness::strong)
    return "the engine spin has no strong fairness (--engine native has)";
  if (!depends_on_fairness(property)) return "";
  if (!system.nobodys_actions.empty()) {
    return "the engine spin is fair to whatever steps, and some steps are nobody's (--engine "
           "native "
           "tells them apart)";
  }
  for (const std::uint32_t index : programs_of(system, property, find_components(system))) {
    if (!system.programs[index].flags.is_fair) {
      return "the engine spin is fair to all programs (--engine native leaves some out)";
    }
    const Program& program = system.programs[index];
    if (std::ranges::any_of(program.combined, [](const CombinedStep& step) {
          return step.role == CombinedStep::Role::causeless;
        })) {
      return "the engine spin lets nobody wake from a condition without a notification again and "
             "again, and " +
             program.name + " may (--engine native knows that)";
    }
    for (const FairGroup& group : system.programs[index].fair_groups) {
      if (!group.on_weak_runs) continue;
      return "the engine spin has no `fair` choices, and " + system.programs[index].name +
             " makes one (--engine native has)";
    }
  }
  return "";
}

PropertyResult SpinEngine::check(const System& system, const Property& property,
                                 const EngineOptions& options) {
  PropertyResult result;
  result.name = property.name;
  const bool is_ltl = property.kind == Property::Kind::ltl;
  const std::string place = to_string(property.position);
  const std::string what =
      fmt::format("property '{}'{}", property.name, place.empty() ? "" : " (" + place + ")");
  try {
    Verification verification(options_, options, system, purpose_of(property), property.formula,
                              depends_on_fairness(property), what);
    const PanOutput output = verification.search();
    result.states = verification.states(output);
    result.transitions = verification.transitions(output);
    result.peak_bytes = output.peak_bytes;
    result.seconds = verification.seconds();
    if (output.errors == 0) {
      result.verdict = output.is_complete ? Verdict::holds : Verdict::inconclusive;
      if (!output.is_complete) result.reason = why_incomplete(output, verification.memory_mib());
      return result;
    }
    Trace trace = verification.read_trace();
    require_sound(name(), system, property, trace);
    if (!is_ltl && options_.shortens) {
      Trace shorter = verification.shorten(trace);
      if (find_flaw(system, property, shorter).empty()) trace = std::move(shorter);
    }
    result.verdict = Verdict::violated;
    result.trace = std::move(trace);
  } catch (const Interrupted& stop) {
    result.verdict = Verdict::inconclusive;
    result.reason = why_stopped(options);
  }
  return result;
}

CutResult SpinEngine::find_cut(const System& system, const EngineOptions& options) {
  CutResult result;
  if (!StepRules(system).may_cut()) {
    result.verdict = Verdict::holds;
    return result;
  }
  try {
    Verification verification(options_, options, system, Purpose::cut, nullptr, false, "");
    const PanOutput output = verification.search();
    if (output.errors == 0) {
      result.verdict = output.is_complete ? Verdict::holds : Verdict::inconclusive;
      if (!output.is_complete) result.reason = why_incomplete(output, verification.memory_mib());
      return result;
    }
    Trace trace = verification.read_trace();
    if (!replay(system, trace).back().is_cut) {
      throw std::logic_error("spin's run to the bound does not replay");
    }
    if (options_.shortens) {
      Trace shorter = verification.shorten(trace);
      if (replay(system, shorter).back().is_cut) trace = std::move(shorter);
    }
    result.verdict = Verdict::violated;
    result.trace = std::move(trace);
  } catch (const Interrupted&) {
    result.reason = why_stopped(options);
  }
  return result;
}

// From the lines that `spin -t -p` prints back to steps. Each transition stands in a line of its
// own in the Promela, so a line number says all: a rendezvous is two of them, a `d_step` is one
// that may be printed several times.

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

using LineKind = PromelaLine::Kind;

// Where a line of the run says that a process moved.
struct Place {
  std::uint64_t move = 0;  // its number in the run: statements of one d_step have the same
  std::size_t line = 0;    // of the text
  bool operator==(const Place&) const = default;
};

// The place in "  7:	proc  3 (name:1) system.pml:N (state 5)	[...]"; nothing for other lines.
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
  return half.kind == LineKind::program_edge &&
         system.programs[half.owner].edges[half.index].kind == ProgramEdge::Kind::choice;
}

Step join_halves(const PromelaLine& first, const PromelaLine& second, const System& system) {
  const bool program_first = first.kind == LineKind::program_edge;
  const PromelaLine& program = program_first ? first : second;
  const PromelaLine& model = program_first ? second : first;
  if (program.kind != LineKind::program_edge || model.kind != LineKind::model_transition ||
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
    if (meaning.kind == LineKind::none) return true;
    if (meaning.kind == LineKind::step) {
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
    const bool is_last =
        step.is_cut || (step.actor != nobody &&
                        system_.programs[step.actor].is_error(edge_of(system_, step).target));
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
