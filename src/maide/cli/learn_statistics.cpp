#include "maide/cli/learn_statistics.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <vector>

#include "maide/learn/statistics.hpp"
#include "maide/report/line_plot.hpp"

namespace maide::cli {
namespace {

constexpr std::array phases{LearnPhase::learning, LearnPhase::refinement, LearnPhase::testing,
                            LearnPhase::confirmation};

// Hypotheses at the beginning and at the end of a long list.
constexpr std::size_t shown = 10;

Json counts_json(const QueryCounts& counts) {
  return {{"words", counts.queries}, {"symbols", counts.symbols}, {"resets", counts.resets}};
}

}  // namespace

std::string describe_statistics(const ExperimentResult& run) {
  std::string text =
      fmt::format("  by phase             {:>10} {:>12} {:>10}\n", "words", "symbols", "resets");
  for (const LearnPhase phase : phases) {
    const QueryCounts& counts = run.statistics.at(phase);
    text += fmt::format("    {:<18} {:>10} {:>12} {:>10}\n", to_string(phase), counts.queries,
                        counts.symbols, counts.resets);
  }
  text +=
      fmt::format("  by hypothesis        {:>10} {:>23} {:>23}\n", "", "to make it", "to test it");
  text += fmt::format("    {:<18} {:>10} {:>10} {:>12} {:>10} {:>12}\n", "", "states", "words",
                      "symbols", "words", "symbols");
  const std::vector<HypothesisShare> shares = divide(run.hypotheses, run.statistics);
  for (std::size_t i = 0; i < shares.size(); ++i) {
    if (shares.size() > 2 * shown && i == shown) {
      text += fmt::format("    ... {} more ...\n", shares.size() - 2 * shown);
      i = shares.size() - shown;
    }
    const HypothesisShare& share = shares[i];
    text += fmt::format("    {:<18} {:>10} {:>10} {:>12} {:>10} {:>12}\n", i + 1, share.states,
                        share.to_make.queries, share.to_make.symbols, share.to_test.queries,
                        share.to_test.symbols);
  }
  return text;
}

void add_statistics(Json& json, const ExperimentResult& run) {
  for (const LearnPhase phase : phases) {
    json["phases"][std::string(to_string(phase))] = counts_json(run.statistics.at(phase));
  }
  json["hypotheses"] = Json::array();
  for (const HypothesisShare& share : divide(run.hypotheses, run.statistics)) {
    json["hypotheses"].push_back({{"states", share.states},
                                  {"to_make", counts_json(share.to_make)},
                                  {"to_test", counts_json(share.to_test)}});
  }
}

std::string draw_hypotheses(const ExperimentResult& run, const std::string& title) {
  PlotLine line{run.algorithm + ", " + run.test_method, {}, true};
  // Nothing may have reached the system, whose answers are all in a cache.
  const auto add = [&line](std::uint64_t symbols, std::size_t states) {
    line.points.emplace_back(static_cast<double>(std::max<std::uint64_t>(symbols, 1)),
                             static_cast<double>(states));
  };
  for (const HypothesisCost& hypothesis : run.hypotheses) {
    add(hypothesis.before.total().symbols, hypothesis.states);
  }
  if (!run.hypotheses.empty()) add(run.symbols, run.hypotheses.back().states);
  return draw_plot({{"states of the hypothesis: " + title, {line}}},
                   {"symbols given to the system", PlotScale::powers_of_ten, PlotScale::linear});
}

}  // namespace maide::cli
