// JUnit XML: counts, escaping, and the case that stands for a suite that did not end.
#include "maide/report/junit.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

namespace maide::test {
namespace {

using testing::HasSubstr;
using testing::Not;

std::string text_of(const JUnitSuite& suite) {
  std::ostringstream out;
  write_junit(out, suite);
  return out.str();
}

TEST(JUnit, EscapesWhatXmlDoesNotTake) {
  EXPECT_EQ(escape_xml("a<b>&\"'"), "a&lt;b&gt;&amp;&quot;&apos;");
  EXPECT_EQ(escape_xml("one\ntwo\tthree\r"), "one&#10;two&#9;three&#13;");
  EXPECT_EQ(escape_xml("\x1b[31m"), "\xEF\xBF\xBD[31m");
  EXPECT_EQ(escape_xml(std::string_view("\0x", 2)), "\xEF\xBF\xBDx");
  EXPECT_EQ(escape_xml("\xFF"), "\xEF\xBF\xBD");          // no UTF-8
  EXPECT_EQ(escape_xml("\xEF\xBF\xBE"), "\xEF\xBF\xBD");  // U+FFFE
  EXPECT_EQ(escape_xml("gr\xC3\xBC\xC3\x9F"), "gr\xC3\xBC\xC3\x9F");
}

TEST(JUnit, WritesEachCaseWithWhatBecameOfIt) {
  JUnitSuite suite;
  suite.name = "strict-2";
  suite.properties = {{"system", "port kind=\"strict\""}};
  suite.cases = {{"write, at the start", "", "", ""},
                 {"read, after write", "the model gives a<b", "word: write read\n", ""},
                 {"write, after write", "", "", "never tried"}};
  suite.seconds = 1.25;
  EXPECT_EQ(text_of(suite),
            R"(<?xml version="1.0" encoding="UTF-8"?>
<testsuites tests="3" failures="1" errors="0" skipped="1" time="1.250">
  <testsuite name="strict-2" tests="3" failures="1" errors="0" skipped="1" time="1.250">
    <properties>
      <property name="system" value="port kind=&quot;strict&quot;"/>
    </properties>
    <testcase classname="strict-2" name="write, at the start"/>
    <testcase classname="strict-2" name="read, after write">
      <failure message="the model gives a&lt;b">word: write read&#10;</failure>
    </testcase>
    <testcase classname="strict-2" name="write, after write">
      <skipped message="never tried"/>
    </testcase>
  </testsuite>
</testsuites>
)");
}

TEST(JUnit, ACaseThatCouldNotBeJudgedIsAnError) {
  JUnitSuite suite;
  suite.name = "s";
  suite.error = "interrupted";
  suite.cases = {{"stuck", "", "", "", "a \"limit\"", 0.5}};
  EXPECT_THAT(text_of(suite), HasSubstr("tests=\"2\" failures=\"0\" errors=\"2\" skipped=\"0\""));
  EXPECT_THAT(text_of(suite), HasSubstr("name=\"stuck\" time=\"0.500\">\n      <error "
                                        "message=\"a &quot;limit&quot;\"/>\n    </testcase>\n"));
}

TEST(JUnit, ASuiteThatDidNotEndHasAnError) {
  JUnitSuite suite;
  suite.name = "s";
  EXPECT_THAT(text_of(suite), Not(HasSubstr("(the whole suite)")));
  suite.error = "interrupted";
  EXPECT_THAT(text_of(suite), HasSubstr("tests=\"1\" failures=\"0\" errors=\"1\""));
  EXPECT_THAT(text_of(suite), HasSubstr("name=\"(the whole suite)\">\n      <error "
                                        "message=\"interrupted\"/>"));
}

}  // namespace
}  // namespace maide::test
