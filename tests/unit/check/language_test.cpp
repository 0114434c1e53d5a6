// The second edition of the program language: what control states, steps and errors programs have.
// Counts are of what is reachable, and were made by hand; tests/referee holds random systems
// against an interpreter that shares nothing with the parser.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <deque>
#include <map>
#include <set>

#include "maide/check/build/parse_program.hpp"
#include "maide/check/engines/engine.hpp"
#include "maide/check/text/tokens.hpp"
#include "maide/check/verdict/check_system.hpp"
#include "systems.hpp"

namespace maide {
namespace {

System system_from(const std::string& text) {
  return parse_system(text, "s.yaml", test::test_model);
}

struct Explored {
  std::size_t states = 0, transitions = 0, deadlocks = 0;
  std::set<std::string> errors;  // that are reached
  bool operator==(const Explored&) const = default;
};

// By the meaning of a system alone (system.hpp), without the engine.
Explored explore(const System& system) {
  using Key = std::pair<std::vector<StateId>, std::vector<ControlState>>;
  const auto key = [](const GlobalState& state) { return Key(state.models, state.programs); };
  Explored explored;
  std::deque<GlobalState> open{initial_state(system)};
  std::set<Key> seen{key(open.front())};
  for (; !open.empty(); open.pop_front()) {
    const GlobalState state = open.front();
    if (is_deadlock(system, state)) ++explored.deadlocks;
    for (std::size_t i = 0; i < system.programs.size(); ++i) {
      const Program& program = system.programs[i];
      const std::uint32_t error = program.states[state.programs[i]].error;
      if (error != 0) explored.errors.insert(program.errors[error].text);
    }
    for (const Step& step : enabled_steps(system, state)) {
      ++explored.transitions;
      const GlobalState next = apply(system, state, step);
      if (!next.is_cut && seen.insert(key(next)).second) open.push_back(next);
    }
  }
  explored.states = seen.size();
  return explored;
}

// Of one program without models.
Explored explore_program(const std::string& text) {
  return explore(system_from("programs:\n  p: |\n    " + text));
}

std::string error_in(const std::string& program, const std::string& head = "") {
  return test::error_of([&] { system_from(head + "programs:\n  p: |\n    " + program); });
}

using Texts = std::set<std::string>;

TEST(Language, ChoicesAreTheOnlyStepsOfVariables) {
  EXPECT_EQ(explore_program("var x: 0..3; x = 2; x = x + 1;"), (Explored{1, 0, 0, {}}));
  EXPECT_EQ(explore_program("var x: 0..3; x = any 0..3;"), (Explored{5, 4, 0, {}}));
  EXPECT_EQ(explore_program("var x: 0..3 = 1; if * { x = 2; } else { x = 2; }"),
            (Explored{2, 2, 0, {}}));
  // The variables of a block end with it.
  EXPECT_EQ(explore_program("if * { var x: 0..3; x = any 0..3; } else { skip; }"),
            (Explored{3, 6, 0, {}}));
}

TEST(Language, WordsOfASelectMayBeVariables) {
  EXPECT_EQ(
      explore_program("var on: 0..2; var when: bool; var timeout: 0..1; on = 2; when = true; "
                      "select { when (when && on == 2) { timeout = 1; } timeout 10 { skip; } }"
                      " if (timeout == 1) { on = 3; }"),
      (Explored{2, 1, 0, {"on = 3 is outside of 0..2"}}));
}

TEST(Language, LoopsOverVariables) {
  EXPECT_EQ(explore_program("for k in 1..3 { if * { skip; } }"), (Explored{4, 6, 0, {}}));
  EXPECT_EQ(explore_program("for k in 3..1 { if * { skip; } }"), (Explored{1, 0, 0, {}}));
  EXPECT_EQ(explore_program("var n: 0..9 = 2; repeat n * 2 { if * { skip; } }"),
            (Explored{5, 8, 0, {}}));
  EXPECT_EQ(explore_program("var x: 0..9; while (x < 3) { x = x + 1; if * { skip; } }"),
            (Explored{4, 6, 0, {}}));
  EXPECT_EQ(explore_program("loop { if * { break; } else { continue; } }"),
            (Explored{2, 2, 0, {}}));
  EXPECT_EQ(explore_program("for i in 0..1 { for j in 0..i { if * { skip; } } }"),
            (Explored{4, 6, 0, {}}));
  // `break` leaves the innermost loop alone.
  EXPECT_EQ(explore_program("repeat 2 { loop { if * { break; } } }"), (Explored{3, 4, 0, {}}));
}

TEST(Language, ErrorsOfARun) {
  EXPECT_EQ(explore_program("var x: 0..3; x = 4;").errors, Texts{"x = 4 is outside of 0..3"});
  EXPECT_EQ(explore_program("var x: 0..3; x = any 2..4;").errors,
            Texts{"x = 4 is outside of 0..3"});
  EXPECT_EQ(explore_program("var x: 0..3; x = 1 / x;").errors, Texts{"division by zero"});
  EXPECT_EQ(explore_program("var x: -9..9; x = 7 % (x - x);").errors, Texts{"division by zero"});
  EXPECT_EQ(explore_program("var i: 0..9 = 5; var a[k in 0..4]: bool; a[i] = true;").errors,
            Texts{"a[5] is outside of 0..4"});
  EXPECT_EQ(explore_program("var x: 0..1; while (x == 0) { skip; }").errors,
            Texts{"control goes round without a step"});
  EXPECT_EQ(explore_program("for k in -9223372036854775807..9223372036854775807 { }").errors,
            Texts{"'for' goes round more than 1000000 times"});
  EXPECT_EQ(explore_program("var x: 0..1; x = 9223372036854775807 + 1;").errors,
            Texts{"a result that 64 bits do not hold"});
  // As in C++, quotients go towards 0, and a remainder has the sign of the dividend.
  EXPECT_EQ(explore_program("var x: 0..1; x = -7 / 2 * 10 + -7 % 2;").errors,
            Texts{"x = -31 is outside of 0..1"});
}

TEST(Language, ProceduresAreInlined) {
  const std::string head =
      "procedures:\n  twice(v): \"v = v + 1; if (v > 2) { return; } v = v + 1;\"\n";
  const Explored explored = explore(system_from(
      head + "programs:\n  p: \"var x: 0..3; call twice(x); call twice(x); x = x + 1;\"\n"));
  EXPECT_EQ(explored.errors, Texts{"x = 4 is outside of 0..3"});
  const std::string own = "procedures: {f(): \"var x: 0..1; x = any 0..1; @there skip;\"}\n";
  EXPECT_EQ(explore(system_from(own + "programs: {p: \"call f(); call f();\"}")),
            (Explored{3, 4, 0, {}}));
  EXPECT_NE(error_in("call f();", "procedures: {f(): \"call g();\", g(): \"call f();\"}\n")
                .find("procedure 'f' calls itself: f, g, f (s.yaml:1:43)"),
            std::string::npos);
  EXPECT_NE(error_in("var y: 0..1; call f();", "procedures: {f(): \"y = 1;\"}\n")
                .find("unknown variable 'y'"),
            std::string::npos);
}

TEST(Language, ArraysAreWrittenOnce) {
  const System system = system_from(
      "constants: {n: 3}\n"
      "models:\n  fork[i in 0..n - 1]: {use: mutex}\n"
      "programs:\n  p[i in 0..n - 1]: |\n"
      "    loop { @hungry fork[i].lock; fork[(i + 1) % n].lock; @eats fork[i].unlock;\n"
      "           fork[(i + 1) % n].unlock; }\n"
      "properties:\n  fed: \"forall i in 0..n - 1: G (p[i]@hungry -> F p[i]@eats)\"\n");
  EXPECT_EQ(system.programs[1].name, "p[1]");
  EXPECT_EQ(system.models[2].name, "fork[2]");
  ASSERT_EQ(system.properties.size(), 3u);
  EXPECT_EQ(system.properties[2].name, "fed[2]");
  const Explored explored = explore(system);
  EXPECT_EQ(explored.deadlocks, 1u);  // each has its own fork
}

// A member, and a member's reader.
TEST(Language, FormulasNameMembersOfTopics) {
  const System system = parse_system(
      "topics:\n  t[i in 0..1]: {writers: w, readers: r, use: queue, with: {size: 1}}\n"
      "programs: {w: \"t[0].write;\", r: \"t[0].read -> message;\"}\n"
      "properties:\n"
      "  first: \"G !(t[0]!message)\"\n"
      "  reader: \"G !(t[0][r]!message)\"\n"
      "  each: \"forall i in 0..1: G !t[i]!message\"\n",
      "s.yaml", test::test_model);
  std::map<std::string, Verdict> verdicts;
  NativeEngine engine;
  for (const PropertyResult& result : check_system(system, engine, {}).properties) {
    verdicts[result.name] = result.verdict;
  }
  EXPECT_EQ(verdicts.at("first"), Verdict::violated);
  EXPECT_EQ(verdicts.at("reader"), Verdict::violated);
  EXPECT_EQ(verdicts.at("each[0]"), Verdict::violated);
  EXPECT_EQ(verdicts.at("each[1]"), Verdict::holds);
}

// A name in quotes that needs none is a word where one may stand, and a constant may have its name.
TEST(Language, AWordInQuotesIsNoConstant) {
  const System system = system_from(
      "constants: {go: 1, my n: 1}\n"
      "models: {q: {use: queue, with: {size: 1}}}\n"
      "variables: 'var x: {\"go\", stop}; var y: 0..1;'\n"
      "programs:\n"
      "  a: 'x = stop; y = \"my n\"; x = \"go\"; y = go - 1; q.write(\"go\");'\n"
      "  b: 'q.read -> message(\"go\"); if (x == \"go\" && y == go) { skip; }'\n"
      "properties:\n"
      "  word: 'F G x == \"go\"'\n"
      "  number: 'F y == go'\n"
      "  quoted: 'F y == \"my n\"'\n"
      "  message: 'F q!message(\"go\")'\n");
  NativeEngine engine;
  const CheckReport report = check_system(system, engine, {});
  for (const PropertyResult& result : report.properties) {
    EXPECT_EQ(result.verdict, Verdict::holds) << result.name;
  }
}

TEST(Language, SharedVariablesAreReadInOneStepAndWrittenInAnother) {
  // Both read 0 before one writes: the lost update.
  const System lost = system_from(
      "variables: \"var n: 0..2;\"\n"
      "programs: {a: \"n = n + 1;\", b: \"n = n + 1;\"}\n"
      "properties: {both: \"G (a@end && b@end -> n == 2)\"}\n");
  EXPECT_EQ(explore(lost), (Explored{12, 14, 0, {}}));
  const System atomic = system_from(
      "variables: \"var n: 0..2;\"\n"
      "programs: {a: \"atomic { n = n + 1; }\", b: \"atomic { n = n + 1; }\"}\n");
  EXPECT_EQ(explore(atomic), (Explored{4, 4, 0, {}}));
  // Who finds it taken waits, in one step with the taking.
  const System guarded = system_from(
      "variables: \"var taken: bool;\"\n"
      "programs:\n"
      "  a: \"when (!taken) atomic { taken = true; } taken = false;\"\n"
      "  b: \"when (!taken) atomic { taken = true; }\"\n");
  EXPECT_EQ(explore(guarded), (Explored{5, 4, 1, {}}));
  const System counted = system_from(
      "variables: \"var n: 0..9; var other: bool;\"\n"
      "programs:\n"
      "  a: \"atomic { for k in 1..3 { n = n + k; } other = n == 6; }\"\n"
      "  b: \"when (other) atomic { for k in 2..3 { n = k; } }\"\n");
  EXPECT_EQ(explore(counted), (Explored{3, 2, 0, {}}));
  // What one program alone uses is its own, and costs no step.
  const System own = system_from(
      "variables: \"var n: 0..2;\"\n"
      "programs: {a: \"n = n + 1; if * { n = n + 1; }\", b: \"if * { skip; }\"}\n");
  EXPECT_EQ(explore(own), (Explored{6, 10, 0, {}}));
}

TEST(Language, AWriteOutOfRangeErrsInTheWritesStep) {
  const Explored explored =
      explore(system_from("variables: \"var n: 0..1;\"\n"
                          "programs: {a: \"n = n + 1;\", b: \"n = n + 1;\"}\n"));
  EXPECT_EQ(explored.errors, Texts{"n = 2 is outside of 0..1"});
}

// One program reads what is not there; the other writes late.
const std::string queue = "models: {q: {use: queue, with: {size: 1}}}\n";

TEST(Language, SelectTakesAnInputWithTheOutputThatFollows) {
  const System system = system_from(
      queue + "programs:\n  a: \"select { on q.read -> message { stop; } }\"\n  b: q.write;\n");
  // b writes, a takes: a never waits between input and output.
  EXPECT_EQ(explore(system), (Explored{3, 2, 0, {}}));
  const Program& program = system.programs[0];
  const ProgramEdge edge = program.edges_of(0)[0];
  EXPECT_EQ(program.role_of(edge), CombinedStep::Role::arm);
  EXPECT_EQ(program.events_of(edge).size(), 2u);
}

// A model that may go two ways to the same state: the arm is one step.
TEST(Language, TwoWaysToOneStateAreOneStep) {
  System system;
  ModelInstance model;
  model.name = "m";
  model.automaton = InterfaceAutomaton({"ask"}, {"answer"}, 3);
  for (const StateId way : {1U, 2U}) {
    model.automaton.add_transition(0, {Action::Kind::input, 0}, way);
    model.automaton.add_transition(way, {Action::Kind::output, 0}, 0);
  }
  system.models.push_back(model);
  const std::string text = "select { on m.ask -> answer { } }";
  system.programs.push_back(parse_program("p", ScalarText(text, text, {"s.yaml", 1, 1}), system));
  EXPECT_EQ(enabled_steps(system, initial_state(system)).size(), 1u);
}

TEST(Language, OtherwiseIsTakenWhenNoArmCanBe) {
  EXPECT_EQ(
      explore(system_from(
          queue + "programs: {a: \"select { on q.read -> message { q.write; } otherwise { } }\"}")),
      (Explored{2, 1, 0, {}}));
  EXPECT_EQ(explore(system_from(
                queue + "programs: {a: \"q.write; select { on q.read -> message { q.write; } "
                        "otherwise { } }\"}")),
            (Explored{4, 3, 0, {}}));
  // A guard over a shared variable is read in the arm's step.
  EXPECT_EQ(
      explore(system_from("variables: \"var n: 0..1;\"\n"
                          "programs: {a: \"select { when (n == 1) { stop; } }\", b: \"n = 1;\"}")),
      (Explored{3, 2, 0, {}}));
}

TEST(Language, ASelectOfWhichNoGuardHoldsIsNoEnd) {
  const System system = system_from("programs: {a: \"var x: 0..1; select { when (x == 1) { } }\"}");
  EXPECT_EQ(explore(system).deadlocks, 1u);
  EXPECT_FALSE(system.programs[0].may_end());
}

TEST(Language, AnOutputWithoutAnArmIsAnError) {
  const std::string models =
      "models: {via: {file: strict-2.dot}, r: {use: queue, with: {size: 1}}}\n";
  const System system = system_from(
      "models: {q: {use: queue, with: {size: 1}}}\n"
      "programs: {a: \"q.write(2); select { on q.read { message(1) { } message(3) { } } }\", "
      "b: \"q.write(1); q.write(3);\"}\n");
  EXPECT_EQ(explore(system).errors, Texts{"q.read -> message(2): this 'select' has no arm for it"});
  EXPECT_NE(error_in("select { on via.write -> message { } }", models)
                .find("this arm's outputs never follow via.write at once (s.yaml:4:14)"),
            std::string::npos);
}

// What cannot be, and what to do instead, in one line with its place.
TEST(Language, ErrorsSayWhatToDoInstead) {
  const auto error_of = [](const std::string& text) {
    return test::error_of([&] { parse_system(text, "s.yaml"); });
  };
  EXPECT_EQ(error_of("models: {q: {use: queue, with: {size: 1}}}\nprograms:\n"
                     "  a: \"q.write(1);\"\n"
                     "  c: \"select { on q.read -> message(7) { } }\"\n"),
            "no program writes 7 to q, so q.read never brings message(7) (s.yaml:4:29)");
  const auto service = [](const std::string& server, const std::string& client) {
    return "services: {s: {server: a, clients: b}}\nprograms:\n  a: \"" + server + "\"\n  b: \"" +
           client + "\"\n";
  };
  EXPECT_THAT(error_of(service("s.serve -> request; s.answer(1);", "s.send;")),
              testing::AllOf(testing::StartsWith("requests and answers carry no values: write "
                                                 "'s.answer' without one, and keep the value in a "
                                                 "shared variable"),
                             testing::EndsWith(" (s.yaml:3:29)")));
  EXPECT_THAT(
      error_of(service("s.serve -> request; s.answer;", "s.send; s.receive -> answer(var x);")),
      testing::HasSubstr("write 's -> answer' without one"));
  EXPECT_EQ(error_of("topics: {t: {writers: a, readers: b, use: queue, "
                     "with: {depth: 1, durability: transient_local}}}\n"
                     "programs: {a: \"t.write;\", b: \"t.read -> message;\"}\n"),
            "a queue written by hand has no 'durability': that is a middleware's, so write 'learn: "
            "cyclonedds' or another one in place of 'use: queue' (s.yaml:1:67)");
  EXPECT_EQ(
      error_of("nodes: {a: {groups: {g: {kind: exclusive, executor: n}}, callbacks: {x: {timer: 1, "
               "group: g, do: skip;}}}}\n"),
      "a group is one of exclusive, reentrant: all groups of a node run on the node's executor, so "
      "what another executor is to run goes into a node of its own (s.yaml:1:25)");
}

TEST(Language, ValuesAreCarriedByQueues) {
  const System system = system_from(
      queue +
      "programs:\n  a: \"for k in 1..2 { q.write(k * 10); }\"\n"
      "  b: \"loop { idle q.read -> message(var x); if (x == 20) { @last stop; } }\"\n");
  EXPECT_EQ(system.models[0].automaton.inputs().names(),
            (std::vector<std::string>{"write(10)", "write(20)", "read"}));
  EXPECT_EQ(explore(system).deadlocks, 0u);
  EXPECT_NE(
      test::error_of([] {
        system_from(
            "models: {q: {use: queue, with: {size: 9}, ends: {writer: [a]}}}\n"
            "programs: {a: {do: \"var x: 0..99; x = any 0..99; q.write(x);\", may_die: true}}");
      }).find("queue 'q' with the values 0..99 has more than 200000 states"),
      std::string::npos);
}

// What is read from a queue is of the type of what its writers may come to.
TEST(Language, RangesOfValuesFollowTheOperators) {
  const auto values = [](const std::string& expression) {
    const System system =
        system_from(queue + "programs:\n  a: \"for k in 2..3 { q.write(" + expression + "); }\"\n" +
                    "  b: \"loop { idle q.read -> message(var x); }\"\n");
    return to_string(system.programs[1].variables[0].type, system.words);
  };
  EXPECT_EQ(values("k"), "2..3");
  EXPECT_EQ(values("k + 5"), "7..8");
  EXPECT_EQ(values("7 - k"), "4..5");
  EXPECT_EQ(values("k - 7"), "-5..-4");
  EXPECT_EQ(values("k - k"), "-1..1");
  EXPECT_EQ(values("-k"), "-3..-2");
  EXPECT_EQ(values("k * -4"), "-12..-8");
  EXPECT_EQ(values("k / 2"), "0..3");
  EXPECT_EQ(values("k % 3"), "0..2");
  EXPECT_EQ(values("(k - 5) % 3"), "-2..0");
}

// Numbers below 0 are numbers in models and in programs.
TEST(Language, ValuesMayBeNegative) {
  const std::string writer = "programs:\n  a: \"q.write(-1); q.write(0); q.write(-20);\"\n  b: ";
  const System bound = system_from(queue + writer +
                                   "\"var sum: -30..0 = 0; repeat 3 { q.read -> message(var x); "
                                   "sum = sum + x; } if (sum == -21) { "
                                   "@right skip; }\"\nproperties: {right: \"F b@right\"}\n");
  EXPECT_EQ(explore(bound).deadlocks, 0u);
  EXPECT_TRUE(explore(bound).errors.empty());
  const System constant =
      system_from(queue + writer +
                  "\"q.read -> message(-1); q.read -> message(0); q.read -> message(-20);\"\n");
  EXPECT_EQ(explore(constant).deadlocks, 0u);
}

// An output that is due binds its value in every kind of arm, and a formula names it by a constant.
TEST(Language, ArmsBindValuesAndFormulasNameThem) {
  const std::string head = "constants: {half: 2}\n" + queue +
                           "programs:\n  a: \"q.write(half); q.write(3);\"\n  b: \"var n: 0..9; ";
  const std::string properties =
      "\"\nproperties:\n  half: \"F q.write(half)\"\n  two: \"F q!message(2)\"\n"
      "  sum: \"F (b.n == 5)\"\n  none: \"F (b.n == 2 && b@end)\"\n";
  for (const std::string code :
       {"repeat 2 { q.read -> message(var x); n = n + x; }",
        "repeat 2 { switch q.read { message(var x) { n = n + x; } } }",
        "repeat 2 { q.read; wait q -> message(var x); n = n + x; }",
        "repeat 2 { q.read; select { on q!message(var x) { n = n + x; } } }",
        "repeat 2 { select { on q.read -> message(var x) { n = n + x; } } }",
        "repeat 2 { select { on q.read { message(var x) { n = n + x; } } } }",
        "repeat 2 { q.read; switch q { message(var x) { n = n + x; } } }"}) {
    const std::string text = head + code + properties;
    const std::string error = test::error_of([&] { system_from(text); });
    if (code.find("switch q {") != std::string::npos) {
      EXPECT_NE(error, "") << "a switch gives an input";
      continue;
    }
    ASSERT_EQ(error, "") << code;
    NativeEngine engine;
    const CheckReport report = check_system(system_from(text), engine, {});
    for (const PropertyResult& result : report.properties) {
      EXPECT_EQ(result.verdict, result.name == "none" ? Verdict::violated : Verdict::holds)
          << code << ": " << result.name;
    }
  }
}

TEST(Language, BuiltInModels) {
  EXPECT_EQ(explore(system_from(
                "models: {m: {use: mutex}}\nprograms: {p: \"loop { m.lock; m.unlock; }\"}")),
            (Explored{2, 2, 0, {}}));
  const System semaphore = system_from(
      "models: {s: {use: semaphore, with: {count: 2}}}\nprograms: {p: \"loop { s.acquire; }\"}");
  EXPECT_EQ(explore(semaphore), (Explored{3, 2, 1, {}}));
  for (const int size : {1, 2, 5}) {
    const System queues =
        system_from("models: {q: {use: queue, with: {size: " + std::to_string(size) +
                    "}}}\nprograms: {p: q.write;}");
    EXPECT_EQ(queues.models[0].automaton.size(), static_cast<std::size_t>(2 * size + 2));
    EXPECT_EQ(queues.models[0].automaton.transition_count(),
              static_cast<std::size_t>(3 * size + 2));
  }
}

TEST(Language, WhoRestsIsNoDeadlock) {
  const std::string client = queue + "programs: {client: q.write;, server: \"loop { ";
  EXPECT_EQ(explore(system_from(client + "q.read -> message; }\"}")).deadlocks, 1u);
  EXPECT_EQ(explore(system_from(client + "idle q.read -> message; }\"}")).deadlocks, 0u);
  EXPECT_NE(error_in("idle skip;").find("'idle' stands before"), std::string::npos);
}

TEST(Language, WhereProgramsCanOnlyDieIsADeadlock) {
  const System system = system_from(
      "models: {m: {use: mutex}}\n"
      "programs:\n  a: {do: \"m.lock; m.lock;\", may_die: true}\n");
  const Explored explored = explore(system);
  EXPECT_EQ(explored.states, 4u);  // two places, and the end with the mutex free or held
  EXPECT_EQ(explored.deadlocks, 1u);
}

// Whether the writer comes to the error behind its statements.
bool comes_behind(const std::string& models, const std::string& writer, const std::string& reader) {
  const std::string text =
      models + "programs:\n  w: \"var x: 0..1; " + writer + " x = 1 / x;\"\n  r: " + reader + "\n";
  return !explore(system_from(text)).errors.empty();
}

TEST(Language, ADeadReadersModelLeavesTheTopic) {
  const std::string topic =
      "topics: {t: {writers: w, readers: [r], use: queue, with: {size: 1}}}\n";
  const std::string reader = "{do: \"t.read -> message;\", may_die: ";
  EXPECT_TRUE(comes_behind(topic, "repeat 2 { t.write; }", reader + "false}"));
  EXPECT_FALSE(comes_behind(topic, "repeat 3 { t.write; }", reader + "false}"));
  EXPECT_TRUE(comes_behind(topic, "repeat 3 { t.write; }", reader + "true}"));
}

TEST(Language, ArmsWriteToTopicsWhenAllModelsTakeIt) {
  const std::string topic =
      "topics: {t: {writers: w, readers: [r], use: queue, with: {size: 1}}}\n";
  const std::string reader = "\"if * { } else { t.read -> message; }\"";
  EXPECT_TRUE(comes_behind(topic, "select { on t.write { } }", reader));
  EXPECT_FALSE(comes_behind(topic, "repeat 2 { t.write; } select { on t.write { } }", reader));
  EXPECT_TRUE(comes_behind(
      topic, "repeat 2 { t.write; } select { on t.write { stop; } otherwise { } }", reader));
  EXPECT_FALSE(comes_behind(topic, "select { on t.write { stop; } otherwise { } }", reader));
}

TEST(Language, WhatIsDueToADeadEndIsThrownAway) {
  const std::string topic = "models: {t: {use: queue, with: {size: 1}";
  const std::string reader = "{do: \"t.read; t.read;\", may_die: true}";
  EXPECT_FALSE(comes_behind(topic + "}}\n", "t.write; t.write;", reader));
  EXPECT_TRUE(comes_behind(topic + ", ends: {reader: r}}}\n", "t.write; t.write;", reader));
  EXPECT_FALSE(comes_behind(topic + ", ends: {reader: r}}}\n", "repeat 3 { t.write; }", reader));
}

TEST(Language, FormulasOverVariables) {
  const System system = system_from(
      "variables: \"var n: 0..3; var ok: bool;\"\n"
      "programs:\n  a: \"var x: 0..3; x = any 0..3; n = x; ok = true;\"\n  b: \"n = 0; ok = "
      "false;\"\n"
      "properties:\n"
      "  one: \"G (a.x + 1 >= n || !ok)\"\n  two: \"F (ok && (a.x == 2 || n % 2 == 1))\"\n");
  const FormulaScope scope{system.programs, {}, system.expressions, &system.words};
  EXPECT_EQ(to_string(system.properties[0].formula, scope), "G (((a.x + 1) >= n) || !(ok))");
  EXPECT_NE(error_in("skip;\nproperties: {f: \"p.x == 1\"}").find("has no variable 'x'"),
            std::string::npos);
  EXPECT_NE(error_in("var x: 0..1;\nproperties: {f: \"G p.x\"}").find("compare it"),
            std::string::npos);
}

TEST(Language, ErrorsNameThePlace) {
  const std::vector<std::pair<std::string, std::string>> cases{
      {"var x: 3..1;", "3 is greater than 1 (s.yaml:3:12)"},
      {"x = 1;", "unknown variable 'x' (s.yaml:3:5)"},
      {"var x: 0..1; x = true;",
       "the value of x is a number, and this is true or false (s.yaml:3:22)"},
      {"var x: 0..1; if (x) { }",
       "a condition is true or false, and this is a number (s.yaml:3:22)"},
      {"var x: bool; x = x + 1;", "what stands before '+' is a number"},
      {"var x: 0..1; var x: 0..1;", "there is a 'x' here already (s.yaml:3:22)"},
      {"var loop: 0..1;", "'loop' is a keyword here (s.yaml:3:9)"},
      {"var x: {a, b}; x = c;", "unknown name 'c'"},
      {"var x: {a, a};", "'a' is there twice"},
      {"break;", "this 'break' is in no loop (s.yaml:3:5)"},
      {"for k in 0..2 { k = 1; }", "'k' is counted by its 'for', and cannot be set (s.yaml:3:21)"},
      {"call f();", "unknown procedure 'f'; there is: none (s.yaml:3:10)"},
      {"atomic { loop { } }",
       "in 'atomic' stand assignments, 'if (...)' and 'for' alone (s.yaml:3:14)"},
      {"when (1 < 2) { }",
       "outside of a 'select', 'atomic { ... }' stands behind 'when (...)', not '{' (s.yaml:3:18)"},
      {"select { }", "this 'select' has no arm (s.yaml:3:5)"},
      {"select { otherwise { } timeout 5 { } }", "has one 'otherwise' or one 'timeout'"},
      {"select { skip; }", "expected an arm, which begins with 'on', 'when'"},
      {"var a[k in 0..2]: bool; a = true;", "'a' is an array: say which member, as in a[0]"},
      {"var a[k in 0..2]: bool; a[0, 1] = true;", "'a' has 1 index, not 2"},
      {"loop { var x: 0..1; x = 1 - x; }", "would go round for ever without a step"},
      {"loop { if (0 != 2) { continue; } if * { } }", "would go round for ever without a step"},
      {"loop { if (1 == 2) { if * { } } else { continue; } break; }",
       "would go round for ever without a step"},
      {"var x: 0..99999999999999999999;", "does not fit into 64 bits"},
      {"var x: 0..1; x = any -9223372036854775807..9223372036854775807;", "more than 10000 values"},
  };
  for (const auto& [program, expected] : cases) {
    const std::string message = error_in(program);
    EXPECT_NE(message.find(expected), std::string::npos) << program << "\n" << message;
  }
}

TEST(Language, UnknownNamesAreToldWhatThereIsAndNotTooMuch) {
  const std::vector<std::string> many(30, "robot");
  EXPECT_EQ(known_instead("x", {}), "none");
  EXPECT_EQ(known_instead("dept", std::vector<std::string>{"depth", "size"}),
            "depth, size; did you mean 'depth'?");
  EXPECT_NE(known_instead("robit", many).find("robot, robot and 6 more; did you mean 'robot'?"),
            std::string::npos);
}

TEST(Language, AWordThatBeginsNoStatementIsToldWhatDoes) {
  const std::vector<std::pair<std::string, std::string>> cases{
      {"loop { brek; }", "'brek' begins no statement; did you mean 'break'? (s.yaml:3:12)"},
      {"Loop { if * { } }", "'Loop' begins no statement; did you mean 'loop'? (s.yaml:3:5)"},
      {"var ready: bool; raedy;", "'raedy' begins no statement; did you mean 'ready'?"},
      {"if * { skip; } elseif * { }", "'elseif' begins no statement; it is 'else if'"},
      {"select { timeout { } }", "a 'timeout' says how many milliseconds, as in `timeout 100 { }`"},
      {"@ q.write;", "behind '@' stands the name of a label, and then a statement, as in `@here q"},
      {"var x: int;", "a type is a range as `0..3`, `bool`, or words as `{idle, busy}`, and 'int'"},
      {"skip; stop", "expected ';' after 'stop', not the end of the text (s.yaml:3:15)"},
      {"goto x;",
       "'goto' begins no statement: one gives an input (`model.input;`), sets a variable"},
      {"otherwise { }", "'otherwise' begins an arm of a 'select', and this is none (s.yaml:3:5)"},
      {"else { }", "'else' follows no 'if' block"},
      {"quiet { }", "'quiet' is an arm of 'switch'"},
      {"var n: 0..3; n++;", "'n' is a variable: a statement sets it, as in `n = e;` (s.yaml:3:18)"},
      {"var n: 0..3; N = 1;", "unknown variable 'N'; did you mean 'n'?"},
      {"var left: 0..3; left = letf;", "or word of a variable; did you mean 'left'? (s.yaml:3:28)"},
  };
  for (const auto& [program, expected] : cases) {
    const std::string message = error_in(program);
    EXPECT_NE(message.find(expected), std::string::npos) << program << "\n" << message;
  }
  EXPECT_NE(
      test::error_of([] {
        system_from("procedures: {eat(n): \"repeat n { if * { } }\"}\nprograms: {p: eat(2);}");
      }).find("'eat' is a procedure: a statement calls it, as in `call eat(...);`"),
      std::string::npos);
}

TEST(Language, SlipsAtModelsAndProceduresAreToldWhatToDo) {
  const auto error = [](const std::string& programs) {
    return test::error_of([&] {
      system_from(
          "models: {q: {use: queue, with: {size: 1}}}\nprocedures: {'eat(m, k)': \"repeat k { "
          "m.write; }\"}\nprograms: {" +
          programs + "}");
    });
  };
  EXPECT_NE(error("p: \"q.read => message;\"").find("'=>' is no sign here: it is '->'"),
            std::string::npos);
  EXPECT_NE(error("p: \"call eat(q);\"").find("takes 2 arguments: eat(m, k)"), std::string::npos);
  EXPECT_NE(error("a: q.write;, p: q.write(1);").find("is given 'write' with values elsewhere"),
            std::string::npos);
}

TEST(Language, NamesAreOneSpace) {
  const auto error = [](const std::string& text) {
    return test::error_of([&] { system_from(text); });
  };
  EXPECT_NE(error("constants: {m: 1}\nmodels: {m: {use: mutex}}\nprograms: {p: skip;}")
                .find("the name 'm' is taken: s.yaml:1:13 (s.yaml:2:10)"),
            std::string::npos);
  EXPECT_NE(error("variables: \"var p: 0..1;\"\nprograms: {p: skip;}").find("is taken"),
            std::string::npos);
}

}  // namespace
}  // namespace maide
