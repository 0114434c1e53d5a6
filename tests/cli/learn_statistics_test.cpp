// What `maide learn` says of a run's costs: by phase, by hypothesis, as a plot.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "maide/base/file.hpp"
#include "run_maide.hpp"

namespace maide::test {
namespace {

using testing::HasSubstr;

const std::string simulated = "sim:" MAIDE_SOURCE_DIR "/tests/models/strict-6-tryread.dot";

TEST(LearnStatistics, PhasesAndHypothesesSumUpToTheRun) {
  const Json json = json_of(run_maide({"learn", simulated, "--confirm", "yes", "--json"}));
  for (const auto& [part, whole] :
       {std::pair("words", "experiments"), {"symbols", "symbols"}, {"resets", "resets"}}) {
    std::uint64_t of_phases = 0, of_hypotheses = 0;
    for (const Json& phase : json.at("phases")) of_phases += phase.at(part).get<std::uint64_t>();
    for (const Json& hypothesis : json.at("hypotheses")) {
      of_hypotheses += hypothesis.at("to_make").at(part).get<std::uint64_t>();
      of_hypotheses += hypothesis.at("to_test").at(part).get<std::uint64_t>();
    }
    EXPECT_EQ(of_phases, json.at(whole)) << part;
    EXPECT_EQ(of_hypotheses, json.at(whole)) << part;
  }
  EXPECT_EQ(json.at("hypotheses").size(), json.at("equivalence_queries"));
  EXPECT_EQ(json.at("hypotheses").back().at("states"), json.at("mealy_states"));
  EXPECT_GT(json.at("phases").at("testing").at("symbols"), 0);
}

TEST(LearnStatistics, AreATableOfTheVerboseSummary) {
  const TempDir folder;
  const std::string file = (folder.path() / "model.dot").string();
  const SubprocessResult result = run_maide({"learn", simulated, "-o", file, "-v"});
  EXPECT_EQ(result.exit_status, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("by phase"));
  EXPECT_THAT(result.out, HasSubstr("by hypothesis"));
}

TEST(LearnStatistics, ThePlotHasAStepForEachHypothesis) {
  const TempDir folder;
  const std::string plot = (folder.path() / "plot.svg").string();
  const Json json = json_of(run_maide({"learn", simulated, "--json", "--plot", plot}));
  const std::string svg = read_file(plot);
  EXPECT_TRUE(svg.starts_with("<svg "));
  const std::size_t start = svg.find(" d=\"M", svg.find("class=\"line\""));
  const std::string line = svg.substr(start, svg.find('/', start) - start);
  EXPECT_EQ(static_cast<std::size_t>(std::count(line.begin(), line.end(), 'H')),
            json.at("hypotheses").size());
  expect_error(run_maide({"learn", simulated, "--plot", "/no/such/folder/plot.svg"}), 2,
               "/no/such/folder");
}

// An output may be a whole page; the warning stays a line or three.
TEST(LearnStatistics, AWarningOfEndlessOutputsShowsTheirBeginnings) {
  constexpr std::size_t states = 260;
  std::string machine = "digraph {";
  std::string rest;
  for (int i = 0; i < 500; ++i) rest += "\u00e9";
  for (std::size_t i = 0; i < states; ++i) {
    machine += " s" + std::to_string(i) + " -> s" + std::to_string((i + 1) % states) +
               " [label=\"x / " + std::to_string(1000 + i) + rest + "\"];";
  }
  const TempDir folder;
  const std::string file = (folder.path() / "long.dot").string();
  write_file_atomically(file, machine + " }");
  const SubprocessResult result =
      run_maide({"learn", "sim:" + file, "-o", (folder.path() / "model.dot").string()});
  EXPECT_EQ(result.exit_status, 0) << result.err;
  EXPECT_THAT(result.err, HasSubstr("new outputs come without end: 200 in "));
  EXPECT_THAT(result.err, HasSubstr("the last '1198" + rest.substr(0, 2 * 56) + "...' and '1199"));
  EXPECT_THAT(result.err, HasSubstr("mostly to x. Let the wrapper say a few classes"));
}

}  // namespace
}  // namespace maide::test
