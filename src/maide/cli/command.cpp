// Standard output is checked after each piece: a result that did not arrive is no result.
#include "maide/cli/command.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "maide/base/file.hpp"
#include "maide/base/text.hpp"

namespace maide::cli {

void write_to_stdout(std::string_view text) {
  clear_progress_line();
  errno = 0;
  const bool written = std::fwrite(text.data(), 1, text.size(), stdout) == text.size();
  if (!written || std::fflush(stdout) != 0) {
    const int error = errno != 0 ? errno : EIO;
    throw_write_failure(
        "cannot write the result: " + std::generic_category().message(error) + " (standard output)",
        error);
  }
}

void write_error_line(std::string_view message) {
  clear_progress_line();
  const std::string line = paint("maide:", Tone::bad, STDERR_FILENO) + " " + one_line(message);
  std::fputs((line + '\n').c_str(), stderr);
}

void check_output(std::string_view option, const std::string& path,
                  std::initializer_list<std::string> used) {
  if (path.empty()) return;
  for (const std::string& other : used) {
    if (!other.empty() && is_same_file(path, other)) {
      throw UsageError(fmt::format("{} would write over a file that is used ({})", option, other));
    }
  }
  check_can_write(path);
}

void write_data(std::string_view text) {
  if (::isatty(STDOUT_FILENO) == 1) {
    write_to_stdout(printable(text));
  } else {
    write_to_stdout(text);
  }
}

Context::Context(const CommonOptions& options, std::stop_token stop)
    : options_(options), stop_(std::move(stop)), progress_(!options.quiet && !options.json) {}

RunControl Context::control() {
  RunControl control;
  control.stop = stop_;
  control.progress = options_.embedded ? options_.progress : &progress_;
  return control;
}

void Context::print(std::string_view text, Tone tone) {
  if (options_.json) return;
  const auto width = terminal_width(STDOUT_FILENO);
  write_to_stdout(paint(width ? wrap_lines(text, *width) : std::string(text), tone, STDOUT_FILENO));
}

void Context::print_data(std::string_view text) {
  if (!options_.json) write_data(text);
}

void Context::set_result(const Json& object) {
  if (result_) throw std::logic_error("a command has one result");
  Json result{{"schema", json_schema}};
  result.update(object);
  result_ = to_json_line(result);
}

void Context::complain(std::string_view message, std::string_view excerpt) {
  if (options_.embedded) return;
  write_error_line(message);
  std::fputs(printable(excerpt).c_str(), stderr);
}

ExitStatus Context::fail(const std::string& message, ExitStatus status, std::string_view excerpt) {
  complain(message, excerpt);
  failure_ = message;
  return status;
}

std::string Context::take_result(ExitStatus status) {
  if (!result_) set_result(Json::object());
  const bool is_stopped = stop_.stop_requested() && status == ExitStatus::inconclusive;
  if (failure_.empty() && is_stopped) failure_ = "interrupted";
  if (!failure_.empty()) {
    Json result = parse_json(*result_, "--json");
    result["error"] = failure_;
    result["status"] = static_cast<int>(status);
    result_ = to_json_line(result);
  }
  return *std::move(result_);
}

void Context::finish(ExitStatus status) {
  if (options_.json && !has_no_result_) write_data(take_result(status) + "\n");
}

// The commands, in the order in which a newcomer meets them.
std::span<const Command> command_table() {
  static constexpr std::array table{
      Command{"learn", "Learn a model of a running system",
              "maide learn port kind=strict size=3 -o strict-3.dot\n"
              "maide learn cyclonedds history=keep_last depth=1 inputs=write,read -o via.dot\n"
              "maide learn port --launch 'ssh {host} {wrapper}' --hosts hosts.txt -o port.dot\n"
              "maide learn sim:strict-3.dot --eq perfect | dot -Tsvg > strict-3.svg",
              set_up_learn},
      Command{"check", "Tell whether programs that use learned models deadlock or break a property",
              "maide check examples/case-study-1/buffered.yaml\n"
              "maide check system.yaml --property deadlock --trace deadlock.json --json\n"
              "maide check system.yaml --refine",
              set_up_check},
      Command{"simulate", "Step through a system: what can come next, forward and back",
              "maide simulate system.yaml\n"
              "maide simulate system.yaml --seed 7 --steps 50 --trace run.json",
              set_up_simulate},
      Command{"replay", "Tell whether the real middleware does what a counterexample says",
              "maide replay system.yaml deadlock.json --rounds 20\n"
              "maide replay system.yaml --random 100 --seed 7",
              set_up_replay},
      Command{"compare", "Tell whether two models are the same, and what tells them apart",
              "maide compare port.dot strict-1.dot\nmaide compare old.dot new.dot --json\n"
              "maide compare strict-3.dot port kind=strict size=3",
              set_up_compare},
      Command{"test", "Tell whether a running system does what a model says",
              "maide test strict-3.dot\n"
              "maide test via.dot cyclonedds history=keep_last depth=1 --junit via.xml\n"
              "maide test strict-3.dot --time 60 --json",
              set_up_test},
      Command{"export", "Write a model or a system in another tool's language",
              "maide export port.dot --to promela -o port.pml\n"
              "maide export strict-6.dot --to aut --lossy\n"
              "maide export strict-6.dot --to tikz -o strict-6.tex\n"
              "maide export system.yaml --to promela -o system.pml\n"
              "maide export system.yaml --to aut -o system.aut\n"
              "maide export system.yaml --property acknowledged --to hoa",
              set_up_export},
      Command{"format", "Lay out system files in one style",
              "maide format system.yaml\nmaide format --check systems/*.yaml", set_up_format},
      Command{"view", "Draw a model, a system or a trace",
              "maide view strict-6.dot\nmaide view system.yaml -o system.html\n"
              "maide view deadlock.json -o deadlock.svg",
              set_up_view},
      Command{"reproduce", "Reproduce the paper's results, theirs beside ours",
              "maide reproduce table1 --system port --json\nmaide reproduce table2",
              set_up_reproduce},
      Command{"cache", "Show, merge and check the answers that learning has kept on disk",
              "maide cache show port.cache\n"
              "maide cache merge monday.cache tuesday.cache -o all.cache\n"
              "maide cache check port.cache --system 'port kind=strict'",
              set_up_cache},
      Command{"bench", "Measure the learning algorithms on a folder of models",
              "maide bench models --algorithm lsharp --algorithm rs --csv bench.csv\n"
              "maide bench models --eq standard --time 10 --json",
              set_up_bench},
      Command{"init", "Write a first system file, for the middleware that is installed",
              "maide init\nmaide init robot.yaml --system cyclonedds", set_up_init},
      Command{"new", "Write a wrapper that runs at once, for a server of your own",
              "maide new wrapper --tcp 127.0.0.1:6379 --input 'SET a 1' \\\n"
              "    --input 'GET a' --reset FLUSHALL -o redis.py\n"
              "maide new wrapper --tcp 127.0.0.1:21 --input 'user=USER anonymous' \\\n"
              "    --input 'pass=PASS x' --cpp -o ftp.cpp",
              set_up_new},
      Command{"extract", "Write a system file from C++ sources of ROS 2 nodes",
              "maide extract src/robot.cpp -o robot.yaml\n"
              "maide extract src --assume ok,exceptions,read -o robot.yaml",
              set_up_extract},
      Command{"ros2", "Write a system file of a running graph of ROS 2",
              "maide ros2 import -o robot.yaml\n"
              "maide ros2 import --json > graph.json\n"
              "maide ros2 import --graph graph.json -o robot.yaml",
              set_up_ros2},
      Command{"completion", "Write what lets a shell complete command lines of maide",
              "maide completion bash > ~/.local/share/bash-completion/completions/maide\n"
              "maide completion fish > ~/.config/fish/completions/maide.fish",
              set_up_completion},
      Command{"manual", "Write manual pages, for man",
              "maide manual check | man -l -\nmaide manual --all -o share/man/man1", set_up_manual},
      Command{"doctor", "Tell what is usable on this machine, or what a graph of ROS 2 loses",
              "maide doctor\nmaide doctor --json\nmaide doctor ros2 robot.yaml", set_up_doctor},
  };
  return table;
}

}  // namespace maide::cli
