// Processes that die and begin anew: by themselves, by `kill` and `restart`, by `end`.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "maide/base/error.hpp"
#include "maide/check/build/system_file.hpp"
#include "systems.hpp"
#include "verdict_cases.hpp"

namespace maide {
namespace {

using test::H;
using test::V;

const std::string cmd = "services: {cmd: {server: s, clients: [p]}}\n";
const std::string serves = "loop { idle cmd.serve -> request; cmd.answer; }";

// A program that asks, one that serves, and one that does something to one of them.
std::string with_killer(const std::string& client, const std::string& killer,
                        const std::string& more = "", const std::string& server = serves) {
  return cmd + "programs:\n  s: {do: \"" + server + "\"" + more + "}\n  p: \"" + client +
         "\"\n  k: \"" + killer +
         "\"\nproperties:\n  got: {ltl: \"F p@got\", fairness: strong}\n"
         "  may_get: {possible: \"p@got\"}\n";
}
const std::string asks_once = "cmd.send; cmd.receive -> answer; @got skip;";
// Who asks when the killer has done what it does.
std::string asks_behind(const std::string& killer) {
  return "variables: \"var told: bool;\"\n" +
         with_killer("select { when (told) {} } " + asks_once, killer + " told = true;");
}

// Each life of the process writes one message.
std::string lives(const std::string& more) {
  return "models: {q: {use: queue, with: {size: 5}}}\nprograms:\n  s: {do: \"q.write;\"" + more +
         "}\n  p: \"var n: 0..5; loop { idle q.read -> message; n = n + 1; }\"\n"
         "properties:\n  two: {possible: \"p.n == 2\"}\n  three: {possible: \"p.n == 3\"}\n";
}

// A node that serves, on that executor.
std::string served_by_node(const std::string& executor) {
  return "services: {cmd: {server: driver, clients: [p]}}\n"
         "executors: {e: {" +
         executor +
         "}}\nnodes:\n  driver:\n    executor: e\n    variables: \"var n: 0..3;\"\n"
         "    callbacks:\n"
         "      serve: {serves: cmd, do: \"@served n = 1; cmd.answer;\"}\n"
         "      fresh: {timer: once 5, when: \"n == 0\", do: \"@fresh skip;\"}\n"
         "programs: {p: \"cmd.send; cmd.receive -> answer; @got skip;\"}\nproperties:\n"
         "  stays: \"G (driver@served -> G !driver@fresh)\"\n"
         "  got: {ltl: \"F p@got\", fairness: strong}\n";
}

// Two programs, of which one says that it may die.
std::string together(const std::string& process) {
  return "programs:\n  a: {do: \"skip;\", may_die: true" + process +
         "}\n  b: {do: \"loop { select { " + "timeout 5 { @x skip; } } }\"" + process +
         "}\nproperties:\n  goes_on: {ltl: \"G F b@x\", fairness: strong}\n";
}

// Two programs of one process, and one that kills it.
std::string labels_of_the_dead(const std::string& more) {
  const std::string does = "{do: \"@begins skip; @stands loop { idle q.read -> message; }\"";
  return "models: {q: {use: queue, with: {size: 1}}}\nprograms:\n  a: " + does +
         ", process: d, may_die: true" + more + "}\n  b: " + does +
         ", process: d}\n  k: \"select { when (go) {} } kill d; @after skip;\"\n"
         "variables: \"var go: bool = true;\"\nproperties:\n"
         "  gone: \"G (k@after -> !(a@stands && b@end) && !(a@end && b@stands))\"\n"
         "  both: \"G (a@end <-> b@end)\"\n"
         "  done: \"G (k@after -> a@end)\"\n"
         "  in_the_end: {ltl: \"F (k@after -> F (k@end || a@begins))\", fairness: strong}\n";
}
const std::string kills_again_and_again = R"(
programs:
  s: "@begins skip; select { timeout 5 { } } @stands skip;"
  k: "loop { restart s; }"
properties:
  anew: {ltl: "G F s@begins", fairness: strong}
)";

// What it alone has is as in the beginning from its death on; `n` is in no scope there.
const std::string variables_of_the_dead = R"(
variables: "var mine: 0..5 = 2; var other: 0..5 = 2;"
programs:
  s: "mine = 3; other = 3; mine = 4; var n: 0..1 = 1; select { when (other == 5) { } }"
  k: "select { when (other == 3) { } } kill s; @after skip; other = 4;"
properties:
  first: {possible: "k@after && s.n < 2"}
  other: 'G (k@after -> other == 3)'
  mine: 'G (k@after -> mine == 2)'
)";

