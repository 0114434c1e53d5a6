#include "maide/check/engines/spin_engine.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>

#include "maide/base/file.hpp"
#include "maide/check/build/parse_program.hpp"
#include "maide/check/build/system_file.hpp"
#include "systems.hpp"

namespace maide {
namespace {

PropertyResult check(const System& system, const Property& property,
                     const EngineOptions& options = {}) {
  return SpinEngine().check(system, property, options);
}

TEST(SpinEngine, FindsAShortestDeadlock) {
  const System system = test::system_of("  p: loop { via.write; sync.read -> message; }\n");
  const PropertyResult result = check(system, test::deadlock_property());
  EXPECT_EQ(result.verdict, Verdict::violated);
  ASSERT_TRUE(result.trace);
  EXPECT_EQ(result.trace->steps.size(), 2u);
  EXPECT_EQ(find_flaw(system, test::deadlock_property(), *result.trace), "");
}

TEST(SpinEngine, ProgramsThatEndAreNoDeadlock) {
  const PropertyResult result =
      check(test::system_of("  p: via.write;\n"), test::deadlock_property());
  EXPECT_EQ(result.verdict, Verdict::holds);
  EXPECT_EQ(result.states, 2u);
}

TEST(SpinEngine, AnOutputThatNobodyTakesBlocksItsModel) {
  const System system = test::system_of("  p: 'via.write; via.read; via.write;'\n");
  const PropertyResult result = check(system, test::deadlock_property());
  EXPECT_EQ(result.verdict, Verdict::violated);
  ASSERT_TRUE(result.trace);
  EXPECT_EQ(result.trace->steps.size(), 2u);
}

TEST(SpinEngine, TheBoundIsWhatTheInstanceSays) {
  const std::string program = "  p: repeat 3 { via.write; }\n";
  const System stop = test::system_of(program, "", "stop");
  EXPECT_EQ(check(stop, test::deadlock_property()).verdict, Verdict::holds);
  const CutResult cut = SpinEngine().find_cut(stop, {});
  EXPECT_EQ(cut.verdict, Verdict::violated);
  ASSERT_TRUE(cut.trace);
  EXPECT_EQ(cut.trace->steps.size(), 3u);
  const System wait = test::system_of(program, "", "wait");
  EXPECT_EQ(check(wait, test::deadlock_property()).verdict, Verdict::violated);
  EXPECT_EQ(SpinEngine().find_cut(wait, {}).verdict, Verdict::holds);
  const System drop = test::system_of(program, "", "drop");
  EXPECT_EQ(check(drop, test::deadlock_property()).verdict, Verdict::holds);
}

TEST(SpinEngine, FormulasOverEventsAndLabels) {
  const System system =
      test::system_of("  p: '@go via.write; @on loop { sync.write; sync.read -> message; }'\n",
                      "  start: p@go\n"
                      "  goes_on: G F sync!message\n"
                      "  written: F via.write\n"
                      "  not_for_ever: F G via.write\n"
                      "  once: {ltl: \"G (via.write -> p@on)\", fairness: none}\n"
                      "  wrong: {always: \"!sync!message\"}\n"
                      "  ends: F p@end\n");
  const Verdict expected[] = {Verdict::holds,    Verdict::holds, Verdict::holds,
                              Verdict::violated, Verdict::holds, Verdict::violated,
                              Verdict::violated};
  for (std::size_t index = 0; index < system.properties.size(); ++index) {
    const Property& property = system.properties[index];
    const PropertyResult result = check(system, property);
    EXPECT_EQ(result.verdict, expected[index]) << property.name;
    EXPECT_EQ(result.trace.has_value(), expected[index] == Verdict::violated) << property.name;
    if (result.trace) {
      EXPECT_EQ(find_flaw(system, property, *result.trace), "");
    }
  }
}

// A program that waits for an output, or for quiet, is served under weak fairness though the model
// serves another one again and again.
TEST(SpinEngine, WeakFairnessIsAboutProgramsThatWait) {
  const System system = test::system_of(
      "  busy: 'loop { switch sync.write { quiet { } } }'\n"
      "  late: 'switch sync.write { quiet { } }'\n",
      "  fair: F late@end\n"
      "  unfair: {ltl: F late@end, fairness: none}\n");
  EXPECT_EQ(check(system, system.properties[0]).verdict, Verdict::holds);
  EXPECT_EQ(check(system, system.properties[1]).verdict, Verdict::violated);
}

TEST(SpinEngine, AFormulaThatIsTooLargeForSpinIsNamed) {
  std::string formula = "p@end";
  for (int count = 0; count < 9; ++count) formula += " <-> p@end";
  const System system = test::system_of("  p: via.write;\n", "  large: " + formula + "\n");
  EXPECT_NE(test::error_of([&] {
              check(system, system.properties[0]);
            }).find("property 'large' (system.yaml:7:3) is too large"),
            std::string::npos);
}

TEST(SpinEngine, ManyProcessesUnderFairness) {
  std::string programs;
  for (int count = 0; count < 80; ++count) programs += "  p" + std::to_string(count) + ": skip;\n";
  const System system = test::system_of(programs, "  ends: F p7@end\n");
  EXPECT_EQ(check(system, system.properties[0]).verdict, Verdict::holds);
}

TEST(SpinEngine, MoreModelsThanSpinHasChannelsFor) {
  std::string text = "models:\n";
  for (int count = 0; count < 126; ++count) {
    text += "  m" + std::to_string(count) + ": {file: buffered.dot}\n";
  }
  const System system =
      parse_system(text + "programs: {p: skip;}\n", "system.yaml", test::test_model);
  EXPECT_EQ(test::error_of([&] { check(system, test::deadlock_property()); }),
            "SPIN takes at most 125 models, each of two channels");
}

TEST(SpinEngine, AKeywordOfPromelaMayNameAnInput) {
  System system;
  ModelInstance model;
  model.name = "m";
  model.automaton = InterfaceAutomaton({"D_proctype", "proctype", "idling"}, {}, 1);
  for (Symbol input = 0; input < 3; ++input) {
    model.automaton.add_transition(0, {Action::Kind::input, input}, 0);
  }
  system.models.push_back(model);
  const std::string text = "m.D_proctype; m.proctype; m.idling;";
  const auto interfaces = system.interfaces();
  system.programs.push_back(
      parse_program("p", ScalarText(text, text, {"system.yaml", 1, 1}), system));
  EXPECT_EQ(check(system, test::deadlock_property()).verdict, Verdict::holds);
  Property ends;
  ends.name = "ends";
  const std::string formula = "F p@end";
  ends.formula = parse_formula(ScalarText(formula, formula, {"system.yaml", 1, 1}),
                               {system.programs, interfaces});
  EXPECT_EQ(check(system, ends).verdict, Verdict::holds);
}

// Whatever happens while a shorter counterexample is looked for, the one that is there is true.
TEST(SpinEngine, AViolationIsKeptWhenShorteningItFails) {
  const TempDir folder("compiler");
  const std::string compiler = (folder.path() / "cc").string();
  write_file_atomically(compiler,
                        "#!/bin/sh\ncase \"$*\" in *-DREACH*) exit 1;; esac\nexec cc \"$@\"\n");
  std::filesystem::permissions(compiler, std::filesystem::perms::owner_all);
  SpinOptions tools;
  tools.compiler = compiler;
  const System system = test::system_of("  p: loop { via.write; sync.read -> message; }\n");
  const PropertyResult result = SpinEngine(tools).check(system, test::deadlock_property(), {});
  EXPECT_EQ(result.verdict, Verdict::violated);
  EXPECT_TRUE(result.trace);
}

TEST(SpinEngine, TheLastEventIsForgottenWhenNothingFollows) {
  const System system =
      test::system_of("  p: via.write;\n", "  stays: F G via.write\n  goes: F G !via.write\n");
  EXPECT_EQ(check(system, system.properties[0]).verdict, Verdict::violated);
  EXPECT_EQ(check(system, system.properties[1]).verdict, Verdict::holds);
}

TEST(SpinEngine, WeakFairnessLetsEveryProgramGoOn) {
  const System system =
      test::system_of("  p: loop { if * { } else { } }\n  q: '@go via.write;'\n",
                      "  fair: F q@end\n  unfair: {ltl: F q@end, fairness: none}\n");
  EXPECT_EQ(check(system, system.properties[0]).verdict, Verdict::holds);
  EXPECT_EQ(check(system, system.properties[1]).verdict, Verdict::violated);
}

TEST(SpinEngine, CutRunsViolateWithABadPrefixOnly) {
  const System system =
      test::system_of("  p: 'repeat 3 { via.write; } @later sync.read -> message;'\n",
                      "  later: F p@later\n  never: {always: \"!via.write\"}\n");
  EXPECT_EQ(check(system, system.properties[0]).verdict, Verdict::holds);
  EXPECT_EQ(check(system, system.properties[1]).verdict, Verdict::violated);
}

// A sender that may die, a receiver with a variable, and a shared one.
System system_with_state(const std::string& receiver, const std::string& properties = "") {
  return parse_system(
      "models:\n  q: {use: queue, with: {size: 2}}\n"
      "variables: 'var n: 0..2;'\n"
      "programs:\n"
      "  w: {do: 'var left: 0..3 = 3; while (left > 0) { q.write(left % 2); "
      "left = left - 1; } n = 2;', may_die: true}\n"
      "  r: '" +
          receiver + "'\n" + properties,
      "s.yaml");
}

TEST(SpinEngine, SaysWhatItCannotCheck) {
  const System system =
      test::system_of("  p: '@a via.write;'\n",
                      "  next: X p@a\n  strong: {ltl: F p@a, fairness: strong}\n  good: F p@a\n");
  const SpinEngine engine;
  EXPECT_NE(engine.obstacle(system, system.properties[0]), "");
  EXPECT_NE(engine.obstacle(system, system.properties[1]), "");
  EXPECT_EQ(engine.obstacle(system, system.properties[2]), "");
  Property stuck;
  stuck.kind = Property::Kind::stuck;
  EXPECT_NE(engine.obstacle(system, stuck), "");
  const System fair = system_with_state("if fair * { q.read; }",
                                        "properties:\n  fair: F n == 2\n  safe: \"G n < 2\"\n"
                                        "  any: {ltl: F n == 2, fairness: none}\n");
  EXPECT_NE(engine.obstacle(fair, fair.properties[0]), "");
  EXPECT_EQ(engine.obstacle(fair, fair.properties[1]), "");
  EXPECT_EQ(engine.obstacle(fair, fair.properties[2]), "");
}

TEST(SpinEngine, DeathsErrorsAndRest) {
  const System resting = system_with_state("loop { idle q.read -> message; }");
  const PropertyResult holds = check(resting, test::deadlock_property());
  EXPECT_EQ(holds.verdict, Verdict::holds);
  EXPECT_EQ(holds.states, NativeEngine().check(resting, test::deadlock_property(), {}).states);
  // The sender may have died; no step is left but that.
  const System waiting = system_with_state("loop { q.read -> message; }");
  const PropertyResult deadlock = check(waiting, test::deadlock_property());
  EXPECT_EQ(deadlock.verdict, Verdict::violated);
  ASSERT_TRUE(deadlock.trace);
  EXPECT_EQ(find_flaw(waiting, test::deadlock_property(), *deadlock.trace), "");
  Property error;
  error.kind = Property::Kind::error;
  const System failing =
      system_with_state("loop { idle select { on q.read -> message(1) { n = n + 1; } } }");
  const PropertyResult failed = check(failing, error);  // message(0) has no arm
  EXPECT_EQ(failed.verdict, Verdict::violated);
  ASSERT_TRUE(failed.trace);
  EXPECT_EQ(failed.trace->steps.size(), 6u);
  EXPECT_EQ(find_flaw(failing, error, *failed.trace), "");
  EXPECT_EQ(check(failing, test::deadlock_property()).verdict, Verdict::holds);
}

// The last arrival moves the writer, too: SPIN has as many states, and the same verdicts.
TEST(SpinEngine, ACallThatAllReadersAcknowledge) {
  const System system = parse_system(
      "topics: {chart: {writers: desk, readers: [pilot, clerk], use: queue, with: {depth: 2}, "
      "delivery: acknowledged}}\n"
      "programs:\n"
      "  desk: \"chart.write; @told chart.write; @again skip;\"\n"
      "  pilot: \"chart.read -> message; @has idle chart.read -> message;\"\n"
      "  clerk: \"switch chart.tryread { message { @has skip; } null { @blind skip; } }\"\n"
      "properties:\n"
      "  early: {always: \"!(pilot@end && !desk@told && !desk@end)\"}\n"
      "  blind: {always: \"!(clerk@blind && desk@end)\"}\n"
      "  arrives: {ltl: \"chart[pilot]!arrives R !chart[clerk]!arrives\", fairness: none}\n",
      "s.yaml", test::test_model);
  std::vector<Property> properties = system.properties;
  properties.push_back(test::deadlock_property());
  for (const Property& property : properties) {
    const PropertyResult native = NativeEngine().check(system, property, {}),
                         spin = check(system, property);
    EXPECT_EQ(spin.verdict, native.verdict) << property.name;
    if (spin.trace) {
      EXPECT_EQ(find_flaw(system, property, *spin.trace), "") << property.name;
    }
  }
  EXPECT_EQ(check(system, test::deadlock_property()).states,
            NativeEngine().check(system, test::deadlock_property(), {}).states);
}

// Each reader of a topic has a queue, some with a state more: where a program died.
TEST(SpinEngine, TablesOfTheSamePurposeHaveNamesOfTheirOwn) {
  const System system = parse_system(R"yaml(topics:
  t: {writers: [p, q], readers: [p, q], use: queue, with: {depth: 1}}
programs:
  p: {may_die: true, do: "switch t.write { quiet { } }"}
  q: {may_die: true, do: skip;}
)yaml",
                                     "system.yaml", {});
  const PropertyResult result = check(system, test::deadlock_property());
  EXPECT_EQ(result.verdict, NativeEngine().check(system, test::deadlock_property(), {}).verdict);
}

TEST(SpinEngine, FormulasOverVariablesAndProgramsEvents) {
  const System system = system_with_state("var x: 0..1; loop { idle q.read -> message(x); }",
                                          "properties:\n"
                                          "  counts_down: \"G (w.left < 3 -> G w.left < 3)\"\n"
                                          "  both: \"G !(n == 2 && w.left > 0)\"\n"
                                          "  compared: \"G (r.x <= w.left)\"\n"
                                          "  own: \"G !w:q!message\"\n"
                                          "  others: \"G !r:q!message\"\n"
                                          "  may_die: \"F n == 2\"\n");
  NativeEngine native;
  for (const Property& property : system.properties) {
    const PropertyResult result = check(system, property);
    EXPECT_EQ(result.verdict, native.check(system, property, {}).verdict) << property.name;
    const bool holds =
        property.name == "counts_down" || property.name == "both" || property.name == "own";
    EXPECT_EQ(result.verdict, holds ? Verdict::holds : Verdict::violated) << property.name;
  }
}

TEST(SpinEngine, LimitsMakeTheVerdictInconclusive) {
  const System system = test::system_of("  p: loop { via.write; via.read -> message; }\n");
  EngineOptions options;
  options.control.deadline = std::chrono::steady_clock::now();
  EXPECT_EQ(check(system, test::deadlock_property(), options).verdict, Verdict::inconclusive);
  EXPECT_EQ(check(system, test::deadlock_property(), options).reason, "out of time");
  EngineOptions small;
  small.memory_mib = 1;
  const PropertyResult result = check(system, test::deadlock_property(), small);
  EXPECT_EQ(result.verdict, Verdict::inconclusive);
  EXPECT_EQ(result.reason, "the search needs more than 1 MiB of memory");
}

TEST(SpinEngine, NamesOfAllKinds) {
  const std::vector<std::string> names{
      "s0", "p0",     "end_q0",  "event", "if", "in put", "in_put", "a!b", "main",   "int",
      "\\", "accept", "T0_init", "*/",    "é",  "0",      "quiet",  "cut", "timeout"};
  const Alphabet inputs{std::span(names)};
  InterfaceAutomaton automaton(inputs, Alphabet{std::span(names)}, 2);
  std::string text, formula;
  for (Symbol symbol = 0; symbol < names.size(); ++symbol) {
    automaton.add_transition(0, {Action::Kind::input, symbol}, 1);
    automaton.add_transition(1, {Action::Kind::output, symbol}, 0);
    text += "m.\"" + names[symbol] + "\" -> \"" + names[symbol] + "\"; ";
    formula += (symbol > 0 ? " || " : "") + std::string("m!\"") + names[symbol] + "\"";
  }
  System system;
  ModelInstance model;
  model.name = "m";
  model.automaton = automaton;
  system.models.push_back(model);
  const ProgramInterface interfaces[] = {{"m", &inputs, &inputs}};
  for (const std::string name : {"never", "_pid", "42"}) {
    system.programs.push_back(
        parse_program(name, ScalarText(text, text, {"s.yaml", 1, 1}), system));
  }
  system.models[0].name = "end \" model */";
  Property property;
  property.name = formula = "G F (" + formula + ")";
  property.formula =
      parse_formula(ScalarText(formula, formula, {"f", 1, 1}), {system.programs, interfaces});
  property.fairness = Fairness::none;
  EXPECT_EQ(check(system, test::deadlock_property()).verdict, Verdict::holds);
  EXPECT_EQ(check(system, property).verdict, Verdict::violated);
  // The same with models as variables, where names are those of C.
  for (Program& program : system.programs) program.states[0].may_rest = true;
  EXPECT_EQ(check(system, test::deadlock_property()).verdict, Verdict::holds);
  EXPECT_EQ(check(system, property).verdict, Verdict::violated);
}

TEST(SpinEngine, ConstantFormulas) {
  const System system = test::system_of("  p: via.write;\n",
                                        "  t: 'true'\n  f: 'false'\n  gt: G true\n  ff: F false\n");
  const Verdict expected[] = {Verdict::holds, Verdict::violated, Verdict::holds, Verdict::violated};
  for (std::size_t index = 0; index < 4; ++index) {
    EXPECT_EQ(check(system, system.properties[index]).verdict, expected[index]) << index;
  }
}

TEST(SpinEngine, MissingToolsAreNamed) {
  const System system = test::system_of("  p: via.write;\n");
  SpinOptions no_spin, no_compiler;
  no_spin.spin = "no-such-spin";
  no_compiler.compiler = "no-such-cc";
  EXPECT_NE(test::error_of([&] {
              SpinEngine(no_spin).check(system, test::deadlock_property(), {});
            }).find("'no-such-spin' cannot be run"),
            std::string::npos);
  EXPECT_NE(test::error_of([&] {
              SpinEngine(no_compiler).check(system, test::deadlock_property(), {});
            }).find("'no-such-cc' cannot be run"),
            std::string::npos);
}

}  // namespace
}  // namespace maide
