// Our engine against SPIN on the Promela of the same systems, on one core, each run in a process of
// its own, with counterexamples on: processor time, peak of resident memory, states. Of SPIN's
// lossless modes - depth-first: its breadth-first search loses deadlocks - the fastest and the
// smallest count, each with a depth and a hash table that suit the system, and compiling is free:
// for the Promela that `maide export` writes, and for one by hand that is as fast as we can make
// it. Of coupled robots, the Promela by hand is the one that somebody would write who never heard
// of models, and our engine takes a read and its message for one step, as that does.
//
//   bench_check [--rounds N] [--only KIND] [--csv FILE] [--write FOLDER] [SYSTEM ...]
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <regex>
#include <sstream>

#include "check_systems.hpp"
#include "flat_promela.hpp"
#include "maide/base/error.hpp"
#include "maide/base/file.hpp"
#include "maide/base/json.hpp"
#include "maide/base/subprocess.hpp"
#include "maide/check/build/system_file.hpp"
#include "maide/check/engines/export/promela_system.hpp"
#include "maide/check/engines/spin_engine.hpp"
#include "maide/check/verdict/check_system.hpp"
#include "measured_run.hpp"

namespace maide::bench {
namespace {

namespace fs = std::filesystem;

constexpr unsigned most_seconds = 3600;  // of the processor, for one run

enum class Kind : std::uint8_t { unreduced, calls, reduced, ltl };
const std::vector<std::pair<std::string, Kind>> kinds{{"unreduced", Kind::unreduced},
                                                      {"calls", Kind::calls},
                                                      {"reduced", Kind::reduced},
                                                      {"ltl", Kind::ltl}};

std::string name_of(Kind kind) { return kinds[static_cast<std::size_t>(kind)].first; }

// A system with Promela of its own is compared with that alone.
bool is_for(Kind kind, const SystemText& text) {
  if (kind == Kind::reduced) return true;
  return (kind == Kind::calls) == !text.promela.empty();
}

// What one run cost and saw.
struct Cost {
  double seconds = 0;
  std::uint64_t peak_bytes = 0;
  std::uint64_t states = 0;
};

struct SpinMode {
  std::string name;
  std::vector<std::string> definitions;
  int table = 0;         // binary logarithm of the hash table's slots, above that of the states
  bool is_flat = false;  // not as exported, but with models as shared variables
};

// -O3 gains nothing over -O2, and compiles for minutes.
std::vector<SpinMode> modes() {
  return {{"default", {"-O2"}, 1},
          {"sfh", {"-O2", "-DSFH", "-DNOFAIR"}, 1},
          {"collapse", {"-O2", "-DCOLLAPSE"}, -2},
          {"flat", {"-O2"}, 1, true},
          {"flat sfh", {"-O2", "-DSFH", "-DNOFAIR"}, 1, true},
          {"flat small", {"-O2"}, -2, true},
          {"flat collapse", {"-O2", "-DCOLLAPSE"}, -2, true}};
}

class Comparison {
 public:
  Comparison(const SystemText& text, Kind kind, const fs::path& folder, fs::path maide)
      : kind_(kind), folder_(folder / text.name), maide_(std::move(maide)), promela_(text.promela) {
    file_ = write_system(text, folder_);
  }

  Cost run_native() const {
    const std::string property = kind_ == Kind::ltl ? "response" : "deadlock";
    const std::string reduction = kind_ == Kind::reduced ? "full"
                                  : kind_ == Kind::calls ? "calls"
                                                         : "none";
    const MeasuredRun run =
        run_measured({maide_, "check", file_, "--engine", "native", "--property", property,
                      "--reduction", reduction, "--threads", "1", "--json"},
                     folder_, most_seconds);
    if (run.exit_status != 0) fail("maide", run);
    const Json report = Json::parse(run.output);
    return {run.seconds, run.peak_bytes, report.at("properties").at(0).at("states")};
  }