// Who asks begins anew behind its request, which is answered then.
std::string asks_anew(const std::string& killer) {
  return cmd +
         "variables: \"var served: bool; var told: bool;\"\nprograms:\n"
         "  s: \"cmd.serve -> request; served = true; select { when (told) {} } cmd.answer;\"\n"
         "  p: \"cmd.send; cmd.receive -> answer; @got skip;\"\n  k: \"select { when (served) {} "
         "} " +
         killer + " told = true;\"\nproperties: {may_get: {possible: \"p@got\"}}\n";
}

// A server that goes, and one that notices.
std::string notices(const std::string& goes, const std::string& more = "") {
  return cmd + "programs:\n  s: {do: \"offer cmd; " + goes + "\"" + more +
         "}\n  p: \"wait cmd -> there; @was select { when (!cmd.there) { @gone skip; } }\"\n"
         "properties:\n  notices: {ltl: \"G (p@was -> F p@gone)\", fairness: strong}\n"
         "  later: {possible: \"s@last && cmd.there\"}\n";
}

// A thread that waits at a condition, in a process that may die beside another.
const std::string waits_at_condition =
    "models: {m: {use: mutex}, cv: {use: condition, with: {mutex: m}}}\n"
    "executors: {e: {kind: single, may_die: true}}\nnodes:\n  driver:\n    executor: e\n"
    "    callbacks: {tick: {timer: once 5, do: \"m.lock; cv.notify_one; m.unlock;\"}}\n"
    "    threads: {work: \"m.lock; cv.wait; m.unlock; @done skip;\"}\n"
    "programs: {p: \"skip;\"}\nproperties: {done: {possible: \"driver.work@done\"}}\n";

// A thread restarts its own process, which serves and asks its own service.
const std::string restarts_itself =
    "services: {own: {server: n, clients: [n], delivery: at_once}}\n"
    "executors: {e: {kind: multi, threads: 2}}\nnodes:\n  n:\n    executor: e\n"
    "    groups: {g: reentrant}\n    clients: {own: g}\n    callbacks:\n"
    "      serve: {serves: own, group: g, do: \"own.answer;\"}\n"
    "    threads: {work: \"own.send; wait own -> answer; @got restart e;\"}\n"
    "properties: {got: {possible: \"n.work@got\"}}\n";
// Who is killed waits for an answer that is due to it.
const std::string dies_as_it_is_due =
    "services: {cmd: {server: s, clients: [p], delivery: at_once}}\nprograms:\n"
    "  s: \"cmd.serve -> request; cmd.answer;\"\n  p: \"cmd.send; cmd.receive -> answer; @got "
    "skip;\"\n"
    "  k: \"restart p;\"\nproperties: {got: {possible: \"p@got\"}}\n";

class LivesTest : public testing::TestWithParam<test::VerdictCase> {};

TEST_P(LivesTest, HasTheVerdict) { test::expect_verdict(GetParam()); }

