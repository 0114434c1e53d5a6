// The program that `maide bench FOLDER` starts: every learning algorithm on every model of a
// folder. It prints an aligned table with other tools' figures beside ours, means, CSV, JSON.
// Numbers only; what is measured, and how, is learner_bench.hpp.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "learner_bench.hpp"
#include "maide/base/error.hpp"
#include "maide/base/file.hpp"
#include "maide/base/json.hpp"
#include "maide/base/text.hpp"
#include "maide/cli/command.hpp"
#include "maide/cli/command_line.hpp"
#include "maide/cli/tool_commands.hpp"
#include "maide/learn/learner.hpp"
#include "published_results.hpp"

namespace maide::cli {
namespace {

// The table, a piece at a time, so that it can be watched.
class BenchTable {
 public:
  // Keeps references to both.
  BenchTable(const std::vector<BenchModel>& models, const BenchOptions& options);

  std::string head() const;
  // A run's line; before the first line of a model, what other tools take for the one before.
  std::string line(const BenchRun& run);
  // What is left after the last run, and the means.
  std::string end(std::span<const BenchRun> runs);

 private:
  std::string peers();
  std::string legend() const;

  const std::vector<BenchModel>& models_;
  const BenchOptions& options_;
  bool is_perfect_;
  bool has_peers_ = false;  // other tools' figures were printed
  std::size_t name_width_ = 0;
  std::size_t model_;  // of the line before; behind the last: none
};

constexpr std::string_view perfect = "perfect";
constexpr std::size_t learner_width = 30;

// States of the model that learners start from; "" if there is none.
std::string size_of_old(const BenchModel& model) {
  return model.old_version ? std::to_string(model.old_version->size()) : "";
}

std::string title(const BenchModel& model) {
  return fmt::format("{} {}x{}{}", model.name, model.machine.size(), model.machine.inputs().size(),
                     model.old_version ? fmt::format(", from {}", size_of_old(model)) : "");
}

// Resets, symbols, the same as asked, equivalence queries, CPU seconds, states.
std::string row(std::string_view model, std::size_t model_width, std::string_view learner,
                const std::array<std::string, 7>& cells, std::string_view remark) {
  std::string text = fmt::format("{:<{}}  {:<{}} {:>9} {:>11} {:>9} {:>11} {:>5} {:>9} {:>6}  {}",
                                 model, model_width, learner, learner_width, cells[0], cells[1],
                                 cells[2], cells[3], cells[4], cells[5], cells[6], remark);
  text.erase(text.find_last_not_of(' ') + 1);
  return text + "\n";
}

std::string seconds_text(double seconds) { return fmt::format("{:.4f}", seconds); }

// Other tools started from nothing.
template <typename Figure>
bool is_of(const Figure& figure, const BenchModel& model) {
  return !model.old_version && figure.model == model.name &&
         figure.states == model.machine.size() && figure.inputs == model.machine.inputs().size();
}

std::string in_words(double count) {
  if (count >= 1e9) return fmt::format("{:g} G", count / 1e9);
  return count >= 1e6 ? fmt::format("{:g} M", count / 1e6) : fmt::format("{:g} k", count / 1e3);
}

// The costs of an algorithm over several models.
struct Mean {
  std::string_view algorithm;
  std::size_t models = 0;
  QueryCounts asked, sent;
  std::uint64_t equivalence_queries = 0;
  double cpu_seconds = 0;

