// An input and its answer as one step: what is saved, and one system for each rule that says where
// that may be.
#include "maide/check/reduce/merged_calls.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "maide/check/engines/engine.hpp"
#include "systems.hpp"

namespace maide {
namespace {

PropertyResult check(const System& system, const Property& property, Reduction reduction) {
  EngineOptions options;
  options.reduction = reduction;
  return NativeEngine().check(system, property, options);
}

Property stuck() {
  Property property;
  property.name = "stuck";
  property.kind = Property::Kind::stuck;
  return property;
}

// The same verdict with calls merged as without.
void expect_verdict(const System& system, const Property& property, Verdict verdict) {
  for (const Reduction reduction : {Reduction::none, Reduction::calls, Reduction::full}) {
    EXPECT_EQ(check(system, property, reduction).verdict, verdict) << to_string(reduction);
  }
}

// Robots of a camera, a tracker and a controller, over queues of one message.
System robots(int count, const std::string& properties = "") {
  const std::string last = std::to_string(count - 1);
  return parse_system("models:\n  image[i in 0.." + last +
                          "]: {use: queue, with: {size: 1}}\n  pose[i in 0.." + last +
                          "]: {use: queue, with: {size: 1}}\nprograms:\n  camera[i in 0.." + last +
                          "]: \"loop { image[i].write; }\"\n  tracker[i in 0.." + last +
                          "]: \"loop { @reads image[i].read -> message; @has pose[i].write; }\"\n"
                          "  controller[i in 0.." +
                          last + "]: \"loop { pose[i].read -> message; }\"\n" + properties,
                      "robots.yaml");
}

// A model, `box`, whose steps are "from ?input to" or "from !output to", each in three words.
struct BoxStep {
  StateId from;
  std::string action;
  StateId to;
};

System box_system(std::size_t states, const std::vector<BoxStep>& steps, const std::string& rest) {
  Alphabet inputs, outputs;
  for (const BoxStep& step : steps) {
    (step.action[0] == '?' ? inputs : outputs).intern(step.action.substr(1));
  }
  InterfaceAutomaton automaton(inputs, outputs, states);
  for (const BoxStep& step : steps) {
    const bool is_input = step.action[0] == '?';
    const std::string name = step.action.substr(1);
    automaton.add_transition(step.from,
                             {is_input ? Action::Kind::input : Action::Kind::output,
                              *(is_input ? inputs : outputs).find(name)},
                             step.to);
  }
  return parse_system("models:\n  box: {file: model.dot}\n" + rest, "system.yaml",
                      [&](const ModelRequest&) { return automaton; });
}

enum : StateId { empty, full, waiting, due };

// A box for one message.
std::vector<BoxStep> mailbox() {
  return {{empty, "?write", full},
          {empty, "?read", waiting},
          {waiting, "?write", due},
          {full, "?read", due},
          {due, "!message", empty}};
}

TEST(MergedCalls, ARobotHasAThirdOfItsStates) {
  const System one = robots(1);
  EXPECT_EQ(check(one, test::deadlock_property(), Reduction::none).states, 24u);
  const PropertyResult result = check(one, test::deadlock_property(), Reduction::calls);
  EXPECT_EQ(result.verdict, Verdict::holds);
  EXPECT_EQ(result.reduction, Reduction::calls);
  EXPECT_EQ(result.states, 8u);
}

// What is done again and again is one kind of call. Each kind is an action of the model, and a
// model with more than 64 actions is left alone by the reductions that follow.
TEST(MergedCalls, RoundsOfARepeatAreOneKindOfCall) {
  const System system = parse_system(
      "models:\n  q: {use: queue, with: {size: 2}}\nprograms:\n  a: \"repeat 40 { q.write; }\"\n"
      "  b: \"repeat 40 { q.read -> message; }\"\n",
      "rounds.yaml");
  const MergedCalls merged(system, {});
  EXPECT_FALSE(merged.is_empty());
  EXPECT_LE(merged.system().models[0].actions.size(), 2u);
  const System robot = robots(1);
  EXPECT_TRUE(MergedCalls::has_calls(robot));
  EXPECT_FALSE(MergedCalls::has_calls(parse_system(
      "models:\n  q: {use: queue, with: {size: 2}}\nprograms:\n  a: \"loop { q.write; }\"\n",
      "s.yaml")));
}

TEST(MergedCalls, FourRobotsInOneSearch) {
  const System four = robots(4);
  EXPECT_EQ(check(four, test::deadlock_property(), Reduction::none).states, 331'776u);
  EXPECT_EQ(check(four, test::deadlock_property(), Reduction::calls).states, 4'096u);
  EXPECT_EQ(check(robots(2), stuck(), Reduction::calls).verdict, Verdict::holds);
}

TEST(MergedCalls, WhatIsShownHasBothSteps) {
  const System system = robots(1, "properties:\n  never: {always: '!tracker[0]@has'}\n");
  const PropertyResult result = check(system, system.properties[0], Reduction::calls);
  ASSERT_EQ(result.verdict, Verdict::violated);
  std::vector<ModelUse::Kind> kinds;
  for (const Step& step : result.trace->steps) {
    kinds.push_back(edge_of(system, step).kind);
  }
  using Kind = ModelUse::Kind;
  EXPECT_EQ(kinds.size(), 3u);
  EXPECT_EQ(std::count(kinds.begin(), kinds.end(), Kind::take), 1);
  EXPECT_EQ(std::count(kinds.begin(), kinds.end(), Kind::give), 2);
}

// Nobody writes. The run that is shown ends with the reading.
TEST(MergedCalls, WhoWaitsInTheEndHasGivenItsInput) {
  const System system = box_system(
      4, mailbox(), "programs:\n  p: box.read -> message;\n  q: 'if * { stop; } box.write;'\n");
  const PropertyResult result = check(system, test::deadlock_property(), Reduction::calls);
  ASSERT_EQ(result.verdict, Verdict::violated);
  EXPECT_EQ(result.reduction, Reduction::calls);
  EXPECT_EQ(result.trace->steps.size(), 2u);
  EXPECT_TRUE(is_deadlock(system, replay(system, *result.trace).back()));
}

// What may die still, may die there; that it does is not waited for.
TEST(MergedCalls, WhoWaitsInTheEndHasGivenItsInputWhereOthersMayDie) {
  const System system = box_system(4, mailbox(), R"yaml(variables: 'var go: bool;'
programs:
  p: box.read -> message; go = true;
  q: 'if * { stop; } box.write;'
  r: {may_die: true, do: 'select { when (go) { } }'}
)yaml");
  const PropertyResult result = check(system, test::deadlock_property(), Reduction::calls);
  ASSERT_EQ(result.verdict, Verdict::violated);
  EXPECT_EQ(result.reduction, Reduction::calls);
  EXPECT_TRUE(is_deadlock(system, replay(system, *result.trace).back()));
}

TEST(MergedCalls, NotWhereAFormulaTellsTheStepsApart) {
  const std::string next = "properties:\n  next: {ltl: 'G (image[0].read -> X !image[0].write)'}\n";
  const System with_next = robots(1, next);
  EXPECT_EQ(check(with_next, with_next.properties[0], Reduction::calls).reduction, Reduction::none);
  const System both =
      robots(1,
             "properties:\n  both: {ltl: 'G (image[0].read -> F image[0]!message)'}\n"
             "  one: {ltl: 'G (image[0].write -> F image[0]!message)'}\n");
  const PropertyResult result = check(both, both.properties[0], Reduction::calls);
  const PropertyResult one = check(both, both.properties[1], Reduction::calls);
  EXPECT_EQ(result.reduction, Reduction::calls);  // of the controller's calls
  EXPECT_LT(one.states, result.states);
  EXPECT_EQ(result.verdict, check(both, both.properties[0], Reduction::none).verdict);
  EXPECT_EQ(one.verdict, check(both, both.properties[1], Reduction::none).verdict);
}

// Both take each other's messages.
TEST(MergedCalls, NotWhereOthersCanTakeTheAnswer) {
  const System system = box_system(4, mailbox(),
                                   "programs:\n  p: box.read -> message;\n  q: 'loop { box.read -> "
                                   "message; }'\n  r: 'loop { box.write; }'\n");
  EXPECT_EQ(check(system, test::deadlock_property(), Reduction::calls).reduction, Reduction::none);
}

// A write takes place while somebody reads, and never before.
TEST(MergedCalls, NotPutOffWhereItMakesSomethingPossible) {
  const System system =
      box_system(3, {{0, "?read", 1}, {1, "?write", 2}, {2, "!message", 0}},
                 "programs:\n  p: 'loop { box.read -> message; }'\n  q: 'loop { box.write; }'\n");
  expect_verdict(system, test::deadlock_property(), Verdict::holds);
  expect_verdict(system, stuck(), Verdict::holds);
}

// The box always has an answer. While it is due nobody can write: again and again the writer cannot
// step, and so it need not on a run that is weakly fair.
TEST(MergedCalls, WhoIsLockedOutInTheMiddleIsNotTreatedUnfairly) {
  const System system = box_system(
      2, {{0, "?read", 1}, {1, "!message", 0}, {0, "?write", 0}},
      "programs:\n  p: 'loop { box.read -> message; }'\n  q: box.write;\n"
      "properties:\n  weak: {ltl: F q@end}\n  strong: {ltl: F q@end, fairness: strong}\n");
  EXPECT_EQ(check(system, system.properties[0], Reduction::calls).reduction, Reduction::calls);
  expect_verdict(system, system.properties[0], Verdict::violated);
  expect_verdict(system, system.properties[1], Verdict::holds);
}

// A reader that waits gets what is written. One whose input is put off could come too late each
// time.
TEST(MergedCalls, NotPutOffWhereTheAnswerMayGoAway) {
  std::vector<BoxStep> steps = mailbox();
  steps.push_back({full, "?clear", empty});
  const System system =
      box_system(4, steps,
                 "programs:\n  p: box.read -> message;\n  q: 'loop { box.write; box.clear; }'\n"
                 "properties:\n  weak: {ltl: F p@end}\n");
  expect_verdict(system, system.properties[0], Verdict::holds);
}

// Where the reader always waits before the writer comes, nobody can look into the box.
TEST(MergedCalls, NotPutOffWhereTheCallTakesSomethingFromOthers) {
  std::vector<BoxStep> steps = mailbox();
  steps.push_back({full, "?peek", full});
  const System system = box_system(4, steps,
                                   "programs:\n  p: 'loop { box.read -> message; }'\n  q: 'loop { "
                                   "box.write; }'\n  r: box.peek;\n"
                                   "properties:\n  looks: {ltl: F r@end, fairness: strong}\n");
  expect_verdict(system, system.properties[0], Verdict::violated);
  expect_verdict(system, stuck(), Verdict::violated);
}

// Who waits elsewhere as well cannot be told from who is locked out.
TEST(MergedCalls, NotOnFairRunsWhereOthersWaitForSeveralThings) {
  const System system = parse_system(
      "models:\n  box: {use: queue, with: {size: 1}}\n  other: {use: queue, with: {size: 1}}\n"
      "programs:\n  p: 'loop { box.read -> message; }'\n"
      "  q: 'loop { select { on box.write { } on other.write { } } }'\n"
      "  r: 'loop { other.read -> message; }'\n"
      "properties:\n  served: {ltl: G F box.write}\n",
      "system.yaml");
  const PropertyResult fair = check(system, system.properties[0], Reduction::calls);
  EXPECT_EQ(fair.reduction, Reduction::none);
  EXPECT_EQ(fair.verdict, check(system, system.properties[0], Reduction::none).verdict);
  EXPECT_EQ(check(system, test::deadlock_property(), Reduction::calls).reduction, Reduction::calls);
}

}  // namespace
}  // namespace maide
