// `maide extract`, and `maide check` of C++ sources, with the real program and the real cppcheck.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "maide/base/error.hpp"
#include "maide/base/file.hpp"
#include "maide/base/json.hpp"
#include "maide/base/subprocess.hpp"
#include "run_maide.hpp"

namespace maide::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

// It waits for its answer in the callback that keeps the answer away.
const std::string asker = R"(#include <rclcpp/rclcpp.hpp>
using Trigger = std_srvs::srv::Trigger;
struct Asker : rclcpp::Node {
  Asker() : Node("asker") {
    client_ = create_client<Trigger>("lookup");
    timer_ = create_wall_timer(1s, [this] { ask(); });
  }
  void ask() {
    client_->async_send_request(std::make_shared<Trigger::Request>()).get();
  }
  rclcpp::Client<Trigger>::SharedPtr client_;
  rclcpp::TimerBase::SharedPtr timer_;
};
)";

class ExtractCommand : public testing::Test {
 protected:
  void SetUp() override {
    try {
      if (run_program({"cppcheck", "--version"}).out.find("2.10") != std::string::npos) return;
    } catch (const UsageError&) {
    }
    GTEST_SKIP() << "cppcheck 2.10 is not there";
  }
  std::string write(const std::string& name, const std::string& text) const {
    write_file_atomically((folder_.path() / name).string(), text);
    return (folder_.path() / name).string();
  }
  TempDir folder_;
};

TEST_F(ExtractCommand, CheckNamesTheLineOfTheSource) {
  const SubprocessResult result =
      run_maide({"check", write("asker.cpp", asker), "--assume", "ok,exceptions,read"});
  EXPECT_EQ(result.exit_status, 1) << result.err;
  EXPECT_THAT(result.out,
              AllOf(HasSubstr("read: 1 node from 1 file, 0 holes\n"),
                    HasSubstr("with threads=1:\nverdict: violated"),
                    HasSubstr("with threads=4:\nverdict: violated"), HasSubstr("asker.cpp:9")));
}

// Steps of the file that was made have no place; holes are warnings at their lines.
TEST_F(ExtractCommand, SarifHasPlacesOfTheSources) {
  const std::string sarif = (folder_.path() / "r.sarif").string();
  std::string text = asker;
  text.replace(text.find("    client_->"), 0, "    vendor::beep();\n");
  const std::string path = write("asker.cpp", text);
  run_maide({"check", path, "--executor", "single", "--sarif", sarif});
  const Json json = parse_json(read_file(sarif), sarif);
  const Json& results = json["runs"][0]["results"];
  ASSERT_FALSE(results.empty());
  for (const Json& found : results) {
    EXPECT_THAT(found.dump(), Not(HasSubstr("was%20extracted")));
    EXPECT_THAT(found["locations"].dump(), HasSubstr("/asker.cpp"));
  }
  EXPECT_EQ(results.back()["ruleId"], "hole");
  EXPECT_EQ(results.back()["locations"][0]["physicalLocation"]["region"]["startLine"], 9);
}

TEST_F(ExtractCommand, TheExecutorIsSaidOnce) {
  const SubprocessResult result = run_maide({"check", write("asker.cpp", asker), "--assume",
                                             "ok,exceptions,read", "--executor", "single"});
  EXPECT_EQ(result.exit_status, 1) << result.err;
  EXPECT_THAT(result.out, Not(HasSubstr("with threads")));
}

TEST_F(ExtractCommand, WritesTheFileAndItsHoles) {
  std::string text = asker;
  text.replace(text.find("    client_->async"), 4, "    vendor::beep(); ");
  const std::string source = write("asker.cpp", text), file = write("asker.yaml", "");
  const SubprocessResult result =
      run_maide({"extract", source, "--assume", "ok,exceptions,read", "-o", file, "--explain"});
  EXPECT_EQ(result.exit_status, 3) << result.err;
  EXPECT_THAT(result.out,
              AllOf(HasSubstr("asker.cpp:9: a call of vendor::beep"),
                    HasSubstr("vendor::beep(); client_->"), HasSubstr("the run is cut there")));
  EXPECT_THAT(read_file(file), HasSubstr("unknown at"));
  EXPECT_THAT(read_file(write("asker.holes.yaml", read_file(folder_.path() / "asker.holes.yaml"))),
              HasSubstr("a call of vendor::beep"));
  // A table of one's own closes it.
  const std::string table =
      write("vendor.yaml", "known: \"read\"\nfunctions: {\"vendor::beep\": inert}\n");
  EXPECT_EQ(
      run_maide({"extract", source, "--assume", "ok,exceptions,read", "--api", table}).exit_status,
      0);
}

TEST_F(ExtractCommand, RefusesWhatNeedsAFile) {
  const std::string source = write("asker.cpp", asker);
  expect_error(run_maide({"check", source, "--suggest"}), 2, "--suggest needs a system file");
  expect_error(run_maide({"check", source, write("a.yaml", "")}), 2, "unexpected argument");
  expect_error(run_maide({"extract", source, "--executor", "many"}), 2, "--executor is single");
}

}  // namespace
}  // namespace maide::test
