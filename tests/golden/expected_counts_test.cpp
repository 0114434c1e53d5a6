// Every deterministic count of the models and systems in the tree, exactly as benchmarks/
// expected.json has it: what learning them costs, and how many states checking them explores. A
// change that is not meant shows here first. After one that is:
//   MAIDE_APPROVE=1 build/dev/bin/test_expected_counts    and look at what git says.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "maide/automata/compare.hpp"
#include "maide/automata/strength.hpp"
#include "maide/base/file.hpp"
#include "maide/base/json.hpp"
#include "maide/check/build/system_file.hpp"
#include "maide/check/engines/engine.hpp"
#include "maide/check/verdict/check_system.hpp"
#include "maide/conformance/method/test_chain.hpp"
#include "maide/formats/model_file.hpp"
#include "maide/learn/cache/cache.hpp"
#include "maide/learn/learner.hpp"
#include "maide/learn/oracle/mealy_oracle.hpp"
#include "maide/learn/oracle/observing_oracle.hpp"
#include "maide/sul/ia_translation.hpp"

namespace maide {
namespace {

const std::filesystem::path root = MAIDE_SOURCE_DIR;

std::vector<std::filesystem::path> files_of(const std::string& folder,
                                            const std::string& extension) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(root / folder)) {
    if (entry.path().extension() == extension) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

// With this learner and these tests; in memory, behind a cache.
Json learn_counts(const Mealy& machine, std::string_view algorithm, std::string_view tests) {
  MealyOracle system(machine);
  CountingOracle counter(system);
  Cache cache(counter);
  const auto teacher = TestChain(tests).make({cache, &cache, &machine}, TestMethodOptions());
  const auto learner = find_deterministic_learner(algorithm).make(cache);
  const LearnResult result = run_learner(*learner, *teacher);
  EXPECT_EQ(find_difference(result.model, machine), std::nullopt);
  const QueryCounts counts = counter.statistics().total();
  return {{"states", result.model.size()},
          {"resets", counts.queries},
          {"symbols", counts.symbols},
          {"output_queries", learner->output_queries()},
          {"equivalence_queries", result.equivalence_queries},
          {"strength", to_string(teacher->strength())}};
}

Json count_learning() {
  Json counts;
  for (const auto& path : files_of("tests/models", ".dot")) {
    const std::string name = "tests/models/" + path.filename().string();
    for (const Translation translation : {Translation::eager, Translation::av}) {
      const Mealy machine = to_mealy(read_interface_automaton(path), translation);
      Json& of = counts[name + ", " + std::string(to_string(translation))];
      of["standard"] = learn_counts(machine, "lsharp", "standard");
      if (translation == Translation::av) continue;
      for (const LearnerEntry& learner : deterministic_learners()) {
        of["perfect"][std::string(learner.name)] = learn_counts(machine, learner.name, "perfect");
      }
    }
  }
  return counts;
}

// Without and with the reductions, for every property.
Json count_checking() {
  Json counts;
  for (const std::string folder : {"examples/case-study-1", "examples/case-study-2"}) {
    for (const auto& path : files_of(folder, ".yaml")) {
      bool needs_a_system = false;
      const System system =
          parse_system(read_file(path), path.string(), [&](const ModelRequest& request) {
            ModelRequest here = request;
            if (!request.learn.empty()) {
              needs_a_system = true;
              here.file = root / "examples/models/strict-1.dot";
              here.learn.clear();
            } else if (request.file.is_relative()) {
              here.file = path.parent_path() / request.file;
            }
            return read_requested_model(here);
          });
      if (needs_a_system) continue;
      NativeEngine engine;
      for (const PropertyResult& result : check_system(system, engine).properties) {
        Json& of = counts[folder + "/" + path.filename().string()][result.name];
        of["verdict"] = to_string(result.verdict);
        of["states"] = result.states;
        of["transitions"] = result.transitions;
      }
    }
  }
  return counts;
}

TEST(ExpectedCounts, AreExactlyThose) {
  const Json counts{{"learning", count_learning()}, {"checking", count_checking()}};
  ASSERT_GT(counts["learning"].size(), 10U);
  ASSERT_GT(counts["checking"].size(), 5U);
  const std::filesystem::path path = root / "benchmarks/expected.json";
  if (std::getenv("MAIDE_APPROVE") != nullptr) {
    write_file_atomically(path.string(), counts.dump(1) + "\n");
  }
  const Json expected = Json::parse(read_file(path.string()));
  for (const Json& change : Json::diff(expected, counts)) {
    const Json::json_pointer where(change["path"].get<std::string>());
    const bool is_known = expected.contains(where);
    ADD_FAILURE() << change["path"].get<std::string>() << ": "
                  << (is_known ? expected[where].dump() : "nothing") << " expected, "
                  << (counts.contains(where) ? counts[where].dump() : "nothing")
                  << " counted; if that is meant: run this once with MAIDE_APPROVE=1";
  }
}

}  // namespace
}  // namespace maide
