// Systems in which messages race, or only seem to: most refute a rule by which some wire could be
// left out. Each has its verdict with everything at once, with writers that keep what their topic
// says, and with writers that keep ten; all reductions agree on it.
#include <gtest/gtest.h>

#include <ostream>
#include <regex>
#include <string>

#include "maide/check/build/system_file.hpp"
#include "maide/check/engines/engine.hpp"
#include "maide/check/verdict/check_system.hpp"
#include "systems.hpp"

namespace maide {
namespace {

struct RacingSystem {
  const char* name;
  const char* property;
  const char* at_once;
  const char* late;
  const char* keeps_ten;
  const char* text;
};

void PrintTo(const RacingSystem& race, std::ostream* out) {
  *out << race.name << ' ' << race.property;
}

// Of three processes nobody has a second way to another one, and yet two find nothing.
constexpr const char* three = R"yaml(
topics:
  t: {writers: p0, readers: [p1, p2], use: queue, with: {depth: 2}}
  u: {writers: p2, readers: p1, use: queue, with: {depth: 2}}
programs:
  p0: "t.write;"
  p1: "t.read -> message; switch u.tryread { message { loop { idle u.read -> message; } } null { skip; } }"
  p2: "u.write; switch t.tryread { message { loop { idle t.read -> message; } } null { skip; } }"
properties: {both: {always: "!(p1@end && p2@end)"}}
)yaml";

// The same, seen by one program that both tell.
constexpr const char* five = R"yaml(
topics:
  t: {writers: p0, readers: [p1, p2], use: queue, with: {depth: 2}}
  u: {writers: p2, readers: p1, use: queue, with: {depth: 2}}
  v: {writers: [p1, p2], readers: o, use: queue, with: {depth: 2}}
programs:
  p0: "t.write;"
  p1: "t.read -> message; switch u.tryread { message { skip; } null { v.write; } }"
  p2: "u.write; switch t.tryread { message { skip; } null { v.write; } }"
  o: "idle v.read -> message; idle v.read -> message; @both skip;"
properties: {both: "G !o@end"}
)yaml";

// Two readers see two writers in two orders: independent reads of independent writes.
constexpr const char* iriw = R"yaml(
topics:
  a: {writers: p1, readers: r1, use: queue, with: {depth: 1}}
  b: {writers: p1, readers: r2, use: queue, with: {depth: 1}}
  c: {writers: p2, readers: r2, use: queue, with: {depth: 1}}
  d: {writers: p2, readers: r1, use: queue, with: {depth: 1}}
programs:
  p1: "a.write; b.write;"
  p2: "c.write; d.write;"
  r1: "d.read -> message; switch a.tryread { message { skip; } null { @n skip; skip; loop { idle a.read -> message; } } }"
  r2: "b.read -> message; switch c.tryread { message { skip; } null { @n skip; skip; loop { idle c.read -> message; } } }"
properties: {both: {always: "!(r1@n && r2@n)"}, one: "G !r1@n"}
)yaml";

// No path leads from the writer to the reader but the wire: the formula watches both.
constexpr const char* watch = R"yaml(
topics: {t: {writers: p, readers: q, use: queue, with: {depth: 2}}}
programs: {p: "t.write;", q: "switch t.tryread { message { skip; } null { @missed skip; } }"}
properties: {w: {always: "!(p@end && t!null)"}}
)yaml";
constexpr const char* watch2 = R"yaml(
topics: {t: {writers: p, readers: q, use: queue, with: {depth: 2}}}
programs:
  p: "t.write;"
  q: "@b switch t.tryread { message { @got idle t.read -> message; } null { @m idle t.read -> message; } }"
properties: {r: "G ((p@end && q@b) -> F q@got)", w: {always: "!(p@end && t!null)"}}
)yaml";

// Two writers: one takes no room that is kept for what the other has on its way.
constexpr const char* min1 = R"yaml(
topics: {t: {writers: [a, b], readers: r, use: queue, with: {size: 1}, delivery: late}}
models: {m: {use: mutex}}
programs:
  a: "m.lock; m.unlock; t.write;"
  b: "t.write;"
  r: "m.lock; m.unlock; if (1 == 2) { t.read -> message; }"
properties: {both: {always: "!(a@end && b@end)"}}
)yaml";

// The wire loses what the queue would not.
constexpr const char* min2 = R"yaml(
topics: {t: {writers: p, readers: q, use: queue, with: {depth: 2, pub-depth: 1}}}
programs: {p: "t.write; t.write;", q: "t.read -> message; t.read -> message;"}
properties: {both: "F q@end"}
)yaml";

// A writer does not wait for a model that has its answer due.
constexpr const char* weak = R"yaml(
topics: {t: {writers: p, readers: q, use: queue, with: {depth: 1}}}
programs: {p: "t.write;", q: "loop { switch t.tryread { message { skip; } null { skip; } } }"}
properties: {w: "F p@end", s: {ltl: "F p@end", fairness: strong}}
)yaml";

// Three are on their way at once.
constexpr const char* three_late = R"yaml(
topics:
  t: {writers: p, readers: q, use: queue, with: {depth: 3}}
  g: {writers: p, readers: q, use: queue, with: {depth: 1}}
