// JSON errors carry a position; writing never fails.
#include "maide/base/json.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "maide/base/error.hpp"

namespace maide {
namespace {

ParseError error_of(std::string_view text) {
  try {
    parse_json(text, "file.json");
  } catch (const ParseError& error) {
    return error;
  }
  throw std::runtime_error("it parsed");
}

TEST(Json, KeepsTheOrderOfMembers) {
  EXPECT_EQ(to_json_line(parse_json(R"({"z": 1, "a": [true, null], "m": "x"})", "f")),
            R"({"z":1,"a":[true,null],"m":"x"})");
}

TEST(Json, ErrorsNameThePlace) {
  const ParseError error = error_of("{\n  \"a\": 1,\n  b\n}");
  EXPECT_EQ(error.position().line, 3);
  EXPECT_EQ(error.position().column, 3);
  EXPECT_EQ(std::string(error.what()).find("[json"), std::string::npos) << error.what();
  EXPECT_TRUE(std::string(error.what()).ends_with("(file.json:3:3)")) << error.what();
}

TEST(Json, EmptyAndTruncatedTextIsAnError) {
  EXPECT_EQ(error_of("").position().line, 1);
  EXPECT_EQ(error_of("[1,\n2").position().line, 2);
  EXPECT_EQ(error_of("1 2").position().column, 3);
}

TEST(Json, DeepNestingIsNotACrash) {
  EXPECT_THROW(parse_json(std::string(1000000, '['), "f"), ParseError);
}

TEST(Json, NumbersThatNobodyCanHoldAreAnError) {
  EXPECT_EQ(std::string(error_of("[1e999]").what()).find("not valid JSON: number overflow"), 0U);
}

TEST(Json, WritesBytesThatAreNotUtf8) {
  EXPECT_EQ(to_json_line(Json{{"a", "x\xff"}}), "{\"a\":\"x\xef\xbf\xbd\"}");
}

}  // namespace
}  // namespace maide
