#include "maide/check/engines/ltsmin_engine.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cstdlib>
#include <sstream>
#include <stdexcept>
#include <string_view>
#include <utility>
#include <vector>

#include "maide/base/error.hpp"
#include "maide/base/text.hpp"
#include "maide/check/engines/engine_folder.hpp"
#include "maide/check/engines/export/step_rules.hpp"
#include "maide/check/engines/export/system_exporters.hpp"

namespace maide {
namespace {

using Clock = std::chrono::steady_clock;

// The label of the one property that is checked.
constexpr const char* property_name = "property";

// Its table has eight bytes a place, and a quarter more beside: the largest that fits.
unsigned table_bits(std::uint64_t memory_mib) {
  constexpr unsigned least = 16, most = 34;
  unsigned bits = least;
  while (bits < most && (std::uint64_t{10} << (bits + 1)) <= memory_mib << 20) ++bits;
  return bits;
}

// One search: a temporary folder in which the system's plug-in is made and explored.
class Exploration {
 public:
  Exploration(const LtsminOptions& tools, const EngineOptions& options, const System& system,
              std::vector<std::string> goal, const std::vector<Property>& properties)
      : tools_(tools),
        options_(options),
        system_(system),
        goal_(std::move(goal)),
        folder_("ltsmin", options.control) {
    std::ostringstream text;
    write_pins(text, system, properties);
    write_file_atomically(folder_.path() / "system.cpp", text.str());
    // In two steps and through pipes: a compiler that is killed leaves no file elsewhere.
    folder_.run_tool({tools_.compiler, "-std=c++17", "-O2", "-w", "-pipe", "-fPIC", "-c", "-o",
                      "system.o", "system.cpp"},
                     "a C++ compiler", "system.o");
    folder_.run_tool({tools_.compiler, "-shared", "-o", "system.so", "system.o"}, "a C++ compiler",
                     "system.so");
  }

  LtsminOutput search() {
    const auto start = Clock::now();
    LtsminOutput output = explore(thread_count(options_), {});
    seconds_ = std::chrono::duration<double>(Clock::now() - start).count();
    return output;
  }

  Trace find_trace() {
    const LtsminOutput output = explore(1, {"--trace=run.gcf", "--write-state"});
    if (!output.is_violated) {
      throw std::logic_error("ltsmin does not find the violation that it found before");
    }
    folder_.run_tool({tools_.printer, "run.gcf", "run.csv"}, tools_.printer, "run.csv");
    return read_ltsmin_run(read_file(folder_.path() / "run.csv"), system_);
  }

  double seconds() const { return seconds_; }

  std::string why_incomplete(const LtsminOutput& output) const {
    if (output.is_table_full) {
      return fmt::format("the search needs more than {} MiB of memory", memory_limit_mib(options_));
    }
    return "LTSmin did not complete the search" + (output.error.empty() ? "" : ": " + output.error);
  }

 private:
  LtsminOutput explore(unsigned threads, const std::vector<std::string>& further) {
    std::vector<std::string> command{tools_.explorer, "--strategy=bfs",
                                     fmt::format("--procs={}", threads),
                                     fmt::format("-s{}", table_bits(memory_limit_mib(options_)))};
    command.insert(command.end(), goal_.begin(), goal_.end());
    command.insert(command.end(), further.begin(), further.end());
    command.emplace_back("./system.so");
    return read_ltsmin_output(folder_.start_tool(command, tools_.explorer));
  }

