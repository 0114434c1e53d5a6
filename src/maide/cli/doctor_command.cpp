// `maide doctor`: which programs and wrappers are on this machine, in which version, and what to
// install for those that are not. The main job - learn a connection of a running system, check
// programs against it - needs a wrapper; the programs are extras. `maide doctor ros2` is in
// ros2_command.cpp.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <memory>
#include <nlohmann/json.hpp>
#include <own_wrappers.hpp>  // made by the build
#include <string>
#include <string_view>
#include <vector>

#include "maide/base/error.hpp"
#include "maide/base/subprocess.hpp"
#include "maide/base/version.hpp"
#include "maide/cli/command.hpp"
#include "maide/cli/command_line.hpp"
#include "maide/cli/mpi.hpp"
#include "maide/experiment/open_system.hpp"
#include "maide/wire/observe/kernel_support.hpp"

namespace maide::cli {

namespace {

struct Tool {
  std::string name;
  std::string purpose;
  std::vector<std::string> version_command;
  std::string advice;      // where it is not there
  int version_status = 0;  // with which that command may exit, besides 0
};

const std::vector<Tool>& tools() {
  static const std::vector<Tool> table{
      {"spin",
       "checks systems, too (maide check --engine spin)",
       {"spin", "-V"},
       "apt-get install spin"},
      {"cppcheck",
       "reads C++ for maide extract",
       {"cppcheck", "--version"},
       "apt-get install cppcheck (2.10)"},
      {"cc", "compiles what spin generates", {"cc", "--version"}, "apt-get install gcc"},
      {"pins2lts-mc",
       "checks systems with all cores (maide check --engine ltsmin)",
       {"pins2lts-mc", "--version"},
       "build LTSmin: github.com/utwente-fmt/ltsmin",
       255},
      {"c++", "compiles what ltsmin explores", {"c++", "--version"}, "apt-get install g++"},
      {"dot", "draws models", {"dot", "-V"}, "apt-get install graphviz"},
      {"mpirun",
       "checks systems on many processors and machines (mpirun -n 4 maide check)",
       {"mpirun", "--version"},
       std::string(mpi_advice)},
      {"python3",
       "runs wrappers written in Python",
       {"python3", "--version"},
       "apt-get install python3"},
  };
  return table;
}

struct Middleware {
  std::string name, title;
  std::string advice;  // what there is to do where its wrapper is not there
};

enum class State : std::uint8_t { usable, missing, broken };

std::string_view to_string(State state) {
  switch (state) {
    case State::usable: return "usable";
    case State::missing: return "missing";
    case State::broken: return "broken";
  }
  return "";
}

// One line of the report.
struct Finding {
  std::string kind;  // "program", "kernel", "wrapper"
  std::string name;
  std::string description;
  State state = State::missing;
  std::string version{};  // the program's own words, or what the kernel gave; one line
  std::string path{};
  std::string advice{};  // what to do; "" if nothing
};

std::string first_line(const std::string& text) {
  return text.substr(0, std::min(text.find('\n'), text.size()));
}

SubprocessResult ask(const std::vector<std::string>& command, const RunControl& control) {
  SubprocessOptions options;
  options.time_limit = std::chrono::seconds(30);
  options.output_limit = 65536;
  return run_program(command, options, control);
}

Finding examine(const Tool& tool, const RunControl& control) {
  Finding finding{"program", tool.name, tool.purpose};
  const auto path = find_on_path(tool.name);
  if (!path) {
    finding.advice = tool.advice;
    return finding;
  }
  finding.path = path->string();
  const SubprocessResult result = ask(tool.version_command, control);
  // dot prints its version on standard error.
  finding.version = first_line(result.out.empty() ? result.err : result.out);
  const bool is_well = result.succeeded() || result.exit_status == tool.version_status;
  finding.state = is_well ? State::usable : State::broken;
  if (!is_well) {
    finding.advice = fmt::format("'{}' {}", fmt::join(tool.version_command, " "),
                                 result.timed_out ? "does not end" : "fails");
  } else if (tool.name == "mpirun" && !find_mpi_module()) {
    finding.state = State::broken;
    finding.advice = fmt::format("maide has no module for it: {}", mpi_advice);
  }
  return finding;
}

Finding examine(const KernelFeature& feature) {
  Finding finding{"kernel", std::string(feature.name), std::string(feature.purpose)};
  finding.state = feature.is_usable ? State::usable : State::missing;
  if (feature.is_usable) {
    finding.version = feature.detail;
  } else {
    finding.advice = fmt::format("{}; {}", feature.detail, feature.without);
  }
  return finding;
}

// The wrapper tries itself: `--self-test` exits 0 and says in one line what it found, or says what
// is wrong.
Finding examine(const Middleware& middleware, const RunControl& control) {
  Finding finding{"wrapper", middleware.name, middleware.title};
  const auto path = find_wrapper(middleware.name);
  if (!path) {
    finding.advice = middleware.advice;
    return finding;
  }
  finding.path = path->string();
  const SubprocessResult result = ask({finding.path, "--self-test"}, control);
  if (result.succeeded()) {
    finding.state = State::usable;
    finding.version = first_line(result.out);
  } else {
    finding.state = State::broken;
    const std::string reason = first_line(result.err.empty() ? result.out : result.err);
    finding.advice = result.timed_out ? "its self-test does not end"
                     : reason.empty()
                         ? fmt::format("its self-test ends with {}", result.exit_status)
                         : reason;
  }
  return finding;
}

std::vector<Finding> examine_all(const RunControl& control) {
  std::vector<Finding> findings;
  for (const Tool& tool : tools()) {
    control.check("the examination");
    findings.push_back(examine(tool, control));
  }
  for (const KernelFeature& feature : examine_kernel()) findings.push_back(examine(feature));
  std::vector<Middleware> all;
  for (const auto& [name, title, advice] : own_wrappers) {
    all.push_back({std::string(name), std::string(title), std::string(advice)});
  }
  for (const std::string& name : list_wrappers()) {
    const bool known =
        std::ranges::any_of(all, [&](const Middleware& entry) { return entry.name == name; });
    if (!known) all.push_back({name, "a wrapper that does not come with maide", ""});
  }
  for (const Middleware& middleware : all) {
    control.check("the examination");
    findings.push_back(examine(middleware, control));
  }
  return findings;
}

bool is_usable(const Finding& finding) { return finding.state == State::usable; }

// The main job needs one wrapper.
bool can_run_main_job(const std::vector<Finding>& findings) {
  return std::ranges::any_of(findings, [](const Finding& finding) {
    return finding.kind == "wrapper" && is_usable(finding);
  });
}

std::string as_text(const std::vector<Finding>& findings, bool usable) {
  std::string text = fmt::format("Maide {}\n", version());
  std::string kind;
  for (const Finding& finding : findings) {
    if (finding.kind != kind) {
      kind = finding.kind;
      text += kind == "program"  ? "\nPrograms\n"
              : kind == "kernel" ? "\nWhat the kernel shows to observations\n"
                                 : "\nMiddleware\n";
    }
    text +=
        fmt::format("  {:<12} {:<8} {}\n", finding.name, to_string(finding.state),
                    is_usable(finding) && kind != "kernel" ? finding.version : finding.description);
    if (!finding.advice.empty()) text += fmt::format("  {:<12} {:<8} {}\n", "", "", finding.advice);
  }
  return text + (usable ? "\nReady: systems can be learned and checked.\n"
                        : "\nNot ready: there is no wrapper to learn through.\n");
}

Json as_json(const std::vector<Finding>& findings, bool usable) {
  Json list = Json::array();
  for (const Finding& finding : findings) {
    list.push_back({{"kind", finding.kind},
                    {"name", finding.name},
                    {"state", to_string(finding.state)},
                    {"version", finding.version},
                    {"path", finding.path},
                    {"advice", finding.advice}});
  }
  return {{"ready", usable}, {"maide", version()}, {"findings", list}};
}

ExitStatus run_doctor(Context& context) {
  const std::vector<Finding> findings = examine_all(context.control());
  const bool usable = can_run_main_job(findings);
  context.print(as_text(findings, usable));
  context.set_result(as_json(findings, usable));
  return usable ? ExitStatus::ok : ExitStatus::usage;
}

}  // namespace

RunFunction set_up_doctor(CommandLine& line) {
  struct Arguments {
    std::string middleware, file;
    double settle = ros2_settle_seconds;
  };
  auto arguments = std::make_shared<Arguments>();
  line.add("MIDDLEWARE", arguments->middleware,
           "ros2: look at a graph of ROS 2, not at this machine: which ends never match, what can "
           "be lost in which bursts, what late joiners get. Exit status 1: ends do not match")
      .one_of({"ros2"})
      .no_default();
  line.add("FILE", arguments->file,
           "A system file, or what `maide ros2 import --json` printed (default: the running graph)")
      .no_default();
  add_settle_option(line, arguments->settle);
  return [arguments](Context& context) {
    if (arguments->middleware.empty()) return run_doctor(context);
    return run_ros2_doctor(arguments->file, arguments->settle, context);
  };
}

}  // namespace maide::cli
