// `depth: unknown`: what is decided is so at every depth, and what the depth decides is
// inconclusive. Held against the same systems at depths from 1 to more than they ever have in
// flight.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <string>
#include <vector>

#include "maide/base/random.hpp"
#include "maide/check/engines/engine.hpp"
#include "maide/check/verdict/check_system.hpp"
#include "systems.hpp"

namespace maide {
namespace {

using testing::HasSubstr;

System system_with(std::string text, const std::string& depth) {
  const std::string hole = "DEPTH";
  for (std::size_t at = 0; (at = text.find(hole, at)) != std::string::npos;) {
    text.replace(at, hole.size(), depth);
  }
  return parse_system(text, "s.yaml", test::test_model, {}, {}, Deliveries::at_rest);
}

CheckReport check(const System& system) {
  NativeEngine engine;
  return check_system(system, engine, CheckRequest{});
}

std::map<std::string, Verdict> verdicts(const std::string& text, const std::string& depth) {
  std::map<std::string, Verdict> result;
  for (const PropertyResult& property : check(system_with(text, depth)).properties) {
    result[property.name] = property.verdict;
  }
  return result;
}

// Counts what is decided. Fails where a depth says otherwise.
struct Tally {
  int holds = 0, violated = 0, open = 0;

  void add(const std::string& text, const std::string& most = "12") {
    const auto unknown = verdicts(text, "unknown");
    for (const std::string& depth : {std::string("1"), std::string("2"), most}) {
      const auto known = verdicts(text, depth);
      for (const auto& [property, verdict] : unknown) {
        if (verdict == Verdict::inconclusive) continue;
        EXPECT_EQ(to_string(verdict), to_string(known.at(property)))
            << property << " at depth " << depth << " of\n"
            << text;
      }
    }
    for (const auto& [property, verdict] : unknown) {
      (verdict == Verdict::holds ? holds : verdict == Verdict::violated ? violated : open)++;
    }
  }
};

std::string times(Random& random, const std::string& statement, bool may_loop) {
  switch (random.below(may_loop ? 4 : 3)) {
    case 3: return "loop { " + statement + " } ";
    case 0: return "if * { " + statement + " } else { skip; } ";
    default: return "repeat " + std::to_string(1 + random.below(2)) + " { " + statement + " } ";
  }
}

std::string program(Random& random, const std::vector<std::string>& statements,
                    bool may_loop = true) {
  std::string text;
  for (std::size_t length = 1 + random.below(3); length > 0; --length) {
    text += times(random, statements[random.below(statements.size())], may_loop);
  }
  return text;
}

TEST(UnknownDepth, OfQueuesAgreesWithEveryDepth) {
  Random random(5);
  Tally tally;
  for (int i = 0; i < 120; ++i) {
    tally.add(
        "topics:\n  image: {writers: camera, readers: [detector, logger], use: queue, with: "
        "{depth: DEPTH}}\nmodels:\n  done: {use: queue, with: {depth: DEPTH}}\nprograms:\n"
        "  camera: \"" +
        program(random, {"image.write;", "idle done.read -> message;"}) + "\"\n  detector: \"" +
        program(random, {"idle image.read -> message;", "image.read -> message;", "done.write;",
                         "select { on image.read -> message { } "
                         "timeout 5 { } }"}) +
        "\"\n  logger: \"loop { idle image.read -> message; @logs skip; }\"\n"
        "properties:\n  logs: \"F logger@logs\"\n  done: \"G !done.write\"\n");
  }
  EXPECT_GT(tally.holds, 50);
  EXPECT_GT(tally.violated, 50);
  EXPECT_GT(tally.open, 50);
}

TEST(UnknownDepth, OfValuesAgreesWithEveryDepth) {
  Random random(6);
  Tally tally;
  for (int i = 0; i < 80; ++i) {
    tally.add("models:\n  order: {use: queue, with: {depth: DEPTH}}\nprograms:\n  desk: \"" +
              program(random, {"order.write(go);", "order.write(halt);"}) + "\"\n  robot: \"" +
              program(random, {"idle order.read -> message(go);",
                               "switch order.read { message(go) { skip; } message { stop; } }"}) +
              "@ends skip;\"\nproperties:\n  ends: \"F robot@ends\"\n");
  }
  EXPECT_GT(tally.holds, 20);
  EXPECT_GT(tally.violated, 20);
  EXPECT_GT(tally.open, 20);
}

TEST(UnknownDepth, OfServicesAgreesWithEveryDepth) {
  Random random(7);
  Tally tally;
  const std::vector<std::string> calls{"lookup.send;", "lookup.receive -> answer;",
                                       "lookup.send; lookup.receive -> answer;"};
  for (int i = 0; i < 80; ++i) {
    tally.add(
        "services:\n  lookup: {server: map, clients: [planner, monitor], with: {depth: "
        "DEPTH}}\nprograms:\n  map: \"loop { idle lookup.serve -> request; lookup.answer; "
        "}\"\n  planner: \"" +
            program(random, calls, false) + "\"\n  monitor: \"" + program(random, calls, false) +
            "\"\n",
        "4");
  }
  EXPECT_GT(tally.holds, 20);
  EXPECT_GT(tally.violated, 20);
  EXPECT_GT(tally.open, 20);
}

// The nodes of the README's case, with and without a group of its own for the client.
TEST(UnknownDepth, OfNodesAgreesWithEveryDepth) {
  Tally tally;
  for (const std::string images : {"1", "2", "3"}) {
    for (const std::string executor : {"kind: single", "kind: multi, threads: 2"}) {
      for (const std::string group : {"", "clients: {lookup: own}, "}) {
        tally.add(
            "topics:\n  image: {writers: camera, readers: detector, use: queue, with: "
            "{depth: DEPTH}}\nservices:\n  lookup: {server: map, clients: [detector], with: "
            "{depth: DEPTH}}\nexecutors:\n  main: {" +
            executor +
            "}\nprograms:\n"
            "  camera: \"repeat " +
            images +
            " { image.write; }\"\n"
            "  map: \"loop { idle lookup.serve -> request; lookup.answer; }\"\nnodes:\n"
            "  detector: {executor: main, groups: {own: exclusive}, " +
            group +
            "callbacks: {on_image: {takes: image.read, do: \"lookup.send; wait lookup -> "
            "answer; @found skip;\"}}}\nproperties:\n  found: \"F detector@found\"\n");
      }
    }
  }
  EXPECT_GT(tally.holds, 3);
  EXPECT_GT(tally.violated, 3);
  EXPECT_GT(tally.open, 3);
}

TEST(UnknownDepth, IsAskedForInOneLine) {
  const System system = system_with(
      "topics:\n  image: {writers: a, readers: [b, c], use: queue, with: {depth: DEPTH}, "
      "readers_with: {c: {depth: 3}}}\nservices:\n  lookup: {server: b, clients: [a], with: "
      "{depth: DEPTH}}\nprograms:\n  a: \"repeat 2 { image.write; } lookup.send; lookup.receive -> "
      "answer;\"\n  b: \"loop { idle select { on image.read -> message { } on lookup.serve -> "
      "request { lookup.answer; } } }\"\n  c: \"loop { idle image.read -> message; }\"\n",
      "unknown");
  ASSERT_EQ(system.remarks.size(), 1U);
  EXPECT_EQ(system.remarks[0],
            "'depth: unknown': write how many messages are kept, as in 'depth: 10', for lookup "
            "(s.yaml:4:3), image[b] (s.yaml:2:3)");
  const CheckReport report = check(system);
  EXPECT_EQ(report.verdict, Verdict::inconclusive);
  EXPECT_THAT(report.properties[0].reason,
              HasSubstr("how much image[b] keeps is not known (depth: unknown)"));
  EXPECT_THAT(testing::PrintToString(report.assumptions),
              HasSubstr("image[b] stands for every depth (depth: unknown)"));
}

}  // namespace
}  // namespace maide
