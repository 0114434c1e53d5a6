// Traces read back: what was written is found again, and a trace of another system is refused with
// the step that is not possible.
#include "maide/check/system/trace_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "maide/base/file.hpp"
#include "maide/check/engines/engine.hpp"
#include "maide/check/verdict/check_system.hpp"
#include "systems.hpp"

namespace maide::test {
namespace {

using testing::HasSubstr;

const std::string burst =
    "  p: loop { repeat 2 { sync.write; } if * { via.read -> message; } else { skip; } }\n"
    "  q: loop { repeat 2 { sync.read -> message; } via.write; }\n";

Trace find_trace(const System& system, const std::string& property) {
  NativeEngine engine;
  CheckRequest request;
  request.properties = {property};
  const CheckReport report = check_system(system, engine, request);
  return report.properties.front().trace.value();
}

std::string as_file(const System& system, const Trace& trace) {
  return to_json_line(trace_file_to_json(system, "it", trace));
}

TEST(TraceFile, IsReadBack) {
  const System system = system_of(burst, "  taken: {ltl: \"G F via!message\", fairness: none}\n");
  for (const std::string property : {"deadlock", "taken"}) {
    const Trace trace = find_trace(system, property);
    const TraceFile file = parse_trace(as_file(system, trace), "t.json", system);
    EXPECT_EQ(file.property, "it");
    EXPECT_EQ(file.trace.steps, trace.steps);
    EXPECT_EQ(file.trace.loop_start, trace.loop_start);
    EXPECT_EQ(trace.loop_start.has_value(), property == "taken");
  }
}

// What maide wrote before steps could be nobody's.
TEST(TraceFile, OfVersionOneIsRead) {
  const System system = system_of("  p: loop { sync.write; }\n  q: sync.read -> message;\n");
  const TraceFile file =
      parse_trace(read_file(MAIDE_SOURCE_DIR "/tests/models/trace-version-1.json"),
                  "trace-version-1.json", system);
  EXPECT_EQ(file.property, "stuck");
  ASSERT_EQ(file.trace.steps.size(), 3U);
  EXPECT_EQ(file.trace.steps[1].actor, 1U);
  EXPECT_EQ(file.trace.loop_start, std::nullopt);
}

TEST(TraceFile, OfAnotherSystemIsRefusedWithItsStep) {
  const System system = system_of(burst);
  const std::string step = R"({"program": "p", "line": 5, "model": "sync", "event": "?write"})";
  const std::string text = "{\"steps\": [" + step + "," + step + "]}";
  EXPECT_EQ(parse_trace(text, "t.json", system).trace.steps.size(), 2U);
  const auto error = [&](const std::string& programs) {
    const System other = system_of(programs);
    return error_of([&] { parse_trace(text, "t.json", other); });
  };
  EXPECT_THAT(error("  p: sync.write;\n  r: skip;\n"),
              HasSubstr("step 2: p line 5 sync?write is not possible in system.yaml; possible: "
                        "nothing (t.json)"));
  EXPECT_THAT(error("  p: via.write;\n"),
              HasSubstr("step 1: p line 5 sync?write is not possible in system.yaml; possible: p "
                        "line 5 via?write (t.json)"));
  EXPECT_THAT(error("  r: skip;\n"), HasSubstr("step 1: there is no program 'p' in system.yaml"));
}

TEST(TraceFile, ThatIsNoneIsRefused) {
  const System system = system_of(burst);
  const auto error = [&](const std::string& text) {
    return error_of([&] { parse_trace(text, "t.json", system); });
  };
  EXPECT_THAT(error("{"), HasSubstr("t.json:1"));
  EXPECT_THAT(error("[]"), HasSubstr("'steps' (t.json)"));
  EXPECT_THAT(error(R"({"steps": [1]})"), HasSubstr("step 1: it must be an object"));
  EXPECT_THAT(error(R"({"steps": [{"program": 1}]})"), HasSubstr("there is no text 'program'"));
  const std::string step = R"({"program": "p", "line": 5, "model": "sync", "event": "?write"})";
  EXPECT_THAT(error(R"({"steps": [{"program": "p", "event": "if"}]})"), HasSubstr("'line'"));
  for (const char* line : {"4294967301", "18446744073709551615", "-1"}) {
    EXPECT_THAT(
        error(R"({"steps": [{"program": "p", "event": "if", "line": )" + std::string(line) + "}]}"),
        HasSubstr("'line' is no line's number"));
  }
  EXPECT_THAT(error(R"({"loop_start": 1, "steps": [)" + step + "]}"), HasSubstr("'loop_start'"));
  EXPECT_THAT(error(R"({"loop_start": 0, "steps": [)" + step + "]}"),
              HasSubstr("do not come back to where they began"));
  EXPECT_THAT(error(R"({"steps": [{"program": "p", "line": 5, "model": "x", "event": "quiet"}]})"),
              HasSubstr("there is no model 'x'"));
}

}  // namespace
}  // namespace maide::test
