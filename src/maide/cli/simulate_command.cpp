// `maide simulate SYSTEM`: what can happen in a system, step by step. A person chooses what comes
// next, or chance does.
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "maide/base/file.hpp"
#include "maide/base/log.hpp"
#include "maide/base/random.hpp"
#include "maide/base/text.hpp"
#include "maide/check/build/constant_settings.hpp"
#include "maide/check/build/system_file.hpp"
#include "maide/check/system/simulation.hpp"
#include "maide/check/system/trace_file.hpp"
#include "maide/cli/chart_style.hpp"
#include "maide/cli/command.hpp"
#include "maide/cli/command_line.hpp"
#include "maide/cli/line_reader.hpp"
#include "maide/join/learned_models.hpp"
#include "maide/report/simulation_text.hpp"
#include "maide/report/trace_text.hpp"

namespace maide::cli {
namespace {

struct SimulateArguments {
  std::string system;
  std::optional<std::uint64_t> seed, steps;
  std::vector<std::string> settings;
  std::string trace;
  bool is_interactive = false;
  std::size_t jobs = 0;
};

constexpr std::uint64_t default_seed = 1, default_steps = 100;

// The file names no property.
void write_trace_file(const std::string& path, const Simulation& simulation) {
  const Json trace = trace_file_to_json(simulation.system(), "", simulation.trace());
  write_file_atomically(path, to_json_line(trace) + "\n");
}

Tone tone_of(Simulation::End end) {
  switch (end) {
    case Simulation::End::deadlock:
    case Simulation::End::error: return Tone::bad;
    case Simulation::End::cut: return Tone::doubtful;
    case Simulation::End::none:
    case Simulation::End::ended:
    case Simulation::End::at_rest: break;
  }
  return Tone::plain;
}

// ---- at random ----

std::string describe_run(const Simulation& simulation) {
  const ChartTextStyle style = chart_style();
  std::ostringstream text;
  write_run_text(text, simulation.system(), simulation.trace(), TraceFormat::chart, style);
  write_standstill(text, simulation.system(), simulation.states().back());
  return text.str();
}

ExitStatus run_at_random(const SimulateArguments& arguments, Simulation& simulation,
                         Context& context) {
  const std::uint64_t seed = arguments.seed.value_or(default_seed);
  const std::uint64_t most = arguments.steps.value_or(default_steps);
  const RunControl control = context.control();
  Random random(seed);
  while (simulation.trace().steps.size() < most && simulation.end() == Simulation::End::none &&
         !control.should_stop()) {
    simulation.take(draw_step(simulation.next(), random));
  }
  const Simulation::End end = simulation.end();
  const std::string steps = counted(simulation.trace().steps.size(), "step");
  const std::string why = explain_end(simulation);
  context.print(fmt::format("seed {}: {}{}\n", seed, steps,
                            end == Simulation::End::none ? "" : fmt::format(", then {}", why)),
                tone_of(end));
  context.print(describe_run(simulation));
  Json result{{"seed", seed},
              {"end", end == Simulation::End::none ? Json() : Json(to_string(end))}};
  if (!why.empty()) result["explanation"] = why;
  for (const auto& [name, value] : simulation.system().settings) result["set"][name] = value;
  result["trace"] = trace_to_json(simulation.system(), simulation.trace());
  context.set_result(result);
  if (!arguments.trace.empty()) write_trace_file(arguments.trace, simulation);
  return control.should_stop() ? ExitStatus::inconclusive : ExitStatus::ok;
}

// ---- by choice ----

constexpr std::string_view keys =
    "a number (Enter: the only one); b goes back, ? tells who waits and what is held, s FILE saves "
    "the run, q ends\n";

class Session {
 public:
  Session(Simulation& simulation, Context& context)
      : simulation_(simulation), context_(context), is_terminal_(::isatty(STDIN_FILENO) == 1) {}

  void run() {
    context_.print(keys);
    show();
    LineReader lines(STDIN_FILENO);
    for (;;) {
      if (is_terminal_) context_.print("> ");
      const auto line = lines.next(context_.control());
      if (!line) break;
      if (!obey(*line)) return;
    }
    if (is_terminal_) context_.print("\n");
  }

 private:
  // What can come next, or why nothing does.
  void show() {
    const std::string why = explain_end(simulation_);
    if (!why.empty()) context_.print(why + "\n", tone_of(simulation_.end()));
    context_.print(describe_choices(simulation_, chart_style().width));
  }

