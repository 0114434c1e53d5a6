// `maide check --every` with the real program: tables over the values of a constant or a depth.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "maide/base/file.hpp"
#include "run_maide.hpp"

namespace maide::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;

// A burst fits into the queue, or its oldest messages are lost and the reader waits for ever.
std::string burst(const std::string& at = "topics", const std::string& with = "{depth: 2}") {
  const std::string ends =
      at == "topics" ? "writers: planner, readers: controller, delivery: at_once, " : "";
  return "constants: {burst: 3}\n" + at + ":\n  via: {" + ends + "use: queue, with: " + with +
         "}\nprograms:\n  planner: \"repeat burst { via.write; } @sent skip;\"\n"
         "  controller: \"repeat burst { via.read -> message; } @all skip;\"\n"
         "properties:\n  all: {possible: \"controller@all\"}\n";
}

class CheckEvery : public testing::Test {
 protected:
  std::string write(const std::string& text) const {
    const std::string path = (folder_.path() / "s.yaml").string();
    write_file_atomically(path, text);
    return path;
  }
  SubprocessResult check(const std::string& text, const std::string& every,
                         const std::vector<std::string>& more = {}) const {
    std::vector<std::string> command{"check", write(text), "--every", every};
    command.insert(command.end(), more.begin(), more.end());
    return run_maide(command);
  }

 private:
  TempDir folder_;
};

TEST_F(CheckEvery, ValueOfAConstant) {
  const SubprocessResult result = check(burst(), "burst=1..5");
  EXPECT_EQ(result.exit_status, 1) << result.err;
  EXPECT_THAT(result.out, AllOf(testing::StartsWith("verdict: violated\n  burst  states  seconds  "
                                                    "deadlock  stuck  all\n"),
                                HasSubstr("\ndeadlock: holds up to 2, violated from 3 on\n"),
                                HasSubstr("\nstuck: holds everywhere\n"),
                                HasSubstr("\nall: possible everywhere\n")));
  EXPECT_EQ(check(burst(), "burst=1..2").exit_status, 0);
  // Each is what --set says.
  const Json all = json_of(check(burst(), "burst=1..5", {"--json"}));
  for (const Json& value : all["values"]) {
    const std::string set = "burst=" + value["value"].dump();
    const Json one = json_of(run_maide({"check", write(burst()), "--set", set, "--json"}));
    EXPECT_EQ(value["verdict"], one["verdict"]);
    for (std::size_t at = 0; at < one["properties"].size(); ++at) {
      EXPECT_EQ(value["properties"][at]["verdict"], one["properties"][at]["verdict"]);
    }
  }
}

TEST_F(CheckEvery, DepthUpToOneThatIsNeverFilled) {
  for (const std::string at : {"topics", "models"}) {
    const SubprocessResult result = check(burst(at), "via.depth");
    EXPECT_EQ(result.exit_status, 1) << result.err;
    EXPECT_THAT(result.out,
                AllOf(HasSubstr("\ndeadlock: violated up to 2, holds from 3 on\n"),
                      HasSubstr("\nvia.depth = 4 is never filled, so a larger one changes "
                                "nothing\n")));
    const Json json = json_of(check(burst(at), "via.depth=1..7", {"--json"}));
    std::vector<bool> filled;
    for (const Json& value : json["values"]) filled.push_back(value["filled"].get<bool>());
    EXPECT_EQ(filled, (std::vector<bool>{true, true, true, false, false, false, false}));
    // No states are more, or less, from there on.
    for (std::size_t at_value = 4; at_value < 7; ++at_value) {
      EXPECT_EQ(json["values"][at_value]["states"], json["values"][3]["states"]);
    }
  }
  // With another value of a constant.
  EXPECT_THAT(check(burst(), "via.depth", {"--set", "burst=1"}).out,
              HasSubstr("via.depth = 2 is never filled"));
  // A write waits where there is no room.
  EXPECT_THAT(check(burst("models", "{size: 1}"), "via.size").out,
              AllOf(HasSubstr("\ndeadlock: holds everywhere\n"),
                    HasSubstr("via.size = 4 is never filled")));
}

// What is on its way counts: a writer keeps its last few, too.
TEST_F(CheckEvery, DepthWithMessagesOnTheirWay) {
  std::string late = burst();
  late.replace(late.find("at_once"), 7, "late");
  const SubprocessResult result = check(late, "via.depth");
  EXPECT_THAT(result.out, AllOf(HasSubstr("\ndeadlock: violated up to 2, holds from 3 on\n"),
                                HasSubstr("via.depth = 4 is never filled")));
}

TEST_F(CheckEvery, DepthThatIsAlwaysFilledEnds) {
  const SubprocessResult result = check(
      "models: {via: {use: queue, with: {depth: 1}}}\nprograms: {w: \"loop { via.write; }\"}\n",
      "via.depth");
  EXPECT_EQ(result.exit_status, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("each via.depth up to 64 can be filled"));
}

TEST_F(CheckEvery, RefusesWhatItCannotVary) {
  const auto refuses = [&](const std::string& every, const std::string& why,
                           const std::string& text = burst(),
                           const std::vector<std::string>& more = {}) {
    const SubprocessResult result = check(text, every, more);
    expect_error(result, 2, why);
  };
  refuses("burst", "--every takes CONSTANT=LOW..HIGH, MODEL.depth or");
  refuses("burst=3", "--every takes CONSTANT=LOW..HIGH");
  refuses("burst=1..x", "--every takes CONSTANT=LOW..HIGH");
  refuses("burst=5..1", "the range must have 1 to 10000 values");
  refuses("burst=1..1000000", "the range must have 1 to 10000 values");
  refuses("via.length", "--every takes CONSTANT=LOW..HIGH");
  refuses("via.depth=0..2", "a depth is at least 1");
  refuses("brust=1..2", "with brust = 1: ");
  refuses("via.size", "there is no model or topic 'via' with `use: queue` and a size");
  refuses("other.depth", "there is no model or topic 'other'");
  refuses("burst=1..2", "--every and --set both say what burst is", burst(), {"--set", "burst=3"});
  refuses("burst=1..2", "--every and --trace exclude each other", burst(), {"--trace", "t.json"});
  refuses("burst=1..2", "--every and --suggest exclude each other", burst(), {"--suggest"});
  refuses("burst=-1..2", "with burst = -1: ");
}

}  // namespace
}  // namespace maide::test