  // Compiles the verifier in that mode, and finds out how deep it goes.
  void prepare(const SpinMode& mode) {
    std::vector<std::string> command{"gcc", "-w",           "-DMEMLIM=20000",
                                     "-o",  verifier(mode), generate(mode)};
    command.insert(command.end(), mode.definitions.begin(), mode.definitions.end());
    if (kind_ != Kind::ltl) command.emplace_back("-DSAFETY");
    if (kind_ != Kind::reduced) command.emplace_back("-DNOREDUCE");
    SubprocessOptions options;
    options.folder = folder_;
    const SubprocessResult compiled = run_program(command, options);
    if (!compiled.succeeded()) throw UsageError("pan does not compile: " + compiled.err);
    std::uint64_t& depth = depths_[mode.name];
    for (depth = 100'000; run_spin(mode).second;) depth *= 10;
  }

  // And whether the depth was too small.
  std::pair<Cost, bool> run_spin(const SpinMode& mode) {
    std::uint64_t& depth = depths_.at(mode.name);
    const int bits =
        std::max(16, static_cast<int>(std::ceil(std::log2(double(states_)))) + mode.table);
    std::vector<std::string> command{"./" + verifier(mode), "-n", fmt::format("-m{}", depth),
                                     fmt::format("-w{}", bits)};
    if (kind_ == Kind::ltl) command.insert(command.end(), {"-a", "-E"});
    const MeasuredRun run = run_measured(command, folder_, most_seconds);
    const auto output = parse_pan_output(run.output);
    if (!output || output->errors > 0) fail("pan", run);
    states_ = std::max(states_, output->states);
    const Cost cost{run.seconds, run.peak_bytes, output->states};
    if (output->is_depth_truncated) return {cost, true};
    std::smatch match;
    const std::regex reached("depth reached (\\d+)");
    if (!output->is_complete || !std::regex_search(run.output, match, reached)) fail("pan", run);
    depth = std::stoull(match[1]) + 100;
    return {cost, false};
  }

 private:
  static std::string verifier(const SpinMode& mode) {
    std::string name = "pan-" + mode.name;
    std::replace(name.begin(), name.end(), ' ', '-');
    return name;
  }

  [[noreturn]] static void fail(const std::string& program, const MeasuredRun& run) {
    throw UsageError(
        fmt::format("{} ended with {}: {}", program, run.exit_status, run.output.substr(0, 500)));
  }

  // The verifier's source.
  std::string generate(const SpinMode& mode) const {
    const std::string text = promela_.empty() ? generated_promela(mode) : promela_;
    write_file_atomically(folder_ / "system.pml", text);
    SubprocessOptions spin;
    spin.folder = folder_;
    const SubprocessResult generated = run_program({"spin", "-a", "system.pml"}, spin);
    if (!generated.succeeded()) throw UsageError("spin failed: " + generated.out);
    return "pan.c";
  }

  std::string generated_promela(const SpinMode& mode) const {
    const System system = read_system(file_);
    PromelaOptions options;
    if (kind_ == Kind::ltl) {
      options.purpose = PromelaOptions::Purpose::ltl;
      options.formula = find_property(system, "response").formula;
    }
    const PromelaSystem promela = write_promela(system, options);
    std::string text = promela.text;
    if (mode.is_flat) {
      text = write_flat_promela(system);
      std::istringstream lines(promela.text);
      for (std::string line; std::getline(lines, line);) {
        if (line.starts_with("#define ")) text += line + "\n";  // the formula's atoms
      }
    }
    if (kind_ == Kind::ltl) text += "ltl response { !(" + promela.claim + ") }\n";
    return text;
  }

  Kind kind_;
  fs::path folder_, maide_, file_;
  std::string promela_;                          // by hand
  std::map<std::string, std::uint64_t> depths_;  // of pan's search, by mode
  std::uint64_t states_ = 1 << 16;               // for the size of its table
};

Cost median(std::vector<Cost> costs) {
  std::sort(costs.begin(), costs.end(),
            [](const Cost& a, const Cost& b) { return a.seconds < b.seconds; });
  return costs[costs.size() / 2];
}

// SPIN's best on one text of a system.
struct Best {
  std::optional<SpinMode> fastest, smallest;
  Cost fast, small;

