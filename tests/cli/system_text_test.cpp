// Slips in the text of system files: they are told before anything is learned, at their place, and
// `maide format` leaves such a file as it is.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "maide/base/file.hpp"
#include "maide/base/random.hpp"
#include "run_maide.hpp"

namespace maide::test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class SystemText : public testing::Test {
 protected:
  std::string write(const std::string& text) const {
    const std::string file = (folder_.path() / "s.yaml").string();
    write_file_atomically(file, text);
    return file;
  }
  fs::path mark() const { return folder_.path() / "started"; }
  // A model from a system that leaves a mark when it is started.
  std::string models() const {
    return "models:\n  via: {learn: \"exec:touch " + mark().string() + "\"}\n";
  }

  TempDir folder_{"system-text-test"};
};

TEST_F(SystemText, NothingIsStartedBeforeAllOfItIsRead) {
  const std::string rest = "programs:\n  p: \"loop { via.write; }\"\n";
  const std::pair<std::string, std::string> slips[] = {
      {"programs:\n  p: \"loop { via.write; \"\n", "this '{' is not closed"},
      {rest + "properties:\n  a: \"G (p@end -> \"\n", "expected a formula"},
      {rest + "properties:\n  a: \"G p@here\"\n", "program p has no label 'here'"},
      {rest + "properties:\n  a: \"G q@end\"\n", "unknown program 'q'"},
      {rest + "properties:\n  a: {always: \"n < 3\"}\n", "no variable, constant or word"},
      {"programs:\n  p: \"loop { vai.write; }\"\n", "unknown model 'vai'"},
      {"programs:\n  p: \"var n: 0..3; loop { via.write; m = n; }\"\n", "unknown variable 'm'"},
      {"programs:\n  p: \"var n: 0..3; loop { via.write; if (nn > 2) { skip; } }\"\n",
       "unknown name 'nn'"},
      {"programs:\n  p: \"var b: bool; loop { via.write; if (c) { skip; } }\"\n",
       "unknown name 'c'"},
      {"programs:\n  p: \"loop { wait via -> m(var x); if (x == go) { skip; } vai.write; }\"\n",
       "unknown model 'vai'"},  // `go` may be a word of the model's
      {"programs:\n  p: \"call q(via);\"\n", "unknown procedure 'q'"},
      {"topics: {t: {writers: x, readers: p, use: queue, with: {size: 1}}}\n" + rest,
       "unknown program 'x'"},
      {"constants: {n: 1 +}\n" + rest, "expected an expression"},
      {"colours: {}\n" + rest, "has no key 'colours'"},
  };
  for (const auto& [text, expected] : slips) {
    const SubprocessResult result = run_maide({"check", write(models() + text)});
    EXPECT_EQ(result.exit_status, 2) << text << result.err;
    EXPECT_THAT(result.err, HasSubstr(expected));
    EXPECT_FALSE(fs::exists(mark())) << text;
  }
  // Without a slip it is started.
  run_maide({"check", write(models() + rest)});
  EXPECT_TRUE(fs::exists(mark()));
}

TEST_F(SystemText, TheKeyThatIsWrongIsNamed) {
  const std::string file = write(
      "models:\n  via:\n    learn: port\n    with:\n      kind: blocking\n"
      "      inputs: \"write,size\"\n      size: 3\nprograms:\n  p: \"loop { via.write; }\"\n");
  EXPECT_THAT(run_maide({"check", file}).err, HasSubstr("s.yaml:6:7"));
}

TEST_F(SystemText, FormatRefusesWhatDoesNotParse) {
  const std::string head =
      "models: {m: {use: mutex}}\nprograms:\n  p: \"loop { m.lock; @in m.unlock; }\"\n";
  const std::pair<std::string, std::string> slips[] = {
      {"models: {m: {use: mutex}}\nprograms:\n  p: \"var n: 0..3; n++; m.lock;\"\n",
       "'n' is a variable: a statement sets it"},
      {"models: {m: {use: mutex}}\nprograms:\n  p: \"var n: 0..3; n += 1; m.lock;\"\n",
       "'n' is a variable: a statement sets it"},
      {head + "properties:\n  a: \"G (p@in => F m.unlock)\"\n", "'=>' is no sign here: it is '->'"},
      {head + "properties:\n  a: \"[] (p@end --> <> m.unlock)\"\n", "expected"},
      {head + "properties:\n  a: \"p@end === true\"\n", "'=' is no sign here: it is '=='"},
  };
  const std::string good = (folder_.path() / "good.yaml").string();
  for (const auto& [text, expected] : slips) {
    const std::string file = write(text);
    write_file_atomically(good, "programs:\n  p:   skip;\n");
    const SubprocessResult result = run_maide({"format", file, good});
    EXPECT_EQ(result.exit_status, 2);
    EXPECT_THAT(result.err, HasSubstr(expected));
    EXPECT_EQ(read_file(file), text);
    EXPECT_EQ(read_file(good), "programs:\n  p: \"skip;\"\n");  // it goes on with the others
  }
}

// Texts of which one character is another, or is gone: format writes what it can read again, or it
// leaves the file.
TEST_F(SystemText, FormatOfFiveHundredWrongTexts) {
  const std::string whole =
      read_file(std::string(MAIDE_SOURCE_DIR) + "/examples/ros2/nested/lost-update.yaml");
  Random random(20261127);
  const std::string signs = "{}[]()'\":;,.#@!=-+*&|>%\n x0";
  std::vector<std::string> arguments = {"format"};
  std::vector<std::string> texts;
  for (int i = 0; i < 500; ++i) {
    std::string text = whole;
    const std::size_t at = random.below(text.size());
    if (random.chance(0.5)) {
      text.erase(at, 1);
    } else {
      text[at] = signs[random.below(signs.size())];
    }
    const std::string file = (folder_.path() / (std::to_string(i) + ".yaml")).string();
    write_file_atomically(file, text);
    texts.push_back(text);
    arguments.push_back(file);
  }
  EXPECT_EQ(run_maide(arguments).exit_status, 2);
  std::size_t left = 0;
  std::vector<std::string> again = {"format", "--check"};
  for (std::size_t i = 0; i < texts.size(); ++i) {
    const bool is_left = read_file(arguments[i + 1]) == texts[i];
    left += is_left ? 1 : 0;
    if (!is_left) again.push_back(arguments[i + 1]);
  }
  EXPECT_GT(left, 100U);
  EXPECT_LT(left, 500U);
  EXPECT_EQ(run_maide(again).exit_status, 0);  // what was written is as it should be
}

}  // namespace
}  // namespace maide::test