  // False: it is the end.
  bool obey(const std::string& line) {
    const std::size_t first = line.find_first_not_of(" \t\r");
    const std::string_view word =
        first == std::string::npos
            ? std::string_view()
            : std::string_view(line).substr(first, line.find_last_not_of(" \t\r") - first + 1);
    if (word == "q") return false;
    if (word.empty()) {
      simulation_.next().size() == 1 ? take(0) : show();
    } else if (word == "b" || word == "u") {
      go_back();
    } else if (word == "?") {
      context_.print(describe_situation(simulation_));
    } else if (word == "s" || word.starts_with("s ")) {
      save(std::string(word.substr(1)));
    } else {
      choose(word);
    }
    return true;
  }

  void go_back() {
    if (simulation_.trace().steps.empty()) {
      context_.print("this is the start\n");
      return;
    }
    simulation_.go_back();
    context_.print(fmt::format("back behind step {}\n", simulation_.trace().steps.size()));
    show();
  }

  void save(std::string path) {
    path.erase(0, path.find_first_not_of(" \t"));
    try {
      if (path.empty()) throw UsageError("s needs the name of a file");
      check_output("s", path, {simulation_.system().file});
      write_trace_file(path, simulation_);
      context_.print(
          fmt::format("{}: {}\n", path, counted(simulation_.trace().steps.size(), "step")));
    } catch (const Error& error) {
      context_.complain(error.what());
    }
  }

  void choose(std::string_view word) {
    std::size_t number = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
    const std::size_t count = simulation_.next().size();
    if (error != std::errc() || end != word.data() + word.size()) {
      context_.print(fmt::format("'{}' is none of: {}", word, keys));
      return;
    }
    if (number < 1 || number > count) {
      context_.print(count == 0 ? "nothing can come next\n"
                                : fmt::format("{} is no step: they are 1 to {}\n", number, count));
      return;
    }
    take(number - 1);
  }

  void take(std::size_t index) {
    simulation_.take(index);
    context_.print(describe_last_step(simulation_) + "\n");
    show();
  }

  Simulation& simulation_;
  Context& context_;
  bool is_terminal_;
};

ExitStatus run_simulate(const SimulateArguments& arguments, Context& context) {
  const bool is_random = arguments.seed || arguments.steps;
  if (arguments.is_interactive && (is_random || context.json())) {
    throw UsageError(
        fmt::format("--interactive and {} exclude each other", context.json()   ? "--json"
                                                               : arguments.seed ? "--seed"
                                                                                : "--steps"));
  }
  check_output("--trace", arguments.trace, {arguments.system});
  const System system = read_system(
      arguments.system,
      make_learning_source(
          {{}, [](const std::string& line) { log_note(line); }, context.control(), arguments.jobs}),
      context.control(), parse_settings(arguments.settings));
  const bool has_picks = std::ranges::any_of(
      system.executors, [](const ExecutorInstance& executor) { return !executor.goes_by_rounds; });
  if (has_picks) {
    log_note(
        "callbacks start in any order, as in a check; which of them rclcpp picks is not followed");
  }
  Simulation simulation(system);
  const bool is_at_terminal = ::isatty(STDIN_FILENO) == 1 && ::isatty(STDOUT_FILENO) == 1 &&
                              !context.json() && !context.embedded();
  if (!arguments.is_interactive && (is_random || !is_at_terminal)) {
    return run_at_random(arguments, simulation, context);
  }
  Session(simulation, context).run();
  if (!arguments.trace.empty()) write_trace_file(arguments.trace, simulation);
  return ExitStatus::ok;
}

}  // namespace

RunFunction set_up_simulate(CommandLine& line) {
  auto arguments = std::make_shared<SimulateArguments>();
  line.add("SYSTEM", arguments->system, "A system file (YAML): models, programs, properties")
      .required();
  line.add("--seed", arguments->seed,
           "Let chance choose, with this seed. The same seed gives the same run. Default, where "
           "there is no terminal: 1")
      .no_default()
      .value_name("N");
  line.add("--steps", arguments->steps,
           "Let chance choose, at most so many steps. Default, where there is no terminal: 100")
      .no_default()
      .between(1, 1'000'000)
      .value_name("N");
  line.add("--trace", arguments->trace,
           "Write the run to this file (JSON). `maide replay` and `maide view` read it")
      .value_name("FILE");
  line.add_flag("--interactive", arguments->is_interactive,
                "Read what is chosen from standard input where that is no terminal, too");
  add_set_option(line, arguments->settings);
  add_jobs_option(line, arguments->jobs);
  return [arguments](Context& context) { return run_simulate(*arguments, context); };
}

}  // namespace maide::cli
