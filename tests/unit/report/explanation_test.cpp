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

// The sentence on the deadlock begins with p. What keeps q from its end is told of q's property.
TEST(Explanation, SaysWhatKeepsAPropertyFromHolding) {
  const System system =
      system_of("a: {file: strict-2.dot}, b: {file: strict-2.dot}",
                "  p: a.read -> message;\n  q: b.write; b.read -> message; b.read -> message;\n",
                "  both: F (p@end && q@end)\n  p_ends: F p@end\n  q_ends: F q@end\n");
  const Trace trace = test::run_in_turns(system, "01111");
  PropertyResult deadlock;
  deadlock.name = "deadlock";
  const auto again = [&](std::size_t property) {
    return explain_again(system, system.properties.at(property), trace, deadlock);
  };
  const std::string of_q =
      "q waits at line 4 for a message from b; b holds none: q wrote 1, and it was read";
  EXPECT_THAT(again(1), testing::EndsWith("p@end never holds: the same run as deadlock"));
  EXPECT_THAT(again(2), testing::StartsWith("q@end never holds: " + of_q));
  EXPECT_THAT(again(2), testing::EndsWith("; the same run as deadlock"));
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
      testing::HasSubstr("its answer has come, but n.s, which takes it, finds no idle thread: "
                         "the one of e runs n.on, which waits"));
  EXPECT_THAT(why("{kind: single}", "exclusive", "executor: e, "),
              testing::HasSubstr(
                  "its request is not served: m.find finds no idle thread: the one of e runs "
                  "n.on, which waits, nor does n.s, which would take the answer\n"));
  EXPECT_THAT(
      why("{kind: multi, threads: 2}", "reentrant", ""),
      testing::HasSubstr("n.on[0] and n.on[1] wait at line 5 (n.on) for s!answer; its answer "
                         "has come, but n.s, which takes it, finds no idle thread: both "
                         "threads of e run n.on\n"));
}

// A deadlock's sentence, and what a chart says of the step in which something was lost.
std::string sentence(const std::string& text) {
  const std::string all = shown(parse_system(text, "s.yaml"), "deadlock");
  return all.substr(0, all.find('\n'));
}

TEST(Explanation, SaysWhoseRequestOrAnswerWasPushedOut) {
  const std::string server = "  cm: \"loop { idle list.serve -> request; list.answer; }\"\n";
  const std::string service =
      "services: {list: {server: cm, clients: [a, b], delivery: at_once, with: {depth: 1}}}\n"
      "programs:\n";
  const std::string by_other =
      shown(parse_system(service +
                             "  a: \"list.send; list.receive -> answer;\"\n"
                             "  b: \"list.send; list.send;\"\n" +
                             server,
                         "s.yaml"),
            "deadlock");
  EXPECT_THAT(by_other, testing::StartsWith("a waits at line 3 for list!answer; its request was "
                                            "pushed out at step 3 by b's, before cm "
                                            "served it (list keeps the last 1)\n"));
  EXPECT_THAT(by_other, testing::HasSubstr("  (one is lost: a's request)\n"));
  const std::string queue = "{use: queue, with: {size: 1}}";
  std::string text = "models: {go: " + queue + ", done: " + queue + "}\n" + service +
                     "  a: \"list.send; done.read -> message; list.receive -> answer;\"\n"
                     "  b: \"go.read -> message; list.send; list.receive -> answer; "
                     "done.write;\"\n"
                     "  cm: \"list.serve -> request; list.answer; go.write; "
                     "list.serve -> request; list.answer;\"\n";
  const std::string answer = shown(parse_system(text, "s.yaml"), "deadlock");
  EXPECT_THAT(answer, testing::ContainsRegex("a waits at line 4 for list!answer; its answer was "
                                             "pushed out at step [0-9]+ by the answer to b, before "
                                             "it was taken"));
  EXPECT_THAT(answer, testing::HasSubstr("(one is lost: the answer to a)"));
  // On their way, an older answer may be lost before it comes.
  text.replace(text.find("at_once"), 7, "late");
  const std::string late = shown(parse_system(text, "s.yaml"), "deadlock");
  EXPECT_THAT(late, testing::ContainsRegex("; lost on its way: an answer to a at step [0-9]+\n"));
}

TEST(Explanation, SaysWhatBecameOfARequest) {
  const std::string clients = "  c: \"s.send; s.receive -> answer;\"\n";
  const std::string service = "services: {s: {server: a, clients: [b, c]}}\nprograms:\n";
  EXPECT_EQ(sentence(service +
                     "  a: \"s.serve -> request; s.answer;\"\n"
                     "  b: \"s.send; s.receive -> answer;\"\n" +
                     clients),
            "c waits at line 5 for s!answer; its request is not served: a has ended");
  EXPECT_EQ(sentence(service + "  a: \"s.serve -> request;\"\n  b: skip;\n" + clients),
            "c waits at line 5 for s!answer; its request is served, but not answered: a has ended");
  EXPECT_EQ(sentence(service + "  a: skip;\n  b: skip;\n  c: \"s.receive -> answer;\"\n"),
            "c waits at line 5 for s!answer; it has sent no request to s");
}

