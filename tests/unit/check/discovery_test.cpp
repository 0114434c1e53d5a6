// Topics whose ends meet some time after the start.
#include <gtest/gtest.h>

#include <string>

#include "maide/base/error.hpp"
#include "maide/check/build/system_file.hpp"
#include "systems.hpp"
#include "verdict_cases.hpp"

namespace maide {
namespace {

using test::H;
using test::V;

// A map is written once, and somebody waits for it.
std::string map_once(const std::string& discovery, const std::string& before = "",
                     const std::string& depth = "depth: 1") {
  return "topics:\n  map: {writers: [mapper], readers: [planner], use: queue, with: {" + depth +
         "}" + discovery + "}\nprograms:\n  mapper: \"" + before +
         "map.write; @sent skip;\"\n  planner: \"map.read -> message; @got skip;\"\n"
         "properties:\n  got: {ltl: \"F planner@got\", fairness: strong}\n"
         "  may_get: {possible: \"planner@got\"}\n";
}

// Two who read; the writer waits for so many of them.
std::string scan(const std::string& matched) {
  return R"yaml(
topics:
  scan: {writers: [lidar], readers: [slam.on_scan, planner.on_scan], use: queue, with: {depth: 2},
         discovery: any}
executors: {a: {kind: single}, b: {kind: single}, c: {kind: single}}
nodes:
  lidar:
    executor: a
    start: "wait scan -> )yaml" +
         matched + R"yaml(;"
    callbacks: {tick: {timer: once 10, do: "scan.write;"}}
  slam: {executor: b, callbacks: {on_scan: {takes: scan.read, do: "@got skip;"}}}
  planner: {executor: c, callbacks: {on_scan: {takes: scan.read, do: "@got skip;"}}}
properties:
  both: "F (slam.on_scan@got) && F (planner.on_scan@got)"
  one: "F (slam.on_scan@got || planner.on_scan@got)"
)yaml";
}

// The reader waits until it is matched, and says so.
const std::string reader_waits = R"(
topics:
  map: {writers: [mapper], readers: [planner], use: queue, with: {depth: 1}, discovery: any}
programs:
  mapper: "select { when (ready) { } } map.write;"
  planner: "wait map -> matched; ready = true; map.read -> message; @got skip;"
variables: "var ready: bool;"
properties: {got: {ltl: "F planner@got", fairness: strong}}
)";

// Three values; who meets the writer late gets as many as that are kept, and so perhaps that first.
std::string values(const std::string& depth, int first) {
  return "topics:\n  map: {writers: [mapper], readers: [planner], use: queue, with: {depth: 5, "
         "pub-depth: " +
         depth +
         "}, delivery: late, discovery: any, durability: transient_local}\nprograms:\n"
         "  mapper: \"map.write(1); map.write(2); map.write(3);\"\n"
         "  planner: \"var n: 0..3; var first: 0..3; loop { idle map.read -> message(n); "
         "if (first == 0) { first = n; } }\"\nproperties:\n  p: {possible: \"planner.first == " +
         std::to_string(first) + "\"}\n";
}

class DiscoveryTest : public testing::TestWithParam<test::VerdictCase> {};

TEST_P(DiscoveryTest, HasTheVerdict) { test::expect_verdict(GetParam()); }

INSTANTIATE_TEST_SUITE_P(
    Discovery, DiscoveryTest,
    testing::Values(
        test::VerdictCase{"done", "got", H, map_once("")},
        test::VerdictCase{"said_to_be_done", "got", H, map_once(", discovery: done")},
        test::VerdictCase{"any", "got", V, map_once(", discovery: any")},
        test::VerdictCase{"any", "may_get", H, map_once(", discovery: any")},
        test::VerdictCase{"matched", "got", H,
                          map_once(", discovery: any", "wait map -> matched; ")},
        test::VerdictCase{"matched_one", "got", H,
                          map_once(", discovery: any", "wait map[planner] -> matched(1); ")},
        test::VerdictCase{"kept", "got", H,
                          map_once(", discovery: any, durability: transient_local")},
        test::VerdictCase{"not_kept", "got", V, map_once(", discovery: any, durability: volatile")},
        test::VerdictCase{"both_matched", "both", H, scan("matched(2)")},
        test::VerdictCase{"one_matched", "both", V, scan("matched")},
        test::VerdictCase{"one_matched", "one", H, scan("matched")},
        test::VerdictCase{"reader_waits", "got", H, reader_waits},
        test::VerdictCase{"keeps_one", "p", H, values("1", 3)},
        test::VerdictCase{"keeps_two", "p", V, values("2", 3)},
        test::VerdictCase{"keeps_two_of_three", "p", H, values("2", 2)},
        test::VerdictCase{"keeps_three", "p", V, values("3", 2)}),
    test::name_of);

std::string error_of_discovery(const std::string& text) {
  try {
    parse_system(text, "s.yaml", test::test_model);
  } catch (const ParseError& error) {
    return error.what();
  }
  return "";
}

TEST(Discovery, SaysWhatIsWrong) {
  const auto says = [](const std::string& text, const std::string& what) {
    const std::string error = error_of_discovery(text);
    EXPECT_NE(error.find(what), std::string::npos) << error;
  };
  says(map_once(", durability: volatile"), "write it beside 'discovery: any'");
  says(map_once(", discovery: any, delivery: at_once"),
       "topic 'map': `discovery: any` goes with messages that arrive some time later, and here "
       "the file says so");
  says(map_once(", discovery: any", "", "size: 2"), "messages that arrive some time later");
  says(map_once(", discovery: any, delivery: late", "", "size: 2"),
       "where a reader may refuse what is written is not built");
  says(map_once(", discovery: any, stream: s"), "neither `delivery: acknowledged` nor `stream`");
  says(map_once(", discovery: any", "wait map -> matched(2); "), "map has 1 other end here");
  says(map_once(", discovery: any", "wait map -> matched(0); "), "a number of at least 1");
  std::string dies = map_once(", discovery: any");
  dies.replace(dies.find("mapper: \"map"), 8, "mapper: {may_die: true, do: ");
  dies.replace(dies.find("@sent skip;\""), 12, "@sent skip;\"}");
  says(dies, "may die is not built");
}

}  // namespace
}  // namespace maide
