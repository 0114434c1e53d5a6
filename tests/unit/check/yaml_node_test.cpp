// YAML as a tree that loses nothing: places, styles, comments; and what is said where it is none.
#include "maide/check/text/yaml_node.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "maide/base/file.hpp"
#include "systems.hpp"

namespace maide {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

YamlDocument read(const std::string& text) { return read_yaml(text, "s.yaml", "a system file"); }

TEST(YamlNode, KeepsPlacesAndStyles) {
  const YamlDocument document = read(
      "a: {b: 'it''s', \"c d\": [x, 2]}\n"
      "t: |\n"
      "  one\n"
      "  two\n"
      "\xC3\xA4: end\n");
  const YamlNode& map = *document.root.find("a");
  EXPECT_EQ(map.style, YamlNode::Style::flow);
  EXPECT_EQ(document.source(map), "{b: 'it''s', \"c d\": [x, 2]}");
  EXPECT_EQ(map.find("b")->value, "it's");
  EXPECT_EQ(map.find("b")->style, YamlNode::Style::single_quoted);
  EXPECT_EQ(document.source(*map.find("b")), "'it''s'");
  const YamlNode& list = *map.find("c d");
  ASSERT_EQ(list.entries.size(), 2U);
  EXPECT_EQ(to_string(document.position(list.entries[1].value)), "s.yaml:1:28");
  EXPECT_EQ(document.root.find("t")->value, "one\ntwo\n");
  // Columns are bytes, also behind a letter of two.
  EXPECT_EQ(to_string(document.position(*document.root.find("\xC3\xA4"))), "s.yaml:5:5");
  EXPECT_EQ(document.source(*document.root.find("\xC3\xA4")), "end");
}

TEST(YamlNode, GivesCommentsToTheEntriesBesideThem) {
  const YamlDocument document = read(
      "# head\n"
      "a:  # of a\n"
      "  b: \"x # y\"  # of b\n"
      "  # behind b\n"
      "\n"
      "# before c\n"
      "c: |  # of c\n"
      "  text # no comment\n"
      "# end\n");
  const YamlEntry &a = document.root.entries[0], &c = document.root.entries[1];
  EXPECT_THAT(a.before, ElementsAre("# head"));
  EXPECT_EQ(a.comment, "# of a");
  EXPECT_EQ(a.value.entries[0].comment, "# of b");
  EXPECT_THAT(a.value.tail, ElementsAre("# behind b", ""));
  EXPECT_THAT(c.before, ElementsAre("# before c"));
  EXPECT_EQ(c.comment, "# of c");
  EXPECT_THAT(document.root.tail, ElementsAre("# end"));
  EXPECT_FALSE(document.is_kept);
}

TEST(YamlNode, KeepsTheEntryWhereACommentHasNoPlace) {
  const YamlDocument document = read("a: {b: 1,  # in braces\n  c: 2}\nd: 3\n");
  EXPECT_TRUE(document.root.entries[0].is_kept);
  EXPECT_FALSE(document.root.entries[1].is_kept);
}

TEST(YamlNode, AliasesAreCopies) {
  const YamlDocument document = read("a: &x {b: 1}\nc: *x\n");
  EXPECT_EQ(document.root.find("c")->find("b")->value, "1");
  EXPECT_EQ(document.root.find("c")->alias, "x");
  std::string bomb = "a0: &a0 [x, x]\n";
  for (int i = 1; i < 40; ++i) {
    const std::string n = std::to_string(i), before = std::to_string(i - 1);
    bomb += "a" + n + ": &a" + n + " [*a" + before + ", *a" + before + "]\n";
  }
  EXPECT_THAT(test::error_of([&] { read(bomb); }), HasSubstr("more than a million values"));
}

TEST(YamlNode, ChangesAndDifferences) {
  YamlDocument document = read("a: {b: 1}\n");
  document.root.at("a").set("b", YamlNode("2"));
  document.root.at("c").at("d").set("e", YamlNode("f"));
  EXPECT_EQ(document.root.find("a")->find("b")->value, "2");
  EXPECT_EQ(document.root.find("c")->find("d")->find("e")->value, "f");
  document.root.remove("a");
  EXPECT_EQ(document.root.find("a"), nullptr);
}

TEST(YamlNode, SaysInPlainWordsWhatIsWrong) {
  const auto error = [](const std::string& text) { return test::error_of([&] { read(text); }); };
  EXPECT_EQ(error("t: {writers: p[k], readers: q}\n"),
            "not YAML: in braces and brackets a name with '[' is put in quotes, as in \"p[k]\" "
            "(s.yaml:1:15)");
  EXPECT_THAT(error("a: 'x\n"), HasSubstr("a quote is not closed (s.yaml:1:4)"));
  EXPECT_THAT(error("a: @x\n"), HasSubstr("a text that begins with '@' is put in quotes"));
  EXPECT_THAT(error("a: *x\n"), HasSubstr("a text that begins with '*' is put in quotes"));
  EXPECT_THAT(error("a: \"x\" y\n"), HasSubstr("nothing may follow a text in quotes"));
  EXPECT_THAT(error("a: \xff\n"), HasSubstr("not YAML"));
  EXPECT_THAT(error(""), HasSubstr("the system file is empty"));
  EXPECT_THAT(error(std::string(5 << 20, ' ')), HasSubstr("at most 4 MiB"));
}

// Each byte of each example is a token, a comment or a blank, so cutting a file anywhere gives a
// tree or an error, and never a crash.
TEST(YamlNode, EndsAnywhere) {
  const std::string text =
      read_file(std::string(MAIDE_SOURCE_DIR) + "/examples/ros2/nested/lost-update.yaml");
  for (std::size_t end = 0; end < text.size(); ++end) {
    test::error_of([&] { read(text.substr(0, end)); });
  }
}

}  // namespace
}  // namespace maide
