// Files that other programs wrote: partial machines, other marks of the initial state, HTML labels,
// labels of no kind that Maide knows.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <optional>
#include <sstream>
#include <string>
#include <variant>
#include <vector>

#include "maide/automata/compare.hpp"
#include "maide/automata/interface_automaton.hpp"
#include "maide/automata/mealy.hpp"
#include "maide/automata/nondeterministic_mealy.hpp"
#include "maide/base/error.hpp"
#include "maide/formats/exporters.hpp"
#include "maide/formats/model_file.hpp"
#include "maide/sul/simulated_sul.hpp"

namespace maide {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using Labels = ModelReading::Labels;

// State a answers x, state b answers nothing.
constexpr const char* partial = "digraph { a -> b [label=\"x/y\"]; }";

std::string error_of(const std::string& text, const ModelReading& reading = {}) {
  try {
    read_dot(text, "m.dot", reading);
  } catch (const ParseError& error) {
    return error.what();
  }
  return "";
}

NondeterministicMealy partial_of(const std::string& text) {
  return std::get<NondeterministicMealy>(read_dot(text, "m.dot"));
}

TEST(ForeignFiles, AMealyMachineMayBePartial) {
  const Model model = read_dot(partial, "m.dot");
  EXPECT_EQ(name_of_kind(model), "partial Mealy machine");
  const NondeterministicMealy& machine = std::get<NondeterministicMealy>(model);
  EXPECT_EQ(machine.size(), 2U);
  EXPECT_TRUE(machine.answers_at(0));
  EXPECT_FALSE(machine.answers_at(1));
  EXPECT_FALSE(machine.to_mealy().has_value());
  // As it is written, it is read.
  std::ostringstream dot, aut;
  write_dot(dot, model);
  EXPECT_FALSE(find_difference(partial_of(dot.str()), machine).has_value());
  write_aut(aut, model);
  EXPECT_EQ(aut.str(), "des (0, 1, 2)\n(0, \"x / y\", 1)\n");
}

TEST(ForeignFiles, PartialMachinesAreComparedByTheirTraces) {
  const NondeterministicMealy left = partial_of(partial);
  const NondeterministicMealy right =
      partial_of("digraph { a -> b [label=\"x/y\"]; b -> c [label=\"x/y\"]; }");
  const auto difference = find_difference(left, right);
  ASSERT_TRUE(difference.has_value());
  EXPECT_EQ(difference->trace.size(), 1U);
  EXPECT_THAT(difference->left, ElementsAre());
  EXPECT_THAT(difference->right, ElementsAre("y"));
  EXPECT_FALSE(find_difference(left, left).has_value());
}

TEST(ForeignFiles, WhatAPartialMachineDoesNotAnswerIsRefused) {
  const SimulatedSul system(partial_of(partial), "sim:m.dot");
  const Mealy machine = system.reference(Translation::eager);
  EXPECT_EQ(machine.size(), 2U);
  EXPECT_EQ(machine.outputs().name(machine.output(1, 0)), "refused");
  EXPECT_EQ(machine.target(1, 0), 1U);
}

TEST(ForeignFiles, PartialMachinesAreExported) {
  const Model model = read_dot(partial, "m.dot");
  for (const Exporter& exporter : exporters()) {
    std::ostringstream text;
    exporter.write(text, model, {});
    EXPECT_FALSE(text.str().empty()) << exporter.name;
  }
  std::ostringstream promela;
  write_promela(promela, model);
  EXPECT_THAT(promela.str(), HasSubstr("end_s1:\n  false;\n"));
}

TEST(ForeignFiles, APromiseOfAHugeTableIsRefused) {
  std::string text = "des (0, 100, 1000000)\n";
  for (int i = 0; i < 100; ++i) {
    text += "(0, \"" + std::to_string(i) + " / y\", " + std::to_string(i) + ")\n";
  }
  EXPECT_THROW(read_aut(text, "m.aut"), ParseError);
}

// A word that leaves a DFA is rejected.
TEST(ForeignFiles, ADfaMayBePartial) {
  const Mealy dfa = std::get<Mealy>(
      read_dot("digraph { a; b [shape=doublecircle]; a -> b [label=i]; a -> a [label=j]; }", "m"));
  EXPECT_EQ(dfa.size(), 3U);
  const auto answer = [&](StateId state, const char* input) {
    return dfa.outputs().name(dfa.output(state, dfa.inputs().at(input)));
  };
  EXPECT_EQ(answer(0, "i"), accepting_output);
  EXPECT_EQ(answer(1, "i"), rejecting_output);
  EXPECT_EQ(dfa.target(1, dfa.inputs().at("i")), 2U);
  EXPECT_EQ(answer(2, "i"), rejecting_output);
  EXPECT_EQ(dfa.target(2, dfa.inputs().at("j")), 2U);
}

// The state in which the machine begins that these statements mark, of a loop from s0 to s1 and
// back.
std::string initial_of(const std::string& statements, const std::string& initial = "") {
  const std::string text = "digraph { s0; s1; " + statements +
                           " s0 -> s1 [label=\"?go\"]; s1 -> s0 [label=\"?back\"]; }";
  const auto automaton = std::get<InterfaceAutomaton>(read_dot(text, "m.dot", {initial}));
  EXPECT_EQ(automaton.size(), 2U) << statements;
  return "s" + std::to_string(automaton.initial());
}

TEST(ForeignFiles, TheInitialStateIsMarkedInManyWays) {
  EXPECT_EQ(initial_of(""), "s0");
  for (const char* statements : {
           "__start0 -> s1;",
           "start [shape=point]; start -> s1;",
           "\"\" [shape=none]; \"\" -> s1 [label=\"\"];",
           "init [style=invis, label=\"\"]; init -> s1;",
           "edge [color=red]; qi -> s1;",
           "initial=s1;",
           "s1 [initial=true];",
           "s0 [initial=false]; s1 [initial=1];",
           "s1 [root=true];",
           "s1 [shape=doublecircle];",
           "s1 [peripheries=2];",
       }) {
    EXPECT_EQ(initial_of(statements), "s1") << statements;
  }
  // Several that could be marks mark none.
  EXPECT_EQ(initial_of("s0 [shape=doublecircle]; s1 [shape=doublecircle];"), "s0");
  EXPECT_THAT(error_of("digraph { i -> s0; j -> s1; s0 -> s1 [label=\"a/b\"]; }"),
              HasSubstr("a second initial state"));
  // A name that is asked for counts more than any mark.
  EXPECT_EQ(initial_of("__start0 -> s1;", "s0"), "s0");
  EXPECT_THAT(error_of(partial, {"c"}), HasSubstr("there is no state 'c' to begin in"));
  const auto numbered = read_aut("des (0, 1, 2)\n(0, \"x / y\", 1)\n", "m.aut", {"1"});
  EXPECT_EQ(std::get<NondeterministicMealy>(numbered).initial(), 1U);
}

TEST(ForeignFiles, RecordsMakeAMooreMachine) {
  const Mealy moore = std::get<Mealy>(
      read_dot("digraph { s0 [label=\"{s0|off}\" shape=record]; s1 [label=\"{ s1 | on }\"]; "
               "__start0 [label=\"\", shape=none]; __start0 -> s0 [label=\"\"]; "
               "s0 -> s1 [label=\"press\"]; s1 -> s0 [label=\"press\"]; }",
               "m.dot"));
  EXPECT_EQ(find_state_outputs(moore), (std::vector<std::string>{"off", "on"}));
}

std::string input_of(const std::string& label) {
  const auto machine =
      std::get<Mealy>(read_dot("digraph { a -> a [label=" + label + "]; }", "m.dot"));
  return machine.inputs().name(0) + "|" + machine.outputs().name(0);
}

TEST(ForeignFiles, HtmlLabelsAreTheirWords) {
  EXPECT_EQ(input_of("<in / out>"), "in|out");
  EXPECT_EQ(input_of("< <b>in</b>/<font color=\"red\">o<sub>1</sub></font> >"), "in|o1");
  EXPECT_EQ(input_of("<<table border=\"0\">\n<tr><td>in</td><td>/</td><td>out</td></tr></table>>"),
            "in|out");
  EXPECT_EQ(input_of("<in<br/>/ a&amp;b&lt;&#99;&#x64;&unknown;>"), "in|a&b<cd&unknown;");
  EXPECT_EQ(input_of("<a\\b / c>"), "a\\b|c");
}

TEST(ForeignFiles, CommentsMayStandBehindBlanks) {
  const Model model = read_dot(
      "# one\n  # two\ndigraph {\n\t# three\n a -> a [label=\"#x/#y\"]; }\n  # four", "m.dot");
  EXPECT_EQ(std::get<Mealy>(model).inputs().name(0), "#x");
  EXPECT_THAT(error_of("digraph { a # b\n }"), HasSubstr("unexpected character '#'"));
}

TEST(ForeignFiles, QuotesMayStandInAnAutLabel) {
  const Model model =
      read_aut("des (0,2,1)\n(0,\"say \"hi\" / ok\",0) (0,\"a, \\\"b\\\" / c\" , 0 )\n", "m.aut");
  EXPECT_THAT(std::get<Mealy>(model).inputs().names(), ElementsAre("say \"hi\"", "a, \"b\""));
}

InterfaceAutomaton opaque(const std::string& text) {
  return std::get<InterfaceAutomaton>(read_aut(text, "m.aut", {"", Labels::any_where_needed}));
}

TEST(ForeignFiles, LabelsMayBeAnythingWhereOneAsksForThat) {
  const std::string text = "des (0,3,3)\n(0,\"send(1)\",1)\n(1,i,2)\n(2,\"?rec\",0)\n";
  EXPECT_THROW(read_aut(text, "m.aut"), ParseError);
  const InterfaceAutomaton automaton = opaque(text);
  EXPECT_TRUE(has_opaque_labels(automaton));
  EXPECT_THAT(automaton.inputs().names(), ElementsAre("send(1)", "i", "?rec"));
  // Where all labels are of a kind that is known, they keep it.
  EXPECT_FALSE(has_opaque_labels(
      read_aut("des (0,1,1)\n(0,\"a / b\",0)\n", "m.aut", {"", Labels::any_where_needed})));
}

// a.(b + c) and a.b + a.c have the same traces; and so with a silent step before a.
TEST(ForeignFiles, OpaqueLabelsAreComparedByTheirTraces) {
  const auto traces = [](const std::string& text) {
    const InterfaceAutomaton automaton = opaque(text);
    std::vector<Symbol> silent;
    if (const auto tau = automaton.inputs().find("tau")) silent.push_back(*tau);
    return automaton_of_traces(automaton, silent, {});
  };
  const auto late = traces("des (0,3,3)\n(0,a,1)\n(1,b,2)\n(1,c,2)\n");
  const auto early = traces("des (0,5,6)\n(0,tau,1)\n(1,a,2)\n(1,a,3)\n(2,b,4)\n(3,c,5)\n");
  const auto less = traces("des (0,2,3)\n(0,a,1)\n(1,b,2)\n");
  EXPECT_EQ(late.size(), 3U);
  const IaComparison differs = compare(late, less, {});
  ASSERT_TRUE(differs.hard.has_value());
  EXPECT_THAT(differs.hard->word, ElementsAre("?a", "?c"));
  const IaComparison same = compare(late, early, {});
  EXPECT_FALSE(same.hard.has_value()) << testing::PrintToString(same.hard->word);
}

}  // namespace
}  // namespace maide