  void add(const SpinMode& mode, const Cost& cost) {
    if (!fastest || cost.seconds < fast.seconds) {
      fastest = mode;
      fast = cost;
    }
    if (!smallest || cost.peak_bytes < small.peak_bytes) {
      smallest = mode;
      small = cost;
    }
  }
};

struct Row {
  std::string system;
  Kind kind = Kind::unreduced;
  Cost ours;
  Best exported, flat;  // of `exported` nothing, where there is other Promela by hand
};

// Of the exported text pan stores the state before the processes are started, too.
void require_equal(const std::string& system, std::uint64_t ours, std::uint64_t theirs,
                   const SpinMode& mode) {
  const std::uint64_t expected = mode.is_flat ? ours : ours + 1;
  if (theirs == expected) return;
  throw UsageError(fmt::format("{} has {} states, and {} in SPIN ({}), which should be {}", system,
                               ours, theirs, mode.name, expected));
}

void require_few(const std::string& system, std::uint64_t ours, std::uint64_t theirs) {
  if (ours <= 2 * theirs) return;
  throw UsageError(fmt::format("{} has {} states, more than twice the {} of Promela by hand",
                               system, ours, theirs));
}

Row compare(const SystemText& text, Kind kind, int rounds, const fs::path& folder,
            const fs::path& maide) {
  Comparison comparison(text, kind, folder, maide);
  Row row;
  row.system = text.name;
  row.kind = kind;
  const std::uint64_t states = comparison.run_native().states;
  for (const SpinMode& mode : modes()) {
    if (!text.promela.empty() && !mode.is_flat) continue;
    comparison.prepare(mode);
    const Cost cost = comparison.run_spin(mode).first;
    if (kind == Kind::unreduced) require_equal(text.name, states, cost.states, mode);
    if (kind == Kind::calls) require_few(text.name, states, cost.states);
    (mode.is_flat ? row.flat : row.exported).add(mode, cost);
  }
  std::vector<Best*> both{&row.exported, &row.flat};
  if (!row.exported.fastest) both.erase(both.begin());
  std::vector<Cost> ours, fast[2], small[2];
  for (int round = 0; round < rounds; ++round) {
    ours.push_back(comparison.run_native());
    for (std::size_t i = 0; i < both.size(); ++i) {
      fast[i].push_back(comparison.run_spin(*both[i]->fastest).first);
      small[i].push_back(comparison.run_spin(*both[i]->smallest).first);
    }
  }
  row.ours = median(ours);
  for (std::size_t i = 0; i < both.size(); ++i) {
    both[i]->fast = median(fast[i]);
    both[i]->small = median(small[i]);
  }
  return row;
}

double megabytes(const Cost& cost) { return static_cast<double>(cost.peak_bytes) / 1e6; }

void print_head() {
  fmt::print("{:<40} | {:<58} | {:<58}\n", "", "SPIN, exported", "SPIN, by hand");
  fmt::print("{:<15} {:<9} {:>14} {:>7} {:>7}", "system", "", "our states", "s", "MB");
  for (int text = 0; text < 2; ++text) {
    fmt::print(" | {:<9} {:>7} {:>7} {:>7} | {:<9} {:>7} {:>7}", "fastest", "s", "MB", "time",
               "smallest", "MB", "memory");
  }
  fmt::print(" | {:>14}", "states by hand");
  fmt::print("\n");
}

// "flat sfh": of a text by hand, "sfh".
std::string short_name(const SpinMode& mode) {
  if (!mode.is_flat) return mode.name;
  return mode.name == "flat" ? "default" : mode.name.substr(5);
}

void print_row(const Row& row) {
  fmt::print("{:<15} {:<9} {:>14} {:>7.2f} {:>7.1f}", row.system, name_of(row.kind),
             row.ours.states, row.ours.seconds, megabytes(row.ours));
  for (const Best* best : {&row.exported, &row.flat}) {
    if (!best->fastest) {
      fmt::print(" | {:<33} | {:<25}", "", "");
      continue;
    }
    fmt::print(" | {:<9} {:>7.2f} {:>7.1f}  1/{:<4.1f} | {:<9} {:>7.1f}  1/{:<4.1f}",
               short_name(*best->fastest), best->fast.seconds, megabytes(best->fast),
               best->fast.seconds / row.ours.seconds, short_name(*best->smallest),
               megabytes(best->small), megabytes(best->small) / megabytes(row.ours));
  }
  fmt::print(" | {:>14}\n", row.flat.fast.states);
  std::fflush(stdout);
}

std::string csv_of(const std::vector<Row>& rows) {
  std::string csv = "system,kind,states,seconds,bytes";
  for (const std::string text : {"exported", "by_hand"}) {
    for (const std::string best : {"fastest", "smallest"}) {
      for (const std::string column : {"mode", "states", "seconds", "bytes"}) {
        csv += fmt::format(",{}_{}_{}", text, best, column);
      }
    }
  }
  csv += "\n";
  for (const Row& row : rows) {
    csv += fmt::format("{},{},{},{:.3f},{}", row.system, name_of(row.kind), row.ours.states,
                       row.ours.seconds, row.ours.peak_bytes);
    for (const Best* best : {&row.exported, &row.flat}) {
      if (!best->fastest) {
        csv += ",,,,,,,,";
        continue;
      }
      const std::pair<const SpinMode&, const Cost&> measured[]{{*best->fastest, best->fast},
                                                               {*best->smallest, best->small}};
      for (const auto& [mode, cost] : measured) {
        csv += fmt::format(",{},{},{:.3f},{}", short_name(mode), cost.states, cost.seconds,
                           cost.peak_bytes);
      }
    }
    csv += "\n";
  }
  return csv;
}

// "NAME:SIZE" or "NAME:SIZE:SIZE".
SystemText parse_system_text(const std::string& text) {
  std::smatch match;
  const std::regex form("([a-z-]+):([0-9]{1,6})(?::([0-9]{1,3}))?");
  if (std::regex_match(text, match, form)) {
    const auto size = static_cast<unsigned>(std::stoul(match[2]));
    const unsigned second = match[3].matched ? static_cast<unsigned>(std::stoul(match[3])) : 0;
    if (match[1] == "grasping" && size >= 10 && second == 0) return grasping(size);
    if (match[1] == "philosophers" && size >= 2 && second == 0) return philosophers(size);
    if (match[1] == "pipeline" && size >= 1 && second >= 1) return pipeline(size, second);
    if (match[1] == "token-ring" && size >= 2 && second >= 1) return token_ring(size, second);
    if (match[1] == "robots" && size >= 1 && second == 0) return robots(size);
  }
  throw UsageError("there is no system '" + text +
                   "'; there is grasping:N, philosophers:N, pipeline:STAGES:SIZE, "
                   "token-ring:STATIONS:SIZE, robots:N");
}

int run(int argc, char** argv) {
  int rounds = 3;
  std::vector<std::string> systems, only;
  std::string csv, folder_to_write;
  CLI::App app("Our engine against SPIN");
  app.add_option("--rounds", rounds, "Runs of each, alternating; the median counts")
      ->check(CLI::Range(1, 99));
  app.add_option("--only", only, "Of unreduced, calls, reduced, ltl")->allow_extra_args(false);
  app.add_option("--csv", csv, "Write all numbers to this file, too");
  app.add_option("--write", folder_to_write, "Write the systems to this folder, and end");
  app.add_option("SYSTEM", systems,
                 "grasping:N, philosophers:N, pipeline:STAGES:SIZE, token-ring:STATIONS:SIZE or "
                 "robots:N");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error);
  }
  if (systems.empty()) {
    systems = {"grasping:100",   "grasping:340", "philosophers:13", "pipeline:6:3",
               "token-ring:6:2", "robots:4",     "robots:6"};
  }
  std::vector<SystemText> texts;
  for (const std::string& system : systems) texts.push_back(parse_system_text(system));
  if (!folder_to_write.empty()) {
    for (const SystemText& text : texts) {
      fmt::print("{}\n", write_system(text, folder_to_write).string());
    }
    return 0;
  }
  const TempDir folder("maide-bench-check-");
  const fs::path maide = fs::read_symlink("/proc/self/exe").parent_path() / "maide";
  std::vector<Row> rows;
  print_head();
  for (const SystemText& text : texts) {
    for (const auto& [name, kind] : kinds) {
      if (!is_for(kind, text)) continue;
      if (!only.empty() && std::find(only.begin(), only.end(), name) == only.end()) continue;
      rows.push_back(compare(text, kind, rounds, folder.path(), maide));
      print_row(rows.back());
      if (!csv.empty()) write_file_atomically(csv, csv_of(rows));
    }
  }
  return 0;
}

}  // namespace
}  // namespace maide::bench

int main(int argc, char** argv) {
  try {
    return maide::bench::run(argc, argv);
  } catch (const maide::Error& error) {
    std::cerr << "bench_check: " << error.what() << '\n';
    return 1;
  }
}