  double per_model(std::uint64_t count) const {
    return models == 0 ? 0 : static_cast<double>(count) / static_cast<double>(models);
  }
};

struct Means {
  std::vector<Mean> of;          // the algorithms, in the order of the options
  std::set<std::size_t> models;  // those that every algorithm learned rightly
};

// A run that is missing, after an interruption, is none that was right.
Means compute_means(std::span<const BenchRun> runs, const BenchOptions& options) {
  Means means;
  std::map<std::string_view, std::size_t> places;
  std::map<std::size_t, std::size_t> right;
  for (const LearnerEntry* algorithm : bench_learners(options)) {
    places.emplace(algorithm->name, means.of.size());
    means.of.emplace_back().algorithm = algorithm->name;
  }
  for (const BenchRun& run : runs) {
    if (run.outcome == BenchOutcome::right) ++right[run.model];
  }
  for (const auto& [model, count] : right) {
    if (count == means.of.size()) means.models.insert(model);
  }
  for (const BenchRun& run : runs) {
    if (!means.models.contains(run.model)) continue;
    Mean& mean = means.of[places.at(run.algorithm)];
    ++mean.models;
    mean.asked += run.asked.total();
    mean.sent += run.sent.total();
    mean.equivalence_queries += run.equivalence_queries;
    mean.cpu_seconds += run.cpu_seconds;
  }
  return means;
}

bool have_peers(const std::vector<BenchModel>& models, const Means& means) {
  std::vector<std::string> names;
  for (const std::size_t model : means.models) {
    if (models[model].old_version) return false;
    names.push_back(models[model].name);
  }
  return are_the_41_models(names);
}

BenchTable::BenchTable(const std::vector<BenchModel>& models, const BenchOptions& options)
    : models_(models),
      options_(options),
      is_perfect_(options.test_method == perfect),
      name_width_(std::string_view("model").size()),
      model_(models.size()) {
  for (const BenchModel& model : models) name_width_ = std::max(name_width_, title(model).size());
}

std::string BenchTable::head() const {
  return fmt::format("{:<{}}  {:<{}} {:^21} {:^21}\n", "", name_width_, "", learner_width,
                     "to the system", "asked") +
         row("model", name_width_, "learner",
             {"resets", "symbols", "resets", "symbols", "EQ", "CPU s", "states"}, "");
}

std::string BenchTable::legend() const {
  return has_peers_ ? "| other tools, on other machines: docs/bench.md says where from\n" : "";
}

std::string BenchTable::peers() {
  if (model_ >= models_.size()) return "";
  std::string text;
  const auto label = [](std::string_view tool, std::string_view name) {
    return fmt::format("| {}, {}", tool, name);
  };
  if (is_perfect_) {
    for (const PeerRun& run : peer_runs()) {
      if (!is_of(run, models_[model_])) continue;
      text += row("", name_width_, label(run.tool, run.learner),
                  {std::to_string(run.resets), std::to_string(run.symbols), "", "",
                   std::to_string(run.equivalence_queries),
                   run.cpu_seconds ? seconds_text(*run.cpu_seconds) : "", ""},
                  "");
    }
    has_peers_ = has_peers_ || !text.empty();
    return text;
  }
  for (const PeerTesting& testing : peer_testing()) {
    if (!is_of(testing, models_[model_])) continue;
    text += row("", name_width_, label("hybrid ADS", "random"),
                {"", in_words(testing.test_symbols), "", "", "", "",
                 std::to_string(testing.states_learned)},
                "tests alone");
  }
  has_peers_ = has_peers_ || !text.empty();
  return text;
}

std::string BenchTable::line(const BenchRun& run) {
  std::string text;
  const bool is_first = run.model != model_;
  if (is_first) {
    text = peers();
    model_ = run.model;
  }
  const QueryCounts sent = run.sent.total(), asked = run.asked.total();
  std::string remark;
  if (run.outcome == BenchOutcome::wrong) remark = "WRONG";
  if (run.outcome == BenchOutcome::unfinished) remark = run.error;
  return text + row(is_first ? title(models_[run.model]) : "", name_width_, run.algorithm,
                    {std::to_string(sent.resets), std::to_string(sent.symbols),
                     std::to_string(asked.resets), std::to_string(asked.symbols),
                     std::to_string(run.equivalence_queries), seconds_text(run.cpu_seconds),
                     std::to_string(run.states)},
                    remark);
}

std::string BenchTable::end(std::span<const BenchRun> runs) {
  std::string text = peers();
  const Means means = compute_means(runs, options_);
  if (means.models.empty()) return text + legend();
  const std::size_t count = means.models.size();
  text += fmt::format("\nMeans of the {} that every learner learned rightly; CPU seconds in all\n",
                      count == 1 ? "one model" : fmt::format("{} models", count));
  text += fmt::format("{:<{}} {:>16} {:>16} {:>8} {:>9}\n", "learner", learner_width,
                      "symbols + resets", "asked", "EQ", "CPU s");
  for (const Mean& mean : means.of) {
    text += fmt::format("{:<{}} {:>16.0f} {:>16.0f} {:>8.1f} {:>9.4f}\n", mean.algorithm,
                        learner_width, mean.per_model(mean.sent.symbols + mean.sent.resets),
                        mean.per_model(mean.asked.symbols + mean.asked.resets),
                        mean.per_model(mean.equivalence_queries), mean.cpu_seconds);
  }
  if (is_perfect_ && have_peers(models_, means)) {
    for (const PeerMean& mean : peer_means()) {
      text += fmt::format("{:<{}} {:>16.0f}\n", fmt::format("| {}, {}", mean.tool, mean.learner),
                          learner_width, mean.symbols_and_resets);
    }
  }
  return text + legend();
}

std::string bench_csv(const std::vector<BenchModel>& models, std::span<const BenchRun> runs) {
  std::string text =
      "model,states,inputs,algorithm,outcome,learned_states,resets,symbols,test_resets,"
      "test_symbols,asked_resets,asked_symbols,asked_test_resets,asked_test_symbols,"
      "equivalence_queries,cpu_seconds,old_states\n";
  for (const BenchRun& run : runs) {
    const BenchModel& model = models[run.model];
    std::string name;
    for (const char c : model.name) name += c == '"' ? "\"\"" : std::string(1, c);
    const QueryCounts sent = run.sent.total(), asked = run.asked.total();
    const QueryCounts& tests = run.sent.at(LearnPhase::testing);
    const QueryCounts& asked_tests = run.asked.at(LearnPhase::testing);
    text += fmt::format("\"{}\",{},{},{},{},{},{},{},{},{},{},{},{},{},{},{:.6f},{}\n", name,
                        model.machine.size(), model.machine.inputs().size(), run.algorithm,
                        to_string(run.outcome), run.states, sent.resets, sent.symbols, tests.resets,
                        tests.symbols, asked.resets, asked.symbols, asked_tests.resets,
                        asked_tests.symbols, run.equivalence_queries, run.cpu_seconds,
                        size_of_old(model));
  }
  return text;
}

Json run_json(const BenchModel& model, const BenchRun& run) {
  const auto counts = [](const Statistics& statistics) {
    const QueryCounts total = statistics.total();
    const QueryCounts& tests = statistics.at(LearnPhase::testing);
    return Json{{"resets", total.resets},
                {"symbols", total.symbols},
                {"test_resets", tests.resets},
                {"test_symbols", tests.symbols}};
  };
  return {{"model", model.name},
          {"states", model.machine.size()},
          {"inputs", model.machine.inputs().size()},
          {"old_states", model.old_version ? Json(model.old_version->size()) : Json()},
          {"algorithm", run.algorithm},
          {"outcome", to_string(run.outcome)},
          {"error", run.error.empty() ? Json() : Json(run.error)},
          {"learned_states", run.states},
          {"equivalence_queries", run.equivalence_queries},
          {"to_system", counts(run.sent)},
          {"asked", counts(run.asked)},
          {"cache_edges", run.cache_edges},
          {"cache_bytes", run.cache_bytes},
          {"cpu_seconds", run.cpu_seconds}};
}

Json peers_json(const BenchModel& model, bool is_perfect) {
  Json list = Json::array();
  for (const PeerRun& run : peer_runs()) {
    if (!is_perfect || !is_of(run, model)) continue;
    list.push_back({{"model", model.name},
                    {"tool", run.tool},
                    {"learner", run.learner},
                    {"resets", run.resets},
                    {"symbols", run.symbols},
                    {"equivalence_queries", run.equivalence_queries},
                    {"cpu_seconds", run.cpu_seconds ? Json(*run.cpu_seconds) : Json()}});
  }
  for (const PeerTesting& testing : peer_testing()) {
    if (is_perfect || !is_of(testing, model)) continue;
    list.push_back({{"model", model.name},
                    {"tool", "hybrid ADS"},
                    {"test_symbols", testing.test_symbols},
                    {"states", testing.states_learned}});
  }
  return list;
}

Json means_json(const Means& means) {
  Json list = Json::array();
  for (const Mean& mean : means.of) {
    if (mean.models == 0) continue;
    list.push_back(
        {{"algorithm", mean.algorithm},
         {"models", mean.models},
         {"symbols_and_resets", mean.per_model(mean.sent.symbols + mean.sent.resets)},
         {"asked_symbols_and_resets", mean.per_model(mean.asked.symbols + mean.asked.resets)},
         {"equivalence_queries", mean.per_model(mean.equivalence_queries)},
         {"cpu_seconds_in_all", mean.cpu_seconds}});
  }
  return list;
}

Json bench_json(const BenchFolder& folder, const BenchOptions& options,
                std::span<const BenchRun> runs, bool is_complete) {
  const bool is_perfect = options.test_method == perfect;
  Json json{{"equivalence_method", options.test_method},
            {"seed", options.testing.seed},
            {"cache", options.use_cache},
            {"complete", is_complete},
            {"runs", Json::array()}};
  for (const BenchRun& run : runs) json["runs"].push_back(run_json(folder.models[run.model], run));
  const Means means = compute_means(runs, options);
  json["means"] = means_json(means);
  json["peers"] = Json::array();
  for (const BenchModel& model : folder.models) {
    for (Json& figure : peers_json(model, is_perfect)) {
      json["peers"].push_back(std::move(figure));
    }
  }
  json["peer_means"] = Json::array();
  if (is_perfect && have_peers(folder.models, means)) {
    for (const PeerMean& mean : peer_means()) {
      json["peer_means"].push_back({{"tool", mean.tool},
                                    {"learner", mean.learner},
                                    {"symbols_and_resets", mean.symbols_and_resets}});
    }
  }
  json["unreadable"] = folder.unreadable;
  return json;
}

// Wrong models count most, then runs that are missing, then models that could not be read.
ExitStatus status_of(std::span<const BenchRun> runs, const BenchFolder& folder, bool is_complete) {
  const auto any = [runs](BenchOutcome outcome) {
    return std::any_of(runs.begin(), runs.end(),
                       [outcome](const BenchRun& run) { return run.outcome == outcome; });
  };
  if (any(BenchOutcome::wrong)) return ExitStatus::violated;
  if (!is_complete || any(BenchOutcome::unfinished)) return ExitStatus::inconclusive;
  return folder.unreadable.empty() ? ExitStatus::ok : ExitStatus::usage;
}

ExitStatus bench(const BenchArguments& arguments, Context& context) {
  if (!arguments.csv.empty()) check_can_write(arguments.csv);
  BenchOptions options;
  options.algorithms = arguments.algorithms;
  options.seconds = arguments.seconds;
  options.max_experiments = arguments.max_experiments;
  options.jobs = arguments.jobs;
  options.use_cache = !arguments.no_cache;
  bench_learners(options);  // wrong names are found before models are read
  arguments.tests.check("");
  options.test_method = arguments.tests.method;
  options.testing = arguments.tests.read();
  options.testing.seed = arguments.seed;
  BenchFolder folder = read_bench_folder(arguments.folder);
  if (!arguments.start_from.empty()) add_old_versions(folder, arguments.start_from);
  for (const std::string& message : folder.unreadable) context.complain(message);
  if (folder.models.empty()) {
    throw UsageError("no model there can be learned (" + arguments.folder + ")");
  }

  BenchTable table(folder.models, options);
  std::vector<BenchRun> runs;
  context.print(table.head());
  const bool is_complete = run_bench(
      folder.models, options,
      [&](const BenchRun& run) {
        runs.push_back(run);
        context.print(table.line(run));
      },
      context.control());
  context.print(table.end(runs));
  Json json = bench_json(folder, options, runs, is_complete);
  json["start_from"] = arguments.start_from.empty() ? Json() : Json(arguments.start_from);
  context.set_result(json);
  if (!arguments.csv.empty()) {
    write_file_atomically(arguments.csv, bench_csv(folder.models, runs));
  }
  if (!is_complete) context.complain("the bench was interrupted; above is what was measured");
  return status_of(runs, folder, is_complete);
}

RunFunction set_up(CommandLine& line) {
  auto arguments = std::make_shared<BenchArguments>();
  declare_bench(line, *arguments);
  return [arguments](Context& context) { return bench(*arguments, context); };
}

}  // namespace
}  // namespace maide::cli

int main(int argc, char** argv) {
  maide::cli::prepare_process();
  return maide::cli::run_tool("bench", maide::cli::set_up, argc, argv);
}