// A node whose callback `waiter` waits for what `setter` would do.
std::string why_waits(const std::string& executor, const std::string& groups, int writes) {
  return sentence("models: {go: {use: queue, with: {size: 2}}}\nprograms: {w: \"repeat " +
                  std::to_string(writes) + " { go.write; }\"}\nexecutors: {e: " + executor +
                  "}\nnodes:\n  a:\n    executor: e\n    " + groups +
                  "\n    variables: \"var done: bool;\"\n"
                  "    callbacks:\n"
                  "      waiter: {takes: go.read, group: g, do: \"select { when (done) { } }\"}\n"
                  "      setter: {timer: 1, group: t, do: \"done = true;\"}\n");
}

TEST(Explanation, SaysThatNoThreadIsIdle) {
  EXPECT_EQ(why_waits("{kind: single}", "groups: {g: exclusive, t: exclusive}", 1),
            "a waits at line 10 (a.waiter) in a select for a.done; only a.setter would make a.done "
            "true, but it finds no idle thread: the one of e runs a.waiter, which waits");
  EXPECT_EQ(
      why_waits("{kind: multi, threads: 2}", "groups: {g: reentrant, t: exclusive}", 2),
      "a.waiter[0] and a.waiter[1] wait at line 10 (a.waiter) in a select for a.done == true; "
      "only a.setter would make a.done == true, but it finds no idle thread: both threads of "
      "e run a.waiter");
}

TEST(Explanation, NamesBothWaysOutOfASelect) {
  EXPECT_EQ(
      sentence("models: {go: {use: queue, with: {size: 1}}}\nvariables: \"var acked: bool;\"\n"
               "programs: {w: \"go.write; if * { acked = true; }\"}\n"
               "executors: {e: {kind: multi, threads: 4}}\nnodes:\n  a:\n    executor: e\n"
               "    groups: {one: exclusive}\n"
               "    variables: \"var late: bool;\"\n    callbacks:\n"
               "      waiter: {takes: go.read, group: one, do: \"select { when (acked) { } when "
               "(late) { } }\"}\n"
               "      timeout: {timer: 1, group: one, do: \"late = true;\"}\n"),
      "a.one waits at line 11 (a.waiter) in a select for acked == true or a.late; only w would "
      "make "
      "acked == true, but it has ended; only a.timeout would make a.late true, but it is in the "
      "group "
      "one, which a.waiter has while it waits");
}

TEST(Explanation, NamesOnlyWhoCanChangeWhatIsWaitedFor) {
  EXPECT_EQ(
      sentence("variables: \"var i: 0..1;\"\nprograms:\n"
               "  p[k in 0..1]: \"select { when (i > 0) { } } i = i - 1;\"\n"),
      "p[0] and p[1] wait at line 3 in a select for i == 1; no program would ever make i == 1");
  const std::string three =
      "models: {go: {use: queue, with: {size: 1}}}\nvariables: \"var x: 0..3;\"\nprograms:\n"
      "  w: \"select { when (x == 3) { } }\"\n  v: \"x = 1; go.read -> message; x = 2;\"\n";
  EXPECT_THAT(
      sentence(three),
      testing::StartsWith(
          "w waits at line 4 in a select for x == 3; no program would ever make x == 3; v waits"));
  EXPECT_THAT(
      sentence(three + "  u: \"go.read -> message; x = 3;\"\n"),
      testing::HasSubstr("w waits at line 4 in a select for x == 3: only u would make x == 3"));
  EXPECT_THAT(
      sentence(three + "  u: \"if * { x = 3; }\"\n"),
      testing::HasSubstr(
          "w waits at line 4 in a select for x == 3; only u would make x == 3, but it has ended"));
}

TEST(Explanation, CountsMessagesAndListsNone) {
  const std::string text =
      shown(parse_system("models: {q: {use: queue, with: {depth: 1}}}\nprograms:\n"
                         "  a: \"for k in 0..30 { q.write(k); }\"\n"
                         "  b: \"q.read -> message; q.read -> message;\"\n",
                         "s.yaml"),
            "deadlock");
  EXPECT_THAT(text, testing::StartsWith("b waits at line 4 for a message from q; q holds none: a "
                                        "wrote 31 messages, 1 was read and 30 "
                                        "were lost, first message 1 or 2, when a wrote message 2 "
                                        "before message 1 was read (step 2); a "
                                        "has ended\n"));
  EXPECT_THAT(
      text, testing::HasSubstr(
                "  b waits at line 4 for q!message; q has nothing to give; it would take write\n"));
}

