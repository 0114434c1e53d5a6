#include "maide/report/explanation.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "maide/check/build/system_file.hpp"
#include "maide/check/engines/engine.hpp"
#include "maide/check/verdict/check_system.hpp"
#include "maide/report/trace_text.hpp"
#include "scheduled_run.hpp"

namespace maide {
namespace {

const std::string folder = MAIDE_SOURCE_DIR "/examples/";

Property built_in(Property::Kind kind) {
  Property property;
  property.kind = kind;
  return property;
}

std::string why_deadlock(const System& system, const Trace& trace) {
  const Property property = built_in(Property::Kind::deadlock);
  EXPECT_EQ(find_flaw(system, property, trace), "");
  return explain(system, property, trace);
}

// A system over models of tests/models.
System system_of(const std::string& models, const std::string& programs,
                 const std::string& properties = "") {
  const ModelSource source = [](const ModelRequest& request) {
    ModelRequest local = request;
    local.file = std::string(MAIDE_SOURCE_DIR "/tests/models/") + request.file.filename().string();
    return read_requested_model(local);
  };
  return parse_system("models: {" + models + "}\nprograms:\n" + programs +
                          (properties.empty() ? "" : "properties:\n" + properties),
                      "s.yaml", source);
}

TEST(Explanation, NamesTheMessageThatWasLostAndTheCircle) {
  const System system = read_system(folder + "case-study-1/buffered.yaml");
  EXPECT_EQ(
      why_deadlock(system, test::run_in_turns(system, "0000000111")),
      "controller waits at line 15 for message 2 of 6 from via; via holds none: planner wrote "
      "6, 1 was read and 5 were lost, first message 1 or 2, when planner wrote message 2 "
      "before message 1 was read (step 2); only planner would write to via; planner waits "
      "at line 11 for a message from sync, and only controller would write to sync: each "
      "waits for the other");
}

TEST(Explanation, NamesTheProgramThatHasEnded) {
  const System system = read_system(folder + "case-study-2/90-100-100-size-1.yaml");
  const std::string why = why_deadlock(system, test::run_by_priority(system, {2, 1, 0}));
  EXPECT_THAT(why,
              testing::StartsWith("p3 waits at line 13 for message 91 of 100 from q1; q1 holds "
                                  "none: p1 wrote 90, and all were read; p1 has ended"));
  EXPECT_THAT(why,
              testing::HasSubstr(
                  "p2 waits at line 10 to give q2.write (92 of 100): q2 was learned for at most "
                  "1 message in flight, and there it waits; only p3 would give q2.read"));
}

TEST(Explanation, NamesAnOutputThatNobodyTakes) {
  const System system = system_of("via: {file: strict-2.dot}",
                                  "  p: via.write; via.read; via.write;\n  q: via.write;\n");
  EXPECT_EQ(why_deadlock(system, test::run_in_turns(system, "00")),
            "p waits at line 3 to give via.write; via has message due since step 2 of p and does "
            "nothing else until that is taken; no other program would ever take it; q waits at "
            "line 4 to give via.write: via has message due since step 2 of p and does nothing else "
            "until that is taken; no other program would ever take it");
}

TEST(Explanation, NamesTheCallThatHasNotReturned) {
  const System system =
      system_of("via: {file: strict-2.dot}", "  p: via.read; via.read;\n  q: skip;\n");
  EXPECT_EQ(
      why_deadlock(system, test::run_in_turns(system, "0")),
      "p waits at line 3 to give via.read; via takes none now: the call that p made at step 1 "
      "has not returned; no other program would ever write to via");
}

TEST(Explanation, CountsWhatWasReadOfOneModelWhereALoopReadsOneOrAnother) {
  const System either =
      system_of("a: {file: strict-2.dot}, b: {file: strict-2.dot}",
                "  p: a.write; b.write;\n"
                "  q: repeat 3 { if * { a.read -> message; } else { b.read -> message; } }\n");
  EXPECT_THAT(why_deadlock(either, test::run_in_turns(either, "0011111")),
              testing::StartsWith("q waits at line 4 for message 2 from a in round 2 of 3; a holds "
                                  "none: p wrote 1, and it was read; p has ended"));
  const System changing = system_of(
      "a: {file: strict-2.dot}, b: {file: strict-2.dot}",
      "  p: a.write;\n"
      "  q: 'var k: 0..3; repeat 3 { if (k < 2) { a.read -> message; } else { b.read -> message; } "
      "k = k + 1; }'\n");
  EXPECT_THAT(why_deadlock(changing, test::run_in_turns(changing, "0111")),
              testing::StartsWith("q waits at line 4 for message 2 from a in round 2 of 3; "));
  const System twice =
      system_of("a: {file: strict-2.dot}",
                "  p: a.write;\n"
                "  q: repeat 3 { a.read -> message; if * { } else { a.read -> message; } }\n");
  EXPECT_THAT(why_deadlock(twice, test::run_in_turns(twice, "01111")),
              testing::StartsWith("q waits at line 4 for message 2 from a in round 2 of 3; "));
}

TEST(Explanation, SaysWhatOneRunShowsOnce) {
  const System system =
      system_of("a: {file: strict-2.dot}", "  p: a.read -> message;\n", "  done: F p@end\n");
  NativeEngine engine;
  const CheckReport report = check_system(system, engine, {});
  const PropertyResult& deadlock = report.properties.front();
  const PropertyResult& done = report.properties.back();
  ASSERT_TRUE(done.trace);
  EXPECT_EQ(find_same_run(report, deadlock), nullptr);
  ASSERT_EQ(find_same_run(report, done), &deadlock);
  const Shown shown = shown_part(system, done);
  EXPECT_EQ(explain_again(shown.part.system(), shown.property, shown.trace, deadlock),
            "p@end never holds: the same run as deadlock");
  const Json json = report_to_json(system, report);
  EXPECT_EQ(json["properties"][2]["same_run_as"], "deadlock");
  EXPECT_FALSE(json["properties"][0].contains("same_run_as"));
  EXPECT_EQ(json["properties"][2]["trace"], json["properties"][0]["trace"]);
  EXPECT_EQ(json["components"][0]["verdicts"]["deadlock"], "violated");
}

// A fork that one takes, and the others wait for.
InterfaceAutomaton fork_model() {
  InterfaceAutomaton fork({"take", "release"}, {"granted"}, 3);
  fork.add_transition(0, {Action::Kind::input, 0}, 1);
  fork.add_transition(1, {Action::Kind::output, 0}, 2);
  fork.add_transition(2, {Action::Kind::input, 1}, 0);
  return fork;
}

TEST(Explanation, NamesProgramsThatWaitInACircle) {
  const System system = parse_system(
      "models: {a: {file: f.dot}, b: {file: f.dot}, c: {file: f.dot}}\nprograms:\n"
      "  p: loop { a.take -> granted; b.take -> granted; a.release; b.release; }\n"
      "  q: loop { b.take -> granted; c.take -> granted; b.release; c.release; }\n"
      "  r: loop { c.take -> granted; a.take -> granted; c.release; a.release; }\n",
      "s.yaml", [](const ModelRequest&) { return fork_model(); });
  EXPECT_THAT(why_deadlock(system, test::run_in_turns(system, "001122")),
              testing::EndsWith("they wait in a circle: p for q, q for r, r for p"));
}

// A queue of `depth` messages that tells, with the next message, that one was lost.
InterfaceAutomaton queue_with_gaps(bool drops_oldest) {
  // Depth 1: empty, holds one (whole), holds one after a gap, and the same while it is due.
  InterfaceAutomaton queue({"write", "read"}, {"next", "gap"}, 7);
  const Action write{Action::Kind::input, 0}, read{Action::Kind::input, 1};
  const Action next{Action::Kind::output, 0}, gap{Action::Kind::output, 1};
  queue.add_transition(0, write, 1);
  queue.add_transition(1, write, drops_oldest ? 2 : 5);
  queue.add_transition(1, read, 3);
  queue.add_transition(3, next, 0);
  queue.add_transition(2, write, 2);
  queue.add_transition(2, read, 4);
  queue.add_transition(4, gap, 0);
  if (!drops_oldest) {  // it holds a whole one; what comes after it has a gap before it
    queue.add_transition(5, write, 5);
    queue.add_transition(5, read, 6);
    queue.add_transition(6, next, 0);
  }
  return queue;
}

TEST(Explanation, KnowsFromGapsWhichMessageWasLost) {
  for (const bool drops_oldest : {true, false}) {
    const System system = parse_system(
        "models: {via: {file: f.dot}}\nprograms:\n"
        "  p: repeat 2 { via.write; }\n"
        "  q: repeat 2 { switch via.read { next { } gap { } } }\n",
        "s.yaml", [&](const ModelRequest&) {
          InterfaceAutomaton queue = queue_with_gaps(drops_oldest);
          // Nothing to read: the call waits for a write.
          const StateId waiting = queue.add_state();
          queue.add_transition(0, {Action::Kind::input, 1}, waiting);
          queue.add_transition(waiting, {Action::Kind::input, 0}, 3);
          return queue;
        });
    EXPECT_THAT(why_deadlock(system, test::run_in_turns(system, "00111")),
                testing::HasSubstr(
                    drops_oldest ? "1 was lost: message 1, overwritten when p wrote message 2 "
                                   "before message 1 was read (step 2)"
                                 : "1 was lost: message 2, dropped when p wrote message 2 before "
                                   "message 1 was read (step 2)"));
  }
}

// Nobody waits for what was lost: callbacks never do. All the same it is why the count is short.
TEST(Explanation, SaysWhatWasLostWhereAPromiseIsNotKept) {
  const System system = parse_system(
      "topics: {image: {writers: camera, readers: planner, use: queue, with: {depth: 2}}}\n"
      "nodes:\n"
      "  camera:\n"
      "    variables: \"var sent: 0..3;\"\n"
      "    callbacks: {tick: {timer: 1, do: \"if (sent < 3) { image.write; sent = sent + 1; }\"}}\n"
      "  planner:\n"
      "    variables: \"var n: 0..3;\"\n"
      "    callbacks: {on_image: {takes: image.read, do: \"n = n + 1;\"}}\n"
      "properties: {three: {ltl: \"F planner.n == 3\", fairness: strong}}\n",
      "s.yaml");
  NativeEngine engine;
  const CheckReport report = check_system(system, engine, {});
  const auto three =
      std::find_if(report.properties.begin(), report.properties.end(),
                   [](const PropertyResult& result) { return result.name == "three"; });
  ASSERT_NE(three, report.properties.end());
  ASSERT_TRUE(three->trace);
  const std::string text = explain(system, system.properties.back(), *three->trace);
  EXPECT_THAT(text,
              testing::HasSubstr("image[planner]: camera wrote 3, 2 were read and 1 was lost"));
  const SequenceChart chart = make_trace_chart(system, *three->trace, "");
  EXPECT_EQ(std::count_if(chart.messages.begin(), chart.messages.end(),
                          [](const auto& message) {
                            return message.remark.starts_with("one is lost; ") ||
                                   message.remark == "one is lost";
                          }),
            1);
}

TEST(Explanation, SaysWhoNeverStepsAgainWhileOthersGoOn) {
  const System system = system_of("via: {file: strict-2.dot}, sync: {file: buffered.dot}",
                                  "  p: via.read -> message;\n"
                                  "  q: loop { sync.write; sync.read -> message; }\n");
  Trace trace = test::run_in_turns(system, "0111");
  trace.loop_start = 1;
  const Property stuck = built_in(Property::Kind::stuck);
  ASSERT_EQ(find_flaw(system, stuck, trace), "");
  EXPECT_EQ(explain(system, stuck, trace),
            "p never steps again: it waits at line 3 for a message from via; via was given none; "
            "no other program would ever write to via; q goes on for ever (steps 2 to 4)");
}

TEST(Explanation, NamesALoopOfOneStep) {
  const System system = system_of("via: {file: strict-2.dot}, sync: {file: buffered.dot}",
                                  "  p: via.read -> message;\n  q: loop { sync.write; }\n");
  Trace trace = test::run_in_turns(system, "011");
  trace.loop_start = 2;
  const Property stuck = built_in(Property::Kind::stuck);
  ASSERT_EQ(find_flaw(system, stuck, trace), "");
  EXPECT_THAT(explain(system, stuck, trace), testing::EndsWith("q goes on for ever (step 3)"));
}

TEST(Explanation, SaysWhereAFormulaIsBroken) {
  const System system =
      system_of("via: {file: strict-2.dot}, sync: {file: buffered.dot}",
                "  p: |\n    via.write;\n    @sent sync.read -> message;\n"
                "  q: via.read -> message;\n",
                "  answered: G (p@sent -> F p@end)\n  never: \"G !via!message\"\n"
                "  order: \"!via.read U via!message\"\n  recurs: G F via.write\n");
  const Trace trace = test::run_in_turns(system, "0011");
  const auto why = [&](std::size_t index) {
    const Property& property = system.properties[index];
    EXPECT_EQ(find_flaw(system, property, trace), "") << property.name;
    return explain(system, property, trace);
  };
  EXPECT_EQ(
      why(0),
      "p@sent holds after step 1, but p@end never holds from step 1 on: p waits at line 5 for "
      "a message from sync; sync was given none; no other program would ever write to "
      "sync");
  EXPECT_EQ(why(1), "step 4 is via!message");
  EXPECT_EQ(why(2),
            "step 3 is via.read, before via!message holds: p waits at line 5 for a message "
            "from sync; sync was given none; no other program would ever write to sync");
  EXPECT_THAT(why(3),
              testing::StartsWith("via.write never holds from step 2 on: p waits at line 5"));
}

// The explanation and the trace's text of the deadlock, or of the error, that a check finds.
std::string shown(const System& system, const std::string& property) {
  NativeEngine engine;
  CheckRequest request;
  request.properties = {property};
  const CheckReport report = check_system(system, engine, request);
  const Shown part = shown_part(system, report.properties.front());
  std::ostringstream text;
  text << explain(part.part.system(), part.property, part.trace) << "\n";
  write_trace_text(text, part.part.system(), part.trace, TraceFormat::steps);
  return text.str();
}

TEST(Explanation, SaysWhoHoldsWhatABuiltInModelGives) {
  const std::string mutex =
      shown(system_of("m: {use: mutex}", "  p: m.lock;\n  q: m.lock; m.lock;\n"), "deadlock");
  EXPECT_THAT(mutex, testing::HasSubstr("m is held: "));
  EXPECT_THAT(mutex, testing::HasSubstr(" locked it at step 1"));
  EXPECT_THAT(mutex, testing::HasSubstr("to give m.lock; m is held\n"));
  const std::string units =
      shown(system_of("s: {use: semaphore, with: {count: 1}}", "  p: s.acquire; s.acquire;\n"),
            "deadlock");
  EXPECT_THAT(units, testing::HasSubstr("s has no unit left: p acquired the last at step 1"));
  const std::string queue =
      shown(system_of("q: {use: queue, with: {size: 1}}", "  p: q.write; q.write;\n"), "deadlock");
  EXPECT_THAT(queue, testing::HasSubstr("; q is full; "));
}

// A callback waits for an answer: who would serve the request or take the answer, and why not.
TEST(Explanation, SaysWhichCallbackCannotStart) {
  const auto why = [](const std::string& executor, const std::string& group,
                      const std::string& of_server) {
    const System system = parse_system(
        "models: {go: {use: semaphore, with: {count: 2}}}\n"
        "services: {s: {server: m, clients: n}}\n"
        "executors: {e: " +
            executor +
            "}\n"
            "nodes:\n"
            "  n: {executor: e, groups: {g: " +
            group +
            "}, clients: {s: g}, callbacks: "
            "{on: {takes: go.acquire, group: g, do: \"s.send; wait s -> answer;\"}}}\n"
            "  m: {" +
            of_server + "callbacks: {find: {serves: s, do: s.answer;}}}\n",
        "s.yaml");
    return shown(system, "deadlock");
  };
  EXPECT_THAT(
      why("{kind: single}", "exclusive", ""),
      testing::HasSubstr("s: an answer to n not taken. n.s takes it, and n runs that, too"));
  EXPECT_THAT(
      why("{kind: single}", "exclusive", "executor: e, "),
      testing::HasSubstr("a request of n not served. m.find serves it, and e runs that, too"));
  EXPECT_THAT(why("{kind: multi, threads: 2}", "reentrant", ""),
              testing::HasSubstr("2 answers to n not taken. n.s takes it, and has no free thread"));
}

TEST(Explanation, SaysWhatASelectWaitsFor) {
  const System system = system_of("q: {use: queue, with: {size: 1}}, a: {use: mutex}",
                                  "  p: |\n    select {\n      on q.read -> message { }\n"
                                  "      on a.unlock { }\n    }\n");
  const std::string text = shown(system, "deadlock");
  const std::string waits = "p waits at line 5 in a select for q.read -> message or a.unlock";
  EXPECT_THAT(text, testing::StartsWith(waits + "; "));
  EXPECT_THAT(text, testing::HasSubstr("  " + waits + "\n"));
}

TEST(Explanation, TracesHaveTheValuesThatStepsChangeAndTheError) {
  const System system = system_of("q: {use: queue, with: {size: 2}}",
                                  "  p: |\n    var k: 0..1; var f: bool;\n"
                                  "    q.write; k = 1; f = true; q.write; k = 2;\n");
  const std::string text = shown(system, "error");
  EXPECT_THAT(text, testing::HasSubstr("(k = 1, f = true)"));
  EXPECT_THAT(text, testing::HasSubstr(
                        "here the run comes to an error: p: k = 2 is outside of 0..1 (s.yaml:5:"));
  NativeEngine engine;
  const CheckReport report = check_system(system, engine);
  const Json json = report_to_json(system, report);
  for (const Json& property : json["properties"]) {
    if (property["name"] != "error") continue;
    EXPECT_EQ(property["trace"][0]["values"], (Json{{"k", 1}, {"f", true}}));
    EXPECT_FALSE(property["trace"][1].contains("values"));
    return;
  }
  FAIL() << json.dump();
}

}  // namespace
}  // namespace maide
