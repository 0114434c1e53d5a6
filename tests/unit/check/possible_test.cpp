// `possible: F`: whether some run comes to F, with a shortest one.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "maide/check/verdict/check_system.hpp"
#include "systems.hpp"

namespace maide::test {
namespace {

using testing::HasSubstr;

PropertyResult check(const System& system, const std::string& name) {
  NativeEngine engine;
  CheckRequest request;
  request.properties = {name};
  return check_system(system, engine, request).properties.front();
}

const std::string programs =
    "  p: \"if * { sync.write; sync.write; @far skip; } else { @near sync.write; }\"\n"
    "  q: \"@first sync.read -> message;\"\n";

TEST(Possible, HasAShortestRun) {
  const System system = system_of(programs,
                                  "  far: {possible: \"p@end && q@end\"}\n"
                                  "  near: {possible: p@near}\n"
                                  "  event: {possible: sync!message}\n"
                                  "  at_once: {possible: \"q@first && !p@end\"}\n");
  const auto length = [&](const std::string& name) {
    const PropertyResult result = check(system, name);
    EXPECT_EQ(result.verdict, Verdict::holds) << name;
    EXPECT_EQ(describe_verdict(result), "possible");
    if (!result.trace) return ~std::size_t{0};
    EXPECT_EQ(find_flaw_in_parts(system, find_property(system, name), *result.trace), "");
    return result.trace->steps.size();
  };
  EXPECT_EQ(length("far"), 4U);
  EXPECT_EQ(length("near"), 1U);
  EXPECT_EQ(length("event"), 4U);
  EXPECT_EQ(length("at_once"), 0U);
}

TEST(Possible, IsNotIfNoRunComesThere) {
  const System system = system_of(programs, "  both: {possible: \"p@far && p@near\"}\n");
  const PropertyResult result = check(system, "both");
  EXPECT_EQ(result.verdict, Verdict::violated);
  EXPECT_EQ(describe_verdict(result), "not possible");
  EXPECT_EQ(result.reason, "no run comes to it");
  EXPECT_FALSE(result.trace);
}

// What lies behind is not known, but what lies before is.
TEST(Possible, IsInconclusiveWhereRunsAreCutOrEndAtAnError) {
  const std::string behind = "  behind: {possible: p@end}\n  before: {possible: p@before}\n";
  const System cut =
      system_of("  p: \"repeat 2 { via.write; } @before via.write; skip;\"\n", behind);
  EXPECT_EQ(check(cut, "behind").verdict, Verdict::inconclusive);
  EXPECT_EQ(check(cut, "before").verdict, Verdict::holds);
  const System wrong =
      system_of("  p: \"var n: 0..1; sync.write; @before sync.write; n = 2; skip;\"\n", behind);
  const PropertyResult result = check(wrong, "behind");
  EXPECT_EQ(result.verdict, Verdict::inconclusive);
  EXPECT_EQ(describe_verdict(result), "inconclusive");
  EXPECT_THAT(result.reason, HasSubstr("runs end at an error"));
  EXPECT_EQ(check(wrong, "before").verdict, Verdict::holds);
}

TEST(Possible, IsOneForEachValueOfAForall) {
  const System system =
      system_of("  p: \"var n: 0..3; while (n < 2) { sync.write; n = n + 1; }\"\n",
                "  n: {possible: \"forall i in 0..3: p.n == i\"}\n");
  NativeEngine engine;
  CheckRequest request;
  request.properties = {"n"};
  const CheckReport report = check_system(system, engine, request);
  std::vector<std::string> verdicts;
  for (const PropertyResult& result : report.properties) {
    verdicts.push_back(result.name + " " + describe_verdict(result));
  }
  EXPECT_EQ(verdicts, (std::vector<std::string>{"n[0] possible", "n[1] possible", "n[2] possible",
                                                "n[3] not possible"}));
  EXPECT_EQ(report.verdict, Verdict::violated);
}

TEST(Possible, IsRefusedWithTimeAndWithFairness) {
  const auto error = [](const std::string& property) {
    return error_of([&] { system_of(programs, "  it: {" + property + "}\n"); });
  };
  EXPECT_THAT(error("possible: \"F p@far\""),
              HasSubstr("'possible' takes an expression without X"));
  EXPECT_THAT(error("possible: p@far, fairness: strong"),
              HasSubstr("what is possible does not depend on fairness"));
  EXPECT_THAT(error("possible: p@far, always: p@near"), HasSubstr("a property has one of 'ltl', "));
  EXPECT_THAT(error("posible: p@far"), HasSubstr("'possible'"));
}

}  // namespace
}  // namespace maide::test
