// Mutexes that their holder may lock again, `trylock`, and conditions.
#include "maide/check/rules/locks.hpp"

#include <gtest/gtest.h>

#include <string>

#include "maide/check/build/system_file.hpp"
#include "maide/check/engines/engine.hpp"
#include "maide/check/verdict/check_system.hpp"
#include "systems.hpp"
#include "verdict_cases.hpp"

namespace maide {
namespace {

using test::H;
using test::V;

// With a step of that label at its end, unless it has one.
std::string marked(const std::string& program, const std::string& label) {
  return program.find("@" + label) != std::string::npos ? program
                                                        : program + " @" + label + " skip;";
}

// Two programs at one mutex.
std::string two(const std::string& with, const std::string& a, const std::string& b) {
  return "models: {m: {use: mutex" + with + "}}\nvariables: \"var n: 0..3;\"\nprograms:\n  a: \"" +
         marked(a, "in") + "\"\n  b: \"" + marked(b, "in") +
         "\"\nproperties:\n  apart: {always: \"!(a@in && b@in)\"}\n  comes: \"F b@in\"\n"
         "  locks: \"G !b:m.lock\"\n";
}
const std::string recursive = ", with: {recursive: true}";
const std::string once = "m.lock; @in skip; m.unlock;";
const std::string twice = "m.lock; m.lock; @in skip; m.unlock; m.unlock;";
const std::string tries = "switch m.trylock { yes { m.unlock; } no { @in skip; } }";

// A consumer that waits until something is there, and a producer.
std::string condition(const std::string& consumer, const std::string& producer,
                      const std::string& with = "") {
  return "models:\n  m: {use: mutex" + with +
         "}\n  cv: {use: condition, with: {mutex: m}}\nvariables: \"var ready: bool;\"\nprograms:\n"
         "  c: \"" +
         marked(consumer, "done") + "\"\n  p: \"" + producer +
         "\"\nproperties:\n  done: {ltl: \"F c@done\", fairness: strong}\n  early: {always: "
         "\"c@done -> ready\"}\n";
}
const std::string waits = "m.lock; while (!ready) { cv.wait; } @done skip; m.unlock;";
const std::string waits_once = "m.lock; if (!ready) { cv.wait; } @done skip; m.unlock;";
const std::string tells = "m.lock; ready = true; m.unlock; cv.notify_one;";

// Two wait, and so many are told.
std::string two_wait(const std::string& notification) {
  return "models:\n  m: {use: mutex}\n  cv: {use: condition, with: {mutex: m}}\n"
         "variables: \"var ready: bool;\"\nprograms:\n  a[i in 0..1]: \"m.lock; while (!ready) { "
         "cv.wait; } m.unlock;\"\n  p: \"m.lock; ready = true; m.unlock; cv." +
         notification + ";\"\n";
}

// A driver: its thread reads, its callback waits until something was read.
std::string driver(const std::string& callback, const std::string& executor,
                   const std::string& group = "") {
  return R"yaml(
topics: {goal: {writers: world, readers: robot, use: queue, with: {depth: 1}}}
models:
  m: {use: mutex}
  cv: {use: condition, with: {mutex: m}}
programs: {world: "goal.write;"}
executors: {main: )yaml" +
         executor + R"yaml(}
nodes:
  robot:
    executor: main
    groups: {own: exclusive}
    variables: "var data: bool;"
    callbacks:
      on_goal: {takes: goal.read)yaml" +
         group + R"yaml(, do: ")yaml" + callback + R"yaml("}
      tick: {timer: once 10, do: "m.lock; data = true; m.unlock; cv.notify_all;"}
    threads:
      reader: "m.lock; while (!data) { idle cv.wait; } @read skip; m.unlock;"
properties: {got: {ltl: "F robot@got", fairness: strong}}
)yaml";
}
const std::string until_data = "m.lock; while (!data) { cv.wait; } @got skip; m.unlock;";
const std::string with_time_out =
    "m.lock; while (!data) { cv.wait timeout 100 { m.unlock; return; } } m.unlock; @got skip;";

const test::VerdictCase lock_systems[] = {
    {"plain_twice", "deadlock", V, two("", twice, once)},
    {"recursive_twice", "deadlock", H, two(recursive, twice, once)},
    {"recursive_twice", "apart", H, two(recursive, twice, once)},
    {"recursive_twice", "comes", H, two(recursive, twice, once)},
    {"recursive_twice", "locks", V, two(recursive, twice, once)},
    {"recursive_false", "deadlock", V, two(", with: {recursive: false}", twice, once)},
    {"one_lock_left", "deadlock", V, two(recursive, "m.lock; m.lock; m.unlock; @in skip;", once)},
    {"unlocked_by_another", "error", V, two(recursive, "m.lock;", "m.unlock;")},
    {"unlocked_free", "error", V, two(recursive, "m.unlock;", "skip;")},
    {"plain_unlocked_by_another", "error", H, two("", "m.lock;", "m.unlock;")},
    {"eight", "error", H, two(recursive, "repeat 8 { m.lock; } repeat 8 { m.unlock; }", once)},
    {"eight", "deadlock", H, two(recursive, "repeat 8 { m.lock; } repeat 8 { m.unlock; }", once)},
    {"nine", "error", V, two(recursive, "repeat 9 { m.lock; }", "skip;")},
    {"tries", "deadlock", H, two("", once, tries)},
    {"tries", "apart", V, two("", once, tries)},
    {"tries_recursive", "apart", V, two(recursive, once, tries)},
    {"tries_recursive", "deadlock", H, two(recursive, once, tries)},
    {"tries_own", "deadlock", H,
     two(recursive,
         "m.lock; switch m.trylock { yes { m.unlock; } no { @in skip; stop; } } "
         "m.unlock;",
         once)},
    {"tries_own_plain", "apart", V,
     two("", "m.lock; switch m.trylock { yes { stop; } no { @in skip; } } m.unlock;",
         "m.trylock -> no; @in skip;")},
    {"lock_in_select", "apart", H,
     two(recursive, "select { on m.lock { @in skip; m.unlock; } timeout 5 { } }", once)},
    {"try_in_select", "deadlock", H,
     two(recursive, "select { on m.trylock { yes { m.unlock; } no { } } }", once)},
    {"nine_in_select", "error", V,
     two(recursive, "repeat 8 { m.lock; } select { on m.lock { } otherwise { } }", "skip;")},
    // Conditions.
    {"waits", "deadlock", H, condition(waits, tells)},
    {"waits", "done", H, condition(waits, tells)},
    {"waits", "early", H, condition(waits, tells)},
    {"waits", "stuck", H, condition(waits, tells)},
    {"waits_recursive", "done", H, condition(waits, tells, recursive)},
    // It may wake by itself, and that is no progress.
    {"waits_once", "early", V, condition(waits_once, tells)},
    {"waits_once", "deadlock", H, condition(waits_once, tells)},
    {"told_too_early", "deadlock", V, condition(waits, "ready = true; cv.notify_one;")},
    {"never_told", "deadlock", V, condition(waits, "m.lock; ready = true; m.unlock;")},
    {"never_told", "stuck", V,
     condition(waits, "m.lock; ready = true; m.unlock; loop { m.lock; m.unlock; }")},
    {"late", "deadlock", H,
     condition("m.lock; while (!ready) { cv.wait timeout 5 { m.unlock; stop; } } @done skip; "
               "m.unlock;",
               "m.lock; ready = true; m.unlock;")},
    {"late_has_the_mutex", "deadlock", V,
     condition("m.lock; while (!ready) { cv.wait timeout 5 { m.lock; } } m.unlock;", "skip;")},
    {"not_locked", "error", V, condition("cv.wait;", "skip;")},
    {"locked_by_another", "error", V, condition("cv.wait;", "m.lock;", recursive)},
    {"locked_twice", "deadlock", V,
     condition("m.lock; m.lock; cv.wait; m.unlock; m.unlock;", "m.lock; cv.notify_one; m.unlock;",
               recursive)},
    {"one_is_told", "deadlock", V, two_wait("notify_one")},
    {"all_are_told", "deadlock", H, two_wait("notify_all")},
    {"driver_on_one_thread", "deadlock", V, driver(until_data, "{kind: single}")},
    {"driver_with_time_out", "deadlock", H, driver(with_time_out, "{kind: single}")},
    {"driver_in_two_groups", "deadlock", H,
     driver(until_data, "{kind: multi, threads: 2}", ", group: own")},
    // Its loop ends on fair runs.
    {"driver_in_two_groups", "stuck", H,
     driver(until_data, "{kind: multi, threads: 2}", ", group: own")},
    {"driver_goes_round", "stuck", "inconclusive",
     driver("while (!data) { m.lock; m.unlock; data = false; } @got skip;",
            "{kind: multi, threads: 2}", ", group: own")},
    {"driver_in_one_group", "deadlock", V, driver(until_data, "{kind: multi, threads: 2}")},
};

class LockSystems : public testing::TestWithParam<test::VerdictCase> {};

TEST_P(LockSystems, HaveTheVerdictsThatTheyMustHave) { test::expect_verdict(GetParam()); }

INSTANTIATE_TEST_SUITE_P(All, LockSystems, testing::ValuesIn(lock_systems), test::name_of);

std::string error_of(const std::string& models, const std::string& program) {
  const std::string text = "models: {" + models + "}\nprograms: {a: \"" + program + "\"}\n";
  return test::error_of([&] { parse_system(text, "s.yaml", test::test_model); });
}

TEST(Locks, SlipsAreNamedWithTheirPlace) {
  EXPECT_EQ(error_of("m: {use: mutex, with: {recursive: yes}}", "m.lock;"),
            "'recursive' is 'true' or 'false' (s.yaml:1:44)");
  EXPECT_EQ(error_of("cv: {use: condition}", "cv.wait;"),
            "a condition needs 'with: {mutex: NAME}' (s.yaml:1:20)");
  EXPECT_EQ(error_of("cv: {use: condition, with: {mutex: m}}", "cv.wait;"),
            "there is no mutex 'm' (s.yaml:1:45)");
  EXPECT_EQ(error_of("q: {use: queue, with: {size: 1}}, cv: {use: condition, with: {mutex: q}}",
                     "cv.wait;"),
            "'q' is no mutex (s.yaml:1:79)");
  EXPECT_EQ(
      error_of("'m[i in 0..1]': {use: mutex}, cv: {use: condition, with: {mutex: m}}", "cv.wait;"),
      "a condition has one mutex: say which (s.yaml:1:75)");
  EXPECT_EQ(error_of("m: {use: mutex}, cv: {use: condition, with: {mutex: m}}",
                     "select { on cv.wait { } }"),
            "'wait' of a condition is no arm: it stands alone (s.yaml:2:31)");
  EXPECT_EQ(error_of("m: {use: mutex}, cv: {use: condition, with: {mutex: m}}",
                     "switch cv.wait { quiet { } }"),
            "the `wait` of a condition brings nothing: write `cv.wait;` (s.yaml:2:26)");
  EXPECT_EQ(test::error_of([&] {
              parse_system(
                  "topics: {t: {writers: a, readers: b, use: mutex, with: {recursive: "
                  "true}}}\nprograms: {a: \"t.lock;\", b: \"t.unlock;\"}\n",
                  "s.yaml", test::test_model);
            }),
            "a topic is no mutex that knows who holds it (s.yaml:1:10)");
  EXPECT_EQ(error_of("m: {use: mutex}", "m.lock timeout 5 { }"),
            "'timeout' stands behind the `wait` of a condition, or in a 'select' (s.yaml:2:23)");
}

// Each of two members has the mutex of its number.
TEST(Locks, ConditionsMayBeArrays) {
  const std::string text =
      "models:\n  m[i in 0..1]: {use: mutex}\n"
      "  cv[i in 0..1]: {use: condition, with: {mutex: \"m[i]\"}}\n"
      "programs:\n  a[i in 0..1]: \"m[i].lock; cv[i].wait timeout 5 { } m[i].unlock;\"\n";
  const System system = parse_system(text, "s.yaml", test::test_model);
  NativeEngine engine;
  EXPECT_EQ(check_system(system, engine, {}).verdict, Verdict::holds);
}

// A state for each way in which each of the programs that wait there can stand.
TEST(Locks, OnlyWhoWaitsCosts) {
  EXPECT_EQ(make_condition(2).size(), 9u);
  EXPECT_EQ(make_recursive_mutex(2, false).size(), 17u);
  const System system =
      parse_system(condition(waits, tells + " cv.notify_all; m.lock; m.unlock;", recursive),
                   "s.yaml", test::test_model);
  for (const ModelInstance& model : system.models) {
    if (model.name == "cv") EXPECT_EQ(model.automaton.size(), 3u);
    if (model.name == "m") EXPECT_EQ(model.automaton.size(), 17u);
  }
}

}  // namespace
}  // namespace maide
