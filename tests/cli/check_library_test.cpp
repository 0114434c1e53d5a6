// maide::check() against the command line: what one of them says of a system file, both say. That
// Python says the same is tested in tests/python/check_test.py.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "maide/base/file.hpp"
#include "maide/check.hpp"
#include "run_maide.hpp"

namespace maide::test {
namespace {

using testing::HasSubstr;

// What is violated needs an order of callbacks that rclcpp's executors do not take.
constexpr const char* doubtful =
    "topics:\n"
    "  a: {writers: w, readers: n, delivery: at_once, use: queue, with: {depth: 1}}\n"
    "  b: {writers: w, readers: n, delivery: at_once, use: queue, with: {depth: 1}}\n"
    "programs:\n"
    "  w: \"a.write; b.write;\"\n"
    "nodes:\n"
    "  n:\n"
    "    variables: \"var seen: bool; var bad: 0..1;\"\n"
    "    callbacks:\n"
    "      on_a: {takes: a.read, do: \"seen = true;\"}\n"
    "      on_b: {takes: b.read, do: \"if (!seen) { bad = bad + 2; }\"}\n";

// Two properties with one run, and a statement that is never reached.
constexpr const char* remarkable =
    "models: {door: {use: mutex}}\n"
    "programs:\n"
    "  a: \"door.lock; door.lock; stop; skip;\"\n"
    "properties: {never_stuck: \"G F a@end\"}\n";

// What is read late is an answer to what was written first.
constexpr const char* racing =
    "topics:\n"
    "  map: {writers: mapper, readers: robot, use: queue, with: {depth: 1}}\n"
    "  notice: {writers: mapper, readers: robot, use: queue, with: {depth: 1}}\n"
    "programs:\n"
    "  mapper: \"map.write; notice.write;\"\n"
    "  robot: \"notice.read -> message; switch map.tryread { message {} null {} }\"\n";

void expect_same(const std::string& path) {
  SCOPED_TRACE(path);
  const Checked checked = check(path);
  const SubprocessResult printed =
      run_with_maide("\"$maide\" check --trace-format steps -v '" + path + "'");
  const Json said = json_of(run_maide({"check", path, "--json"}));
  EXPECT_EQ(to_string(checked.verdict), said.at("verdict"));
  EXPECT_EQ(Json(checked.assumptions), said.at("assumptions"));
  EXPECT_EQ(Json(checked.doubts), said.at("doubts"));
  EXPECT_EQ(Json(checked.remarks), said.at("remarks"));
  for (const std::string& doubt : checked.doubts) {
    EXPECT_THAT(printed.out, HasSubstr("beware: " + doubt + "\n"));
  }
  for (const std::string& race : checked.races) {
    EXPECT_THAT(printed.out, HasSubstr("  - " + race + "\n"));
  }
  EXPECT_EQ(checked.races.size(), said.contains("races") ? said.at("races").at("pairs").size() : 0);
  for (const std::string& remark : checked.remarks) EXPECT_THAT(printed.err, HasSubstr(remark));
  ASSERT_EQ(checked.properties.size(), said.at("properties").size());
  for (std::size_t i = 0; i < checked.properties.size(); ++i) {
    const CheckedProperty& property = checked.properties[i];
    const Json& of_command = said.at("properties")[i];
    EXPECT_EQ(property.name, of_command.at("name"));
    EXPECT_EQ(to_string(property.verdict), of_command.at("verdict"));
    EXPECT_EQ(property.reason, of_command.value("reason", ""));
    EXPECT_EQ(property.states, of_command.at("states"));
    EXPECT_EQ(property.transitions, of_command.at("transitions"));
    EXPECT_EQ(property.same_run_as, of_command.value("same_run_as", ""));
    const std::string explanation = of_command.value("explanation", "");
    EXPECT_EQ(property.explanation, explanation.empty() ? "" : explanation + ".");
    EXPECT_EQ(property.run.empty(), of_command.at("trace").empty());
    if (property.same_run_as.empty()) {
      EXPECT_THAT(printed.out, HasSubstr(property.run));
    }
  }
}

TEST(CheckLibrary, SaysWhatTheCommandLineSays) {
  const TempDir folder("maide-test-");
  for (const char* text : {doubtful, remarkable, racing}) {
    const std::string path = (folder.path() / "s.yaml").string();
    write_file_atomically(path, text);
    expect_same(path);
  }
  const std::string counted = (folder.path() / "n.yaml").string();
  write_file_atomically(counted,
                        "constants: {n: 1}\nmodels: {m: {use: mutex}}\n"
                        "programs: {a: 'repeat n { m.lock; m.unlock; }'}\n");
  const auto states = [&](const std::vector<std::string>& set) {
    CheckOptions options;
    options.set = set;
    return check(counted, options).properties[0].states;
  };
  EXPECT_EQ(states({"n=5"}), states({}) + 8);
  EXPECT_EQ(states({"n=5"}), json_of(run_maide({"check", counted, "--set", "n=5", "--json"}))
                                 .at("properties")[0]
                                 .at("states"));
  EXPECT_THROW(states({"k=5"}), UsageError);
  const std::filesystem::path examples = std::filesystem::path(MAIDE_SOURCE_DIR) / "examples";
  for (const char* name : {"case-study-1/buffered.yaml", "case-study-1/beyond-the-bound.yaml",
                           "architectures/cell.yaml", "architectures/election-mended.yaml"}) {
    expect_same((examples / name).string());
  }
}

TEST(CheckLibrary, SaysWhatIsDoubtful) {
  const TempDir folder("maide-test-");
  const std::string path = (folder.path() / "doubtful.yaml").string();
  write_file_atomically(path, doubtful);
  const Checked checked = check(path);
  EXPECT_EQ(checked.verdict, Verdict::violated);
  ASSERT_EQ(checked.doubts.size(), 1);
  EXPECT_THAT(checked.doubts.front(), HasSubstr("no run was found in which executors pick"));
}

TEST(CheckLibrary, SaysWhichMessagesRace) {
  const TempDir folder("maide-test-");
  const std::string path = (folder.path() / "racing.yaml").string();
  write_file_atomically(path, racing);
  const Checked checked = check(path);
  ASSERT_EQ(checked.races.size(), 1);
  EXPECT_THAT(checked.races.front(), HasSubstr("notice may come before map"));
}

TEST(CheckLibrary, RefusesWhatTheCommandLineRefuses) {
  const std::string path = std::string(MAIDE_SOURCE_DIR) + "/examples/architectures/cell.yaml";
  CheckOptions options;
  options.engine = "spin";
  options.threads = 2;
  std::string said;
  try {
    check(path, options);
  } catch (const UsageError& error) {
    said = error.what();
  }
  ASSERT_FALSE(said.empty());
  expect_error(run_maide({"check", path, "--engine", "spin", "--threads", "2"}), 2, said);
}

}  // namespace
}  // namespace maide::test