INSTANTIATE_TEST_SUITE_P(
    Lives, LivesTest,
    testing::Values(
        test::VerdictCase{"nobody_dies", "got", H, with_killer(asks_once, "skip;")},
        test::VerdictCase{"killed", "deadlock", V, with_killer(asks_once, "kill s;")},
        test::VerdictCase{"killed", "may_get", H, with_killer(asks_once, "kill s;")},
        test::VerdictCase{"killed_twice", "deadlock", H,
                          with_killer("skip; @got skip;", "kill s; kill s;")},
        test::VerdictCase{"restarted", "got", V, with_killer(asks_once, "restart s;")},
        test::VerdictCase{"asks_a_dead_one", "may_get", V, asks_behind("kill s;")},
        test::VerdictCase{"asks_a_new_one", "may_get", H, asks_behind("restart s; restart s;")},
        test::VerdictCase{"asks_one_told_to_begin", "may_get", H,
                          asks_behind("restart s; kill s;")},
        test::VerdictCase{"kills_itself", "may_get", V,
                          with_killer("@a kill p; @got skip;", "skip;")},
        test::VerdictCase{"one_life", "two", V, lives(", may_die: true")},
        test::VerdictCase{"two_lives", "two", H, lives(", may_die: true, may_restart: true")},
        test::VerdictCase{"two_lives", "three", V, lives(", may_die: true, may_restart: true")},
        test::VerdictCase{"three_lives", "three", H, lives(", may_die: true, may_restart: 2")},
        test::VerdictCase{"single", "stays", H, served_by_node("kind: single, may_die: true")},
        test::VerdictCase{"single_anew", "stays", V,
                          served_by_node("kind: single, may_die: true, may_restart: true")},
        test::VerdictCase{"multi", "stays", H,
                          served_by_node("kind: multi, threads: 2, may_die: true")},
        test::VerdictCase{"multi", "deadlock", V,
                          served_by_node("kind: multi, threads: 2, may_die: true")},
        test::VerdictCase{"multi_lives", "got", H, served_by_node("kind: multi, threads: 2")},
        test::VerdictCase{
            "multi_anew", "stays", V,
            served_by_node("kind: multi, threads: 2, may_die: true, may_restart: true")},
        test::VerdictCase{"labels", "gone", H, labels_of_the_dead("")},
        test::VerdictCase{"labels", "both", H, labels_of_the_dead("")},
        test::VerdictCase{"labels", "done", H, labels_of_the_dead("")},
        test::VerdictCase{"labels_anew", "gone", H, labels_of_the_dead(", may_restart: true")},
        test::VerdictCase{"labels_anew", "both", H, labels_of_the_dead(", may_restart: true")},
        test::VerdictCase{"labels_anew", "done", V, labels_of_the_dead(", may_restart: true")},
        test::VerdictCase{"labels_anew", "in_the_end", H,
                          labels_of_the_dead(", may_restart: true")},
        test::VerdictCase{"killed_again_and_again", "stuck", H, kills_again_and_again},
        test::VerdictCase{"killed_again_and_again", "anew", H, kills_again_and_again},
        test::VerdictCase{"variables_of_the_dead", "first", V, variables_of_the_dead},
        test::VerdictCase{"variables_of_the_dead", "other", H, variables_of_the_dead},
        test::VerdictCase{"variables_of_the_dead", "mine", H, variables_of_the_dead},
        test::VerdictCase{"alone", "goes_on", H, together("")},
        test::VerdictCase{"together", "goes_on", V, together(", process: x")},
        test::VerdictCase{"together", "deadlock", H, together(", process: x")},
        test::VerdictCase{"not_anew", "may_get", H, asks_anew("skip;")},
        test::VerdictCase{"anew", "may_get", V, asks_anew("restart p;")},
        test::VerdictCase{"ends", "notices", H, notices("@last end;")},
        test::VerdictCase{"killed_by_itself", "notices", H, notices("@last kill s;")},
        test::VerdictCase{"stays_there", "notices", V, notices("@last skip;")},
        test::VerdictCase{"restarts_itself", "got", H, restarts_itself},
        test::VerdictCase{"dies_as_it_is_due", "got", H, dies_as_it_is_due},
        test::VerdictCase{"dies_as_it_is_due", "deadlock", V, dies_as_it_is_due},
        test::VerdictCase{"waits_at_condition", "deadlock", V, waits_at_condition},
        test::VerdictCase{"waits_at_condition", "done", H, waits_at_condition}),
    test::name_of);

std::string error_of(const std::string& text) {
  try {
    parse_system(text, "s.yaml", test::test_model);
  } catch (const ParseError& error) {
    return error.what();
  }
  return "";
}

// What a death does is asked of all states that a service may have, also where nobody has died.
TEST(Lives, ServicesGrowWhoeverDies) {
  const std::string text = R"(
services: {f5: {server: n1, clients: [n1]}, f6: {server: p2, clients: [n1, p3]}}
executors: {e4: {kind: multi, threads: 2}}
nodes:
  n1:
    executor: e4
    groups: {g8: reentrant}
    variables: 'var v9: bool;'
    clients: {f6: g8}
    callbacks:
      b11: {serves: f5, group: g8, do: 'v9 = f5.there;'}
      b13: {timer: once 1, do: 'kill e4;'}
    threads: {w10: 'restart e4;'}
programs:
  p2:
    do: 'restart p3; loop { select { when (f6.there) { wait f6 -> there; } otherwise { } } }'
    may_die: true
    may_restart: 2
  p3: 'loop { wait f6 -> there; if * { break; } } kill p2;'
)";
  EXPECT_EQ(error_of(text), "");
}

TEST(Lives, SaysWhatIsWrong) {
  EXPECT_NE(error_of("programs: {a: \"kill b;\"}\n")
                .find("no executor, program or process is called 'b'; there is: a"),
            std::string::npos);
  EXPECT_NE(error_of("executors: {e: {kind: single}}\nprograms: {a: \"restart e;\"}\n")
                .find("nothing runs on executor 'e'"),
            std::string::npos);
  EXPECT_EQ(error_of("executors: {e: {kind: single, may_die: true, may_restart: true}}\n"
                     "programs: {a: \"skip;\"}\n"),
            "");
  EXPECT_NE(error_of("programs: {a: {do: \"skip;\", may_restart: true}}\n")
                .find("'may_restart' goes with 'may_die: true', or with a 'kill'"),
            std::string::npos);
  EXPECT_NE(error_of("programs: {a: {do: \"skip;\", may_die: true, may_restart: 0}}\n")
                .find("'may_restart' is true, or a number from 1 to 100"),
            std::string::npos);
}

}  // namespace
}  // namespace maide