programs:
  p: "t.write; t.write; t.write; g.write;"
  q: "g.read -> message; switch t.tryread { message { skip; } null { @missed skip; } }"
properties: {w: "G !q@missed"}
)yaml";

// A queue that runs over only if writes come early, and one that is empty and then runs over.
constexpr const char* overflow = R"yaml(
topics:
  t: {writers: p, readers: q, use: queue, with: {depth: 1}}
  g: {writers: p, readers: q, use: queue, with: {depth: 1}}
programs:
  p: "t.write; t.write; g.write;"
  q: "g.read -> message; t.read -> message; t.read -> message; @both skip;"
properties: {w: "G !q@both"}
)yaml";
constexpr const char* none_then_two = R"yaml(
topics:
  t: {writers: p, readers: q, use: queue, with: {depth: 1}}
  g: {writers: p, readers: q, use: queue, with: {depth: 2}}
programs:
  p: "t.write; g.write; t.write; g.write;"
  q: "g.read -> message; g.read -> message; switch t.tryread { message { stop; } null { skip; } } t.read -> message; t.read -> message; @two skip;"
properties: {w: "G !q@two"}
)yaml";

// Values of two writers, the second of whom was told by the first.
constexpr const char* two_writers = R"yaml(
topics:
  t: {writers: [p1, p2], readers: q, use: queue, with: {depth: 2}}
  g: {writers: p1, readers: p2, use: queue, with: {depth: 1}}
programs:
  p1: "t.write(1); g.write;"
  p2: "g.read -> message; t.write(2);"
  q: "var x: 0..2; t.read -> message(x); if (x == 2) { @wrong skip; }"
properties: {w: "G !q@wrong"}
)yaml";

// A writer that dies with a message on its way.
constexpr const char* killed = R"yaml(
topics:
  t: {writers: p, readers: q, use: queue, with: {depth: 1}}
  g: {writers: p, readers: q, use: queue, with: {depth: 1}}
programs:
  p: {do: "t.write; g.write;", may_die: true}
  q: "idle g.read -> message; switch t.tryread { message { skip; } null { @missed skip; } }"
properties: {w: "G !q@missed"}
)yaml";

constexpr const char* H = "holds";
constexpr const char* V = "violated";

constexpr RacingSystem racing_systems[] = {
    {"three", "both", H, V, V, three},
    {"five", "both", H, V, V, five},
    {"iriw", "both", H, V, V, iriw},
    {"iriw", "one", V, V, V, iriw},
    {"watch", "w", H, V, V, watch},
    {"watch2", "r", H, V, V, watch2},
    {"watch2", "w", H, V, V, watch2},
    {"min1", "both", H, H, H, min1},
    {"min1", "deadlock", V, V, V, min1},
    {"min2", "both", H, V, H, min2},
    {"min2", "deadlock", H, V, H, min2},
    {"weak", "w", V, H, H, weak},
    {"weak", "s", H, H, H, weak},
    {"three_late", "w", H, V, V, three_late},
    {"overflow", "w", H, V, V, overflow},
    {"overflow", "deadlock", V, V, V, overflow},
    {"none_then_two", "w", H, V, V, none_then_two},
    {"none_then_two", "deadlock", H, V, V, none_then_two},
    {"two_writers", "w", H, V, V, two_writers},
    {"killed", "w", H, V, V, killed},
};

// The verdict, which all reductions agree on.
std::string verdict_on(const RacingSystem& race, const std::string& text, Deliveries deliveries) {
  const System system = parse_system(text, "s.yaml", test::test_model, {}, {}, deliveries);
  NativeEngine engine;
  std::string common;
  for (const Reduction reduction :
       {Reduction::none, Reduction::calls, Reduction::order, Reduction::full}) {
    CheckRequest request;
    request.properties = {race.property};
    request.options.reduction = reduction;
    const CheckReport report = check_system(system, engine, request);
    const std::string found = to_string(report.properties.at(0).verdict);
    if (!common.empty() && common != found) return common + ", and " + found;
    common = found;
  }
  return common;
}

class RacingSystems : public testing::TestWithParam<RacingSystem> {};

TEST_P(RacingSystems, HaveTheVerdictsThatTheyMustHave) {
  const RacingSystem& race = GetParam();
  EXPECT_EQ(verdict_on(race, race.text, Deliveries::at_rest), race.at_once);
  EXPECT_EQ(verdict_on(race, race.text, Deliveries::as_said), race.late);
  const std::string own = std::regex_replace(race.text, std::regex(", pub-depth: \\d+"), "");
  const std::string ten =
      std::regex_replace(own, std::regex("\\{depth: (\\d+)"), "{depth: $1, pub-depth: 10");
  EXPECT_EQ(verdict_on(race, ten, Deliveries::as_said), race.keeps_ten);
}

INSTANTIATE_TEST_SUITE_P(All, RacingSystems, testing::ValuesIn(racing_systems),
                         [](const testing::TestParamInfo<RacingSystem>& race) {
                           return std::string(race.param.name) + "_" + race.param.property;
                         });

}  // namespace
}  // namespace maide