  const LtsminOptions& tools_;
  const EngineOptions& options_;
  const System& system_;
  std::vector<std::string> goal_;
  EngineFolder folder_;
  double seconds_ = 0;
};

std::vector<std::string> goal_of(const System& system, const Property& property) {
  switch (property.kind) {
    case Property::Kind::error: return {"--invariant=!error"};
    case Property::Kind::deadlock:
      // Where programs can only die LTSmin sees transitions.
      if (has_idle_steps(system)) return {"--invariant=!deadlock"};
      return {"--deadlock"};
    default: return {fmt::format("--invariant=always_{}", property_name)};
  }
}

// The number behind `mark`; 0 without one.
double number_behind(std::string_view text, std::string_view mark) {
  const std::size_t at = text.find(mark);
  if (at == std::string_view::npos) return 0;
  return std::strtod(std::string(text.substr(at + mark.size(), 32)).c_str(), nullptr);
}

}  // namespace

LtsminOutput read_ltsmin_output(const SubprocessResult& result) {
  LtsminOutput output;
  const std::string text = result.out + result.err;
  bool has_counts = false, has_found = false;
  for (const std::string_view line : split(text, '\n')) {
    const std::size_t explored = line.find(": Explored ");
    if (explored != std::string_view::npos) {
      std::istringstream counts{std::string(line.substr(explored + 11))};
      std::string word;
      has_counts = static_cast<bool>(counts >> output.states >> word >> output.transitions);
    }
    const bool is_error = line.find("** error **") != std::string_view::npos ||
                          line.find(": Error") != std::string_view::npos;
    if (is_error && output.error.empty()) output.error = line;
    has_found = has_found || line.find("Deadlock found") != std::string_view::npos ||
                line.find("Invariant violation") != std::string_view::npos;
    output.is_table_full =
        output.is_table_full || line.find("table full!") != std::string_view::npos;
  }
  output.peak_bytes =
      static_cast<std::uint64_t>(number_behind(text, "Est. total memory use: ") * 1024 * 1024);
  constexpr int found_status = 1;
  output.is_violated = has_found && result.exit_status == found_status;
  output.is_complete = has_counts && result.exit_status == 0 && output.error.empty() &&
                       !output.is_table_full && !has_found;
  return output;
}

Trace read_ltsmin_run(const std::string& text, const System& system) {
  Trace trace;
  GlobalState state = initial_state(system);
  // Behind the programs is nobody's slot, if he has actions.
  const std::size_t actors = actor_count(system);
  const std::size_t slots = actors + state.models.size();
  bool is_first = true;
  std::istringstream lines(text);
  std::string line;
  std::getline(lines, line);  // the columns' names
  while (std::getline(lines, line)) {
    GlobalState next = state;
    const char* at = line.data();
    const char* const end = line.data() + line.size();
    for (std::size_t slot = 0; slot < slots; ++slot) {
      std::uint32_t nobodys = 0;
      std::uint32_t& value = slot >= actors                ? next.models[slot - actors]
                             : slot < next.programs.size() ? next.programs[slot]
                                                           : nobodys;
      const auto [rest, error] = std::from_chars(at, end, value);
      if (error != std::errc() || rest == end || *rest != ',') {
        throw std::logic_error("ltsmin's run has a line that is no state: " + line.substr(0, 80));
      }
      at = rest + 1;
    }
    if (std::exchange(is_first, false)) {
      if (next != state)
        throw std::logic_error("ltsmin's run does not begin where the system does");
      continue;
    }
    const std::vector<Step> steps = enabled_steps(system, state);
    const auto step = std::ranges::find_if(
        steps, [&](const Step& candidate) { return apply(system, state, candidate) == next; });
    if (step == steps.end()) {
      throw std::logic_error("ltsmin's run shows a step that is not possible");
    }
    trace.steps.push_back(*step);
    state = std::move(next);
  }
  if (is_first) throw std::logic_error("ltsmin's run is empty");
  return trace;
}

std::string LtsminEngine::obstacle(const System& system, const Property& property) const {
  using Kind = Property::Kind;
  if (property.kind == Kind::stuck) {
    return "the engine ltsmin does not check 'stuck' (--engine native does)";
  }
  if (property.kind == Kind::never) {
    return "the engine ltsmin checks no automaton (--engine native does)";
  }
  if (property.kind != Kind::ltl) return "";
  if (property.is_always_possible) {
    return "the engine ltsmin does not check what is always possible (--engine native does)";
  }
  const std::string why = why_no_label(system, property);
  if (why.empty()) return "";
  return fmt::format(
      "the engine ltsmin checks `always` of states alone, and this {} (--engine native checks it)",
      why);
}

PropertyResult LtsminEngine::check(const System& system, const Property& property,
                                   const EngineOptions& options) {
  PropertyResult result;
  result.name = property.name;
  try {
    std::vector<Property> labels;
    if (property.kind == Property::Kind::ltl) {
      labels.push_back(property);
      labels.back().name = property_name;
    }
    Exploration exploration(options_, options, system, goal_of(system, property), labels);
    const LtsminOutput output = exploration.search();
    result.states = output.states;
    result.transitions = output.transitions;
    result.peak_bytes = output.peak_bytes;
    result.seconds = exploration.seconds();
    if (!output.is_violated) {
      result.verdict = output.is_complete ? Verdict::holds : Verdict::inconclusive;
      if (!output.is_complete) result.reason = exploration.why_incomplete(output);
      return result;
    }
    Trace trace = exploration.find_trace();
    require_sound(name(), system, property, trace);
    result.verdict = Verdict::violated;
    result.trace = std::move(trace);
  } catch (const Interrupted&) {
    result.verdict = Verdict::inconclusive;
    result.reason = why_stopped(options);
  }
  return result;
}

CutResult LtsminEngine::find_cut(const System& system, const EngineOptions& options) {
  CutResult result;
  if (!StepRules(system).may_cut()) {
    result.verdict = Verdict::holds;
    return result;
  }
  try {
    Exploration exploration(options_, options, system, {"--invariant=!beyond"}, {});
    const LtsminOutput output = exploration.search();
    if (!output.is_violated) {
      result.verdict = output.is_complete ? Verdict::holds : Verdict::inconclusive;
      if (!output.is_complete) result.reason = exploration.why_incomplete(output);
      return result;
    }
    Trace trace = exploration.find_trace();
    // The run ends before the step that is cut.
    const std::vector<Step> steps = enabled_steps(system, replay(system, trace).back());
    const auto cut = std::ranges::find_if(steps, &Step::is_cut);
    if (cut == steps.end()) throw std::logic_error("ltsmin's run to the bound does not replay");
    trace.steps.push_back(*cut);
    result.verdict = Verdict::violated;
    result.trace = std::move(trace);
  } catch (const Interrupted&) {
    result.reason = why_stopped(options);
  }
  return result;
}

}  // namespace maide
