#include "maide/formats/trace_log.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

#include "maide/base/error.hpp"

namespace maide {
namespace {

TEST(TraceLog, ComesBackAsItWasWritten) {
  const std::string text =
      "[[\"write\",\"quiet\"],[\"read\",\"a \\\"message\\\"\"]]\n[]\n[[\"read\",\"quiet\"]]\n";
  const TraceLog log = read_trace_log(text, "log");
  ASSERT_EQ(log.traces.size(), 3U);
  EXPECT_EQ(to_string(log.traces[0].inputs, log.inputs), "write read");
  EXPECT_EQ(log.outputs.name(log.traces[0].outputs[1]), "a \"message\"");
  EXPECT_EQ(log.traces[2].outputs, Word{0});
  std::ostringstream out;
  write_trace_log(out, log);
  EXPECT_EQ(out.str(), text);
}

TEST(TraceLog, SkipsEmptyLinesAndNeedsNoLastLineBreak) {
  EXPECT_EQ(read_trace_log("\n  \r\n[[\"a\",\"b\"]]", "log").traces.size(), 1U);
  EXPECT_TRUE(read_trace_log("", "log").traces.empty());
}

TEST(TraceLog, SaysWhereItIsBroken) {
  for (const char* line : {"[[\"a\",\"b\"]", "{}", "[\"a\",\"b\"]", "[[\"a\"]]", "[[\"a\",1]]",
                           "[[\"\",\"b\"]]", "[[\"a\",\"b\",\"c\"]]", "x"}) {
    try {
      read_trace_log(std::string("[]\n") + line + "\n[]\n", "log");
      ADD_FAILURE() << line;
    } catch (const ParseError& error) {
      EXPECT_EQ(error.position().line, 2) << line;
      EXPECT_THAT(error.what(), testing::HasSubstr("(log:2")) << line;
    }
  }
}

}  // namespace
}  // namespace maide