TEST(Explanation, HasTheWordsOfTheFileAtASecondEnd) {
  const std::string text =
      shown(parse_system(
                "topics: {t: {writers: [a, b], readers: c, use: queue, with: {size: 1}, delivery: "
                "at_once}}\nprograms:\n"
                "  a: skip;\n  b: \"t.write; t.write;\"\n  c: skip;\n",
                "s.yaml"),
            "deadlock");
  EXPECT_THAT(text, testing::Not(testing::HasSubstr("write2")));
  EXPECT_THAT(text, testing::StartsWith("b waits at line 4 for t.write; t[c] is full; no program "
                                        "would ever make that possible\n"));
}

// A connection of DDS whose ends never match: what is written is lost.
TEST(Explanation, SaysThatTheEndsNeverMatch) {
  const auto model_of = [](const std::string& sul) {
    return parse_system(
        "models: {pong: {file: f.dot}}\n"
        "programs: {board: \"loop { pong.write; }\", pc: \"pong.read -> message;\"}\n",
        "s.yaml", [&](const ModelRequest&) {
          InterfaceAutomaton silent({"write", "read"}, {"message"}, 2);
          silent.add_transition(0, {Action::Kind::input, 0}, 0);
          silent.add_transition(0, {Action::Kind::input, 1}, 1);
          silent.add_transition(1, {Action::Kind::input, 0}, 1);
          silent.origin["sul"] = sul;
          return silent;
        });
  };
  const auto sentence_of = [](const System& system) {
    NativeEngine engine;
    CheckRequest request;
    request.properties = {"stuck"};
    const CheckReport report = check_system(system, engine, request);
    return explain(system, built_in(Property::Kind::stuck), *report.properties.front().trace);
  };
  const System unreliable = model_of(
      "cyclonedds pub-reliability=best_effort reliability=default sub-reliability=reliable");
  const std::string reliability =
      "pong delivers nothing: its writer offers reliability best_effort, its reader asks for "
      "reliable, and such ends never match";
  EXPECT_THAT(sentence_of(unreliable), testing::HasSubstr("from pong; " + reliability + "; "));
  EXPECT_THAT(unreliable.remarks, testing::ElementsAre(reliability + " (s.yaml:1:10)"));
  // What one end does not say is what both say.
  EXPECT_THAT(sentence_of(model_of("ros2 durability=volatile pub-durability=both "
                                   "sub-durability=transient_local")),
              testing::HasSubstr("its writer offers durability volatile, its reader asks for "
                                 "transient_local, and such ends never match"));
  const System matching = model_of("cyclonedds reliability=reliable sub-reliability=best_effort");
  EXPECT_THAT(sentence_of(matching), testing::HasSubstr("only board would write to pong"));
  EXPECT_THAT(matching.remarks, testing::IsEmpty());
}

// A reader that polls may keep the writer waiting on a run that is weakly fair only.
TEST(Explanation, NamesStrongFairnessWhereItLeavesTheRunOut) {
  const auto report_of = [](const std::string& fairness) {
    const System system = parse_system(
        "models: {m: {use: mutex}}\nprograms:\n  a: \"m.lock; @got m.unlock;\"\n"
        "  b: \"loop { m.lock; m.unlock; }\"\nproperties: {got: {ltl: F a@got, fairness: " +
            fairness + "}}\n",
        "s.yaml");
    NativeEngine engine;
    CheckReport report = check_system(system, engine, {});
    std::string text;
    for (const PropertyResult& result : report.properties) {
      if (result.trace) text = explain(system, find_property(system, result.name), *result.trace);
    }
    return std::pair(text, report.remarks);
  };
  const auto [text, remarks] = report_of("weak");
  EXPECT_THAT(text, testing::EndsWith("; `fairness: strong` leaves such runs out"));
  EXPECT_THAT(remarks, testing::IsEmpty());  // it is said already
  const auto [none, remark] = report_of("strong");
  EXPECT_EQ(none, "");
  EXPECT_THAT(remark, testing::ElementsAre(testing::StartsWith(
                          "a may never step again on a run that is weakly fair only, which `stuck` "
                          "leaves out, as a property with `fairness: strong` does: it waits at "
                          "line 3, ")));
}

TEST(Explanation, SaysOfAPromiseThatIsNotKeptWhatDoesNotHold) {
  const System system = parse_system(
      "variables: \"var n: 0..2;\"\nprograms: {P: \"n = 1;\", Q: \"n = 2;\"}\n"
      "properties: {test: \"F G (n == 1)\"}\n",
      "s.yaml");
  EXPECT_THAT(shown(system, "test"),
              testing::StartsWith("n == 1 does not hold at the end: all programs have ended\n"));
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
