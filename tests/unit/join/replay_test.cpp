// Runs replayed on systems that do what their models say, and on others: where they leave the run,
// and what that says of the model.
#include "maide/join/replay.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "maide/check/engines/engine.hpp"
#include "maide/check/verdict/check_system.hpp"
#include "maide/formats/model_file.hpp"
#include "maide/join/real_system.hpp"
#include "maide/join/replay_plan.hpp"
#include "maide/sul/simulated_sul.hpp"

namespace maide {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

InterfaceAutomaton model(const std::string& name) {
  return read_interface_automaton(MAIDE_SOURCE_DIR "/tests/models/" + name + ".dot");
}

// One instance, `via`, of this model.
System system_of(const InterfaceAutomaton& via, const std::string& programs,
                 const std::string& when_unexplored = "stop", const std::string& properties = "") {
  return parse_system("models:\n  via: {file: via.dot, when_unexplored: " + when_unexplored +
                          "}\nprograms:\n" + programs +
                          (properties.empty() ? "" : "properties:\n" + properties),
                      "system.yaml", [&](const ModelRequest&) { return via; });
}

Trace find_trace(const System& system, const std::string& property = "deadlock") {
  NativeEngine engine;
  CheckRequest request;
  request.properties = {property};
  return check_system(system, engine, request).properties.front().trace.value();
}

// Plays the run where `sul` is what is behind `via`.
ReplayedRun play(const System& system, const Trace& trace, InterfaceAutomaton sul,
                 std::size_t loops = 3) {
  std::vector<std::unique_ptr<RealSystem>> real;
  real.push_back(std::make_unique<RealSystem>());
  real[0]->instance = "via";
  real[0]->sul = std::make_unique<SimulatedSul>(std::move(sul), "sim");
  for (const std::string& name : system.models[0].automaton.inputs().names()) {
    const auto& inputs = real[0]->sul->info().inputs;
    for (Symbol symbol = 0; symbol < inputs.size(); ++symbol) {
      if (inputs[symbol].name == name) real[0]->inputs.push_back(symbol);
    }
  }
  ReplayedRun result;
  play_on_real_system(system, real, {&trace, 1}, {loops, {}},
                      [&](std::size_t, ReplayedRun run) { result = std::move(run); });
  return result;
}

const std::string burst_of_two =
    "  planner: repeat 2 { via.write; }\n  controller: repeat 2 { via.read -> message; }\n";

TEST(Replay, FollowsADeadlockThatIsReal) {
  const System system = system_of(model("buffered"), burst_of_two);
  const Trace trace = find_trace(system);
  EXPECT_TRUE(ends_in_deadlock(system, trace));
  EXPECT_TRUE(find_assumptions(system, trace).empty());
  const ReplayedRun run = play(system, trace, model("buffered"));
  EXPECT_FALSE(run.deviation);
  EXPECT_EQ(run.steps, trace.steps.size());
  EXPECT_THAT(run.seen, ElementsAre("quiet", "quiet", "message", "", "quiet"));
}

TEST(Replay, SaysWhereASystemDoesOtherwise) {
  const System system = system_of(model("buffered"), burst_of_two);
  const ReplayedRun run = play(system, find_trace(system), model("strict-2"));
  ASSERT_TRUE(run.deviation);
  EXPECT_EQ(run.deviation->kind, Deviation::Kind::output);
  EXPECT_EQ(run.deviation->step, 4U);
  EXPECT_EQ(run.deviation->expected, "quiet");
  EXPECT_EQ(run.deviation->seen, "message");
  EXPECT_THAT(run.deviation->word, ElementsAre("write", "write", "read", "read"));
  EXPECT_TRUE(run.deviation->refutes_model());
  EXPECT_EQ(run.seen.back(), "message");
}

TEST(Replay, SeesAnOutputThatDoesNotCome) {
  const System system = system_of(model("strict-2"), burst_of_two, "stop",
                                  "  never: {always: \"!controller@end\"}\n");
  const ReplayedRun run = play(system, find_trace(system, "never"), model("buffered"));
  ASSERT_TRUE(run.deviation);
  EXPECT_EQ(run.deviation->expected, "message");
  EXPECT_EQ(run.deviation->seen, "quiet");
}

// The second write must be refused at the end: the first has not returned.
TEST(Replay, TriesTheCallsThatADeadlockIsMadeOf) {
  const System system = system_of(model("port"), "  planner: repeat 2 { via.write; }\n");
  const Trace trace = find_trace(system);
  EXPECT_FALSE(play(system, trace, model("port")).deviation);
  const ReplayedRun run = play(system, trace, model("buffered"));
  ASSERT_TRUE(run.deviation);
  EXPECT_EQ(run.deviation->kind, Deviation::Kind::deadlock);
  EXPECT_EQ(run.deviation->step, trace.steps.size());
  EXPECT_EQ(run.deviation->expected, "via.write is not possible");
  EXPECT_THAT(run.deviation->word, ElementsAre("write", "write"));
}

// The first write fills the port, and the next ones leave it full: one step is told, and each round
// is held against where the model is then.
TEST(Replay, PlaysALoopThatFillsAQueue) {
  const System system =
      system_of(model("buffered"), "  p: loop { via.write; }\n", "stop", "  ends: \"F p@end\"\n");
  const Trace trace = find_trace(system, "ends");
  ASSERT_EQ(trace.loop_start, 0U);
  ASSERT_EQ(trace.steps.size(), 1U);
  const ReplayedRun run = play(system, trace, model("buffered"), 4);
  EXPECT_FALSE(run.deviation);
  EXPECT_EQ(run.steps, 4U);
  const ReplayedRun blocked = play(system, trace, model("port"), 4);
  ASSERT_TRUE(blocked.deviation);
  EXPECT_GT(blocked.deviation->round, 0U);
}

// A queue that loses the third message: the loop goes on otherwise when it comes round again.
TEST(Replay, PlaysALoopSeveralTimes) {
  const System system =
      system_of(model("strict-2"), "  p: loop { via.write; via.read -> message; }\n", "stop",
                "  ends: \"F p@end\"\n");
  const Trace trace = find_trace(system, "ends");
  ASSERT_EQ(trace.loop_start, 0U);
  EXPECT_EQ(play(system, trace, model("strict-2"), 5).steps, 5 * trace.steps.size());

  InterfaceAutomaton tired(Alphabet{"write", "read"}, Alphabet{"message"}, 8);
  tired.actors = model("strict-2").actors;
  const Action write{Action::Kind::input, 0}, read{Action::Kind::input, 1},
      message{Action::Kind::output, 0};
  for (StateId round = 0; round < 2; ++round) {
    tired.add_transition(3 * round, write, 3 * round + 1);
    tired.add_transition(3 * round + 1, read, 3 * round + 2);
    tired.add_transition(3 * round + 2, message, 3 * round + 3);
  }
  tired.add_transition(6, write, 7);
  tired.add_transition(7, read, 7);
  const ReplayedRun run = play(system, trace, tired);
  ASSERT_TRUE(run.deviation);
  EXPECT_EQ(run.deviation->round, 2U);
  EXPECT_EQ(run.deviation->step, 1U);
  EXPECT_EQ(run.deviation->seen, "quiet");
  EXPECT_EQ(run.seen.size(), trace.steps.size());
  EXPECT_FALSE(play(system, trace, tired, 2).deviation);
}

TEST(Replay, TellsAnAnswerThatTheModelHasToo) {
  // A write that may be lost: whether it was shows at the read.
  InterfaceAutomaton lossy(Alphabet{"write", "read"}, Alphabet{"message", "null"}, 5);
  lossy.actors = {{"writer", {"write"}, {}}, {"reader", {"read"}, {"message", "null"}}};
  const Action write{Action::Kind::input, 0}, read{Action::Kind::input, 1};
  lossy.add_transition(0, write, 1);
  lossy.add_transition(1, read, 2);
  lossy.add_transition(1, read, 3);
  lossy.add_transition(2, {Action::Kind::output, 0}, 4);
  lossy.add_transition(3, {Action::Kind::output, 1}, 4);
  const System system = system_of(
      lossy,
      "  p: |\n    via.write;\n    switch via.read { message { stop; } null { via.read; } }\n");
  const Trace trace = find_trace(system);
  std::size_t followed = 0, others = 0;
  std::vector<std::unique_ptr<RealSystem>> real;
  real.push_back(std::make_unique<RealSystem>());
  real[0]->sul = std::make_unique<SimulatedSul>(lossy, "sim");
  real[0]->inputs = {0, 1};
  const std::vector<Trace> traces(40, trace);
  play_on_real_system(system, real, traces, {}, [&](std::size_t, ReplayedRun run) {
    if (!run.deviation) return void(++followed);
    EXPECT_EQ(run.deviation->kind, Deviation::Kind::other_answer);
    EXPECT_FALSE(run.deviation->refutes_model());
    ++others;
  });
  EXPECT_EQ(followed + others, 40U);
  EXPECT_GT(followed, 5U);
  EXPECT_GT(others, 5U);
}

TEST(Replay, NamesWhatItCannotAsk) {
  const std::string three = "  planner: repeat 3 { via.write; }\n";
  const System waiting = system_of(model("strict-2"), three, "wait");
  const Trace trace = find_trace(waiting);
  EXPECT_THAT(find_assumptions(waiting, trace), ElementsAre(HasSubstr("and waits")));
  EXPECT_FALSE(play(waiting, trace, model("strict-2")).deviation);

  const System dropping =
      system_of(model("strict-2"), three, "drop", "  e: {always: \"!planner@end\"}\n");
  const Trace dropped = find_trace(dropping, "e");
  EXPECT_THAT(find_assumptions(dropping, dropped), ElementsAre(HasSubstr("to change nothing")));
  EXPECT_FALSE(play(dropping, dropped, model("strict-2")).deviation);

  // The run is cut at the third write, which is never made.
  const System cut = system_of(model("strict-2"), three);
  Trace to_the_bound;
  for (GlobalState state = initial_state(cut); !state.is_cut;
       state = apply(cut, state, to_the_bound.steps.back())) {
    to_the_bound.steps.push_back(enabled_steps(cut, state).at(0));
  }
  EXPECT_THAT(find_assumptions(cut, to_the_bound), ElementsAre(HasSubstr("and is not played")));
  EXPECT_FALSE(ends_in_deadlock(cut, to_the_bound));
  EXPECT_EQ(play(cut, to_the_bound, model("strict-2")).steps, 3U);

  const System untaken =
      system_of(model("buffered"), "  p: |\n    via.write;\n    via.read;\n    via.read;\n");
  EXPECT_THAT(find_assumptions(untaken, find_trace(untaken)),
              ElementsAre(HasSubstr("for somebody to take message")));
}

TEST(Replay, AsksNobodyForWhatIsWrittenByHand) {
  const auto parse = [](const std::string& text) {
    return parse_system(text, "system.yaml", [](const ModelRequest&) { return model("buffered"); });
  };
  const System forks = parse(
      "models:\n  'fork[i in 0..1]': {use: mutex}\nvariables: \"var n: 0..1;\"\nprograms:\n"
      "  'p[i in 0..1]': |\n    fork[i].lock; n = 1;\n    fork[1 - i].lock;\n");
  const Trace deadlock = find_trace(forks);
  const Unplayed all = find_unplayed(forks, {&deadlock, 1});
  EXPECT_TRUE(all.is_all);
  EXPECT_THAT(all.models,
              ElementsAre("fork[0], fork[1] are written by hand (a mutex each), and no real system "
                          "is asked for that",
                          "n is a shared variable, and no real system is asked for that"));
  std::vector<std::unique_ptr<RealSystem>> nobody(forks.models.size());
  play_on_real_system(forks, nobody, {&deadlock, 1}, {}, [&](std::size_t, ReplayedRun run) {
    EXPECT_FALSE(run.deviation);
    EXPECT_EQ(run.steps, deadlock.steps.size());
  });

  const System mixed = parse(
      "models:\n  via: {file: via.dot}\n  m: {use: mutex}\nprograms:\n"
      "  p: via.write; m.lock; m.lock;\n  q: loop { select { on via.read -> message { } } }\n");
  const Trace trace = find_trace(mixed);
  const Unplayed some = find_unplayed(mixed, {&trace, 1});
  EXPECT_FALSE(some.is_all);
  EXPECT_THAT(some.models, testing::IsEmpty());  // a mutex belongs to the programs
  EXPECT_THAT(find_assumptions(mixed, trace), testing::IsEmpty());
  const System queued = parse(
      "models:\n  via: {file: via.dot}\n  m: {use: queue, with: {size: 1}}\nprograms:\n"
      "  p: via.write; m.read -> message;\n  q: idle via.read -> message;\n");
  const Trace waits = find_trace(queued);
  EXPECT_THAT(find_unplayed(queued, {&waits, 1}).models,
              ElementsAre("m is written by hand (a queue of size 1), and no real system is asked "
                          "for that"));
}

// What a `select` waits for is asked at the end, and must not come.
TEST(Replay, AsksForWhatASelectWaitsFor) {
  const std::string programs =
      "  p: via.write; via.write;\n  q: repeat 2 { select { on via.read -> message { } } }\n";
  const System system = system_of(model("buffered"), programs);
  const Trace trace = find_trace(system);
  EXPECT_THAT(find_assumptions(system, trace), testing::IsEmpty());
  EXPECT_FALSE(play(system, trace, model("buffered")).deviation);
  const ReplayedRun run = play(system, trace, model("strict-2"));
  ASSERT_TRUE(run.deviation);
  EXPECT_EQ(run.deviation->kind, Deviation::Kind::deadlock);
  EXPECT_EQ(run.deviation->expected, "quiet");
  EXPECT_EQ(run.deviation->seen, "message");
  EXPECT_EQ(run.deviation->word, (std::vector<std::string>{"write", "write", "read", "read"}));
}

TEST(RandomRun, IsARunThatNeverLeavesWhatWasLearned) {
  const System system = system_of(
      model("strict-2"), "  a: loop { via.write; }\n  b: loop { via.read -> message; }\n", "drop");
  Random random(3);
  const Trace trace = draw_run(system, 500, random);
  EXPECT_EQ(trace.steps.size(), 500U);
  EXPECT_EQ(replay(system, trace).size(), 501U);
  std::size_t of_a = 0;
  for (const Step& step : trace.steps) {
    EXPECT_FALSE(step.is_beyond);
    of_a += step.actor == 0 ? 1 : 0;
  }
  EXPECT_GT(of_a, 100U);
  EXPECT_LT(of_a, 400U);
  EXPECT_FALSE(play(system, trace, model("strict-2")).deviation);
  EXPECT_TRUE(play(system, trace, model("buffered")).deviation);
}

}  // namespace
}  // namespace maide
