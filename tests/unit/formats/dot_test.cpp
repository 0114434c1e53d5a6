// DOT: what is written is read back as it was; the language's corners; errors and their places.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <sstream>

#include "maide/automata/compare.hpp"
#include "maide/automata/mealy.hpp"
#include "maide/automata/random_automata.hpp"
#include "maide/formats/model_file.hpp"

namespace maide {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::string dot_of(const Model& model) {
  std::ostringstream out;
  write_dot(out, model);
  return out.str();
}

Mealy mealy_of(const std::string& text) { return std::get<Mealy>(read_dot(text, "m.dot")); }
InterfaceAutomaton ia_of(const std::string& text) {
  return std::get<InterfaceAutomaton>(read_dot(text, "m.dot"));
}

std::string error_of(const std::string& text) {
  try {
    read_dot(text, "m.dot");
  } catch (const ParseError& error) {
    return error.what();
  }
  return "no error";
}

// Equal in everything, numbers of states and symbols included.
void expect_same(const Mealy& left, const Mealy& right) {
  ASSERT_EQ(left.inputs(), right.inputs());
  ASSERT_EQ(left.outputs(), right.outputs());
  ASSERT_EQ(left.size(), right.size());
  EXPECT_EQ(left.initial(), right.initial());
  EXPECT_EQ(left.origin, right.origin);
  EXPECT_EQ(left.actors, right.actors);
  for (StateId state = 0; state < left.size(); ++state) {
    for (Symbol input = 0; input < left.inputs().size(); ++input) {
      ASSERT_EQ(left.target(state, input), right.target(state, input));
      ASSERT_EQ(left.output(state, input), right.output(state, input));
    }
  }
}

const std::vector<std::string> strange_names{
    "plain", "a / b",      "a/b",       "/camera/image", "/",           " / ",   "x /",
    "/ x",   "\"quoted\"", "in \"it\"", " edges ",       "back\\slash", "\\n",   "new\nline",
    "a,b",   "zwölf μs",   "?query",    "!bang",         "a;b",         "{x|y}", "<html>",
    "//",    "tab\tbed",   "\\"};

TEST(Dot, RandomMealyMachinesRoundTrip) {
  Random random(1);
  for (int round = 0; round < 60; ++round) {
    Mealy machine =
        random_mealy({1 + random.below(20), 1 + random.below(5), 1 + random.below(4)}, random);
    machine.set_initial(static_cast<StateId>(random.below(machine.size())));
    machine.origin = {{"sul", "port kind=strict"}, {"odd key", "a \"b\" \\ c\nd"}};
    machine.actors = {{"writer", {"i0"}, {"o0"}}};
    expect_same(machine, mealy_of(dot_of(machine)));
  }
}

TEST(Dot, RandomInterfaceAutomataRoundTrip) {
  Random random(2);
  for (int round = 0; round < 60; ++round) {
    RandomInterfaceAutomatonOptions options;
    options.states = 1 + random.below(20);
    options.deterministic = random.chance(0.5);
    InterfaceAutomaton automaton = random_interface_automaton(options, random);
    automaton.set_initial(static_cast<StateId>(random.below(automaton.size())));
    automaton.origin = {{"bound", "6"}, {"seed", "7"}};
    automaton.hidden_returns = {"i0"};
    automaton.actors = {{"a b", {"i0"}, {}}, {"c", {"i1"}, {"o1", "o0"}}};
    EXPECT_EQ(automaton, ia_of(dot_of(automaton)));
  }
}

TEST(Dot, StrengthRoundTripsOrIsAnErrorWithItsPlace) {
  for (const char* strength : {"exact", "weak: chained=0,pumped=0,random=0",
                               "extra-states=1,chained=3,pumped=64,random=4000"}) {
    Mealy machine({"a"}, {"x"}, 1);
    machine.set_transition(0, 0, 0, 0);
    machine.origin = {{"maide", "1.2.3"}, {"strength", strength}};
    expect_same(machine, mealy_of(dot_of(machine)));
    InterfaceAutomaton automaton({"a"}, {"x"}, 1);
    automaton.origin = machine.origin;
    EXPECT_EQ(automaton, ia_of(dot_of(automaton)));
  }
  try {
    read_dot("digraph g {\n  strength=\"weak: strong\";\n __start0 -> a; a -> a [label=\"?x\"]; }",
             "m.dot");
    FAIL();
  } catch (const ParseError& error) {
    EXPECT_EQ(error.position().line, 2);
    EXPECT_NE(std::string(error.what()).find("'strong' is no strength"), std::string::npos)
        << error.what();
  }
}

TEST(Dot, StrangeNamesRoundTrip) {
  const Alphabet names{std::span<const std::string>(strange_names)};
  Mealy machine(names, names, 1);
  for (Symbol symbol = 0; symbol < names.size(); ++symbol) {
    machine.set_transition(0, symbol, static_cast<Symbol>(names.size() - 1 - symbol), 0);
  }
  expect_same(machine, mealy_of(dot_of(machine)));

  InterfaceAutomaton automaton(names, names, 2);
  for (Symbol symbol = 0; symbol < names.size(); ++symbol) {
    automaton.add_transition(0, {Action::Kind::input, symbol}, 1);
    automaton.add_transition(1, {Action::Kind::output, symbol}, 0);
    automaton.mark_unexplored(1, symbol);
  }
  EXPECT_EQ(automaton, ia_of(dot_of(automaton)));
}

TEST(Dot, MachinesWhoseLabelsMisleadKeepTheirKind) {
  Mealy queries({"?a", "!b"}, {"x", "y"}, 1);
  queries.set_transition(0, 0, 0, 0);
  queries.set_transition(0, 1, 1, 0);
  expect_same(queries, mealy_of(dot_of(queries)));
  expect_same(Mealy({}, {"x"}, 1), mealy_of(dot_of(Mealy({}, {"x"}, 1))));
  const InterfaceAutomaton idle({"a"}, {}, 2);
  EXPECT_EQ(idle, ia_of(dot_of(idle)));
}

TEST(Dot, UnderstandsTheLanguage) {
  const Mealy machine = mealy_of(R"(# a preprocessor's line
strict DiGraph "my machine" {  // a comment
  rankdir=LR; versions="1 / 2"
  graph [fontname="x"] node [shape=circle, color="red"]; edge [label="a/0"];
  off -> on -> "o" + "ff";  /* the default label: a/0 */
  off:port:n -> off [color=blue; label="b / 1", weight=2][penwidth=3]
  subgraph cluster { edge [label = "b/ x y "]; {on} -> on }
}
)");
  EXPECT_THAT(machine.inputs().names(), ElementsAre("a", "b"));
  EXPECT_THAT(machine.outputs().names(), ElementsAre("0", "1", "x y"));
  EXPECT_EQ(machine.size(), 2U);
  EXPECT_EQ(machine.initial(), 0U);
  EXPECT_EQ(machine.origin, (Origin{{"versions", "1 / 2"}}));
  EXPECT_EQ(machine.output_word(Word{0, 1, 0, 1}), (Word{0, 2, 0, 1}));
}

TEST(Dot, InitialStateIsMarkedOrTheFirstNode) {
  EXPECT_EQ(ia_of("digraph { a; b; a -> b [label=\"?x\"]; __start0 -> b }").initial(), 1U);
  EXPECT_EQ(ia_of("digraph { b -> a [label=\"?x\"]; a }").initial(), 0U);
}

TEST(Dot, EmptyOutputIsQuiet) {
  EXPECT_THAT(mealy_of("digraph { a -> a [label=\"x /\"] }").outputs().names(),
              ElementsAre("quiet"));
}

TEST(Dot, ReadsTheReferenceModels) {
  struct Size {
    const char* file;
    std::size_t states, transitions;
  };
  for (const Size& expected :
       {Size{"port", 4, 5}, Size{"buffered", 4, 6}, Size{"buffered-tryread", 4, 8},
        Size{"strict-3", 8, 11}, Size{"strict-3-tryread", 8, 15},
        Size{"strict-3-tryread-absorb", 8, 16}, Size{"strict-6", 14, 20}}) {
    const auto automaton = read_interface_automaton(std::string(MAIDE_SOURCE_DIR "/tests/models/") +
                                                    expected.file + ".dot");
    EXPECT_EQ(automaton.size(), expected.states) << expected.file;
    EXPECT_EQ(automaton.transition_count(), expected.transitions) << expected.file;
  }
}

TEST(Dot, ErrorsSayWhatAndWhere) {
  struct Case {
    const char* text;
    const char* error;
  };
  for (const Case& broken : {
           Case{"", "'digraph' expected (m.dot:1:1)"},
           Case{"graph { a -- b }",
                "an undirected graph is not a model: 'digraph' expected (m.dot"},
           Case{"digraph {\n  a -> ;\n}", "a node expected (m.dot:2:8)"},
           Case{"digraph { a -- b }", "'--' in a directed graph: '->' expected (m.dot:1:13)"},
           Case{"digraph { a", "'}' expected before the end of the file (m.dot:1:12)"},
           Case{"digraph { } x", "text after the end of the graph (m.dot:1:13)"},
           Case{"digraph { }", "the graph has no states (m.dot)"},
           Case{"digraph { a [label=<b] }", "unfinished HTML label (m.dot:1:20)"},
           Case{"digraph { /* a", "unfinished comment (m.dot:1:11)"},
           Case{"digraph { \"ä", "unfinished quoted name (m.dot:1:11)"},
           Case{"digraph { ä [x=\"ö\"] $ }", "unexpected character '$' (m.dot:1:23)"},
           Case{"digraph { a -> a }", "an edge without a label (m.dot:1:13)"},
           Case{"digraph { a -> a [label=\"x\"] }",
                "label 'x' is not \"input / output\" (m.dot:1:25)"},
           Case{"digraph { a -> a [label=\"x/y/z\"] }", "label 'x/y/z' has several '/'"},
           Case{"digraph { a -> a [label=\"x / y / z\"] }",
                "label 'x / y / z' has several \" / \""},
           Case{"digraph { a -> a [label=\"/y\"] }", "label '/y' has no input"},
           Case{"digraph { a -> a [label=\"?x\"]; a -> a [label=y] }",
                "label 'y' is neither \"?input\" nor \"!output\" (m.dot:1:46)"},
           Case{"digraph { a -> b [label=\"x/y\"];\n a -> a [label=\"x/y\"]; }",
                "state 'a' has two transitions for input 'x' with the same output (m.dot:2:16)"},
           Case{"digraph { inputs=\"x\"; a -> a [label=\"?y\"] }",
                "input 'y' is not among the declared inputs (m.dot:1:37)"},
           Case{"digraph { inputs=\"x,x\"; a -> a [label=\"?x\"] }",
                "attribute 'inputs': 'x' appears twice in an alphabet (m.dot:1:18)"},
           Case{"digraph { a [unexplored=\"x,\"]; a -> a [label=\"?x\"] }",
                "attribute 'unexplored': a list of names ends with a comma (m.dot:1:25)"},
           Case{"digraph { __start0 -> a; __start0 -> b }", "a second initial state (m.dot:1:35)"},
           Case{"digraph { a -> __start0 }", "which only marks the initial state"},
           Case{"digraph { a -> b [label=\"?x\" absorbed=true] }",
                "only a self-loop of an input can be absorbed (m.dot:1:25)"},
       }) {
    EXPECT_THAT(error_of(broken.text), HasSubstr(broken.error)) << broken.text;
  }
}

TEST(Dot, GroupsThatStandForBillionsOfEdgesAreRefused) {
  std::string group;
  for (int node = 0; node < 4000; ++node) group += " n" + std::to_string(node);
  EXPECT_THAT(error_of("digraph { {" + group + "} -> {" + group + "} }"),
              HasSubstr("too many edges"));
  EXPECT_THAT(error_of("digraph { " + std::string(100000, '{')),
              HasSubstr("subgraphs are nested too deeply"));
}

TEST(ModelFile, OtherExtensionsAndKindsAreRefused) {
  EXPECT_THROW(read_model("model.png"), UsageError);
  EXPECT_THROW(read_model("no-such-file.dot"), UsageError);
  EXPECT_THROW(read_mealy(MAIDE_SOURCE_DIR "/tests/models/port.dot"), UsageError);
}

// As AALpy writes DFAs.
TEST(Dot, DoubleCirclesMakeADfa) {
  const Mealy dfa = mealy_of(
      "digraph g { s0 [label=\"s0\"]; s1 [label=\"s1\", shape=doublecircle];\n"
      "s0 -> s1 [label=\"a\"]; s0 -> s0 [label=\"b\"]; s1 -> s1 [label=\"a\"];\n"
      "s1 -> s0 [label=\"b\"]; __start0 [label=\"\", shape=none]; __start0 -> s0 [label=\"\"]; }");
  EXPECT_EQ(find_initial_output(dfa), rejecting_output);
  EXPECT_EQ(dfa.origin.at("type"), "dfa");
  EXPECT_EQ(dfa.outputs().name(dfa.output(1, 0)), accepting_output);
  EXPECT_EQ(dfa.outputs().name(dfa.output(1, 1)), rejecting_output);
  const std::string written = dot_of(dfa);
  EXPECT_THAT(written, HasSubstr("s1 [shape=\"doublecircle\" label=\"s1\"];"));
  EXPECT_THAT(written, HasSubstr("s0 -> s1 [label=\"a\"];"));
  expect_same(mealy_of(written), dfa);
}

TEST(Dot, OutputsInStatesMakeAMooreMachine) {
  for (const char* separator : {"|", " / "}) {
    const std::string label = std::string("q") + separator;
    const Mealy moore =
        mealy_of("digraph g { s0 [label=\"" + label + "off\"]; s1 [label=\"" + label +
                 "on\"]; __start0 -> s0; s0 -> s1 [label=press]; s1 -> s0 [label=press]; }");
    EXPECT_EQ(find_state_outputs(moore), (std::vector<std::string>{"off", "on"}));
    expect_same(mealy_of(dot_of(moore)), moore);
  }
  EXPECT_THAT(error_of("digraph g { type=moore; s0 [label=q]; s0 -> s0 [label=a]; }"),
              HasSubstr("state 's0' of a Moore machine has no output (m.dot:1:"));
  EXPECT_THAT(error_of("digraph g { s0 [label=\"0|a\"]; s1 [label=\"1|b\"]; s0 -> s1 [label=a]; }"),
              HasSubstr("a Moore machine has one transition for each input in each state, and this "
                        "one has none for some"));
  // Without outputs it is neither.
  EXPECT_THAT(error_of("digraph g { s0; s0 -> s0 [label=a]; }"), HasSubstr("is not"));
}

// A Mealy machine that is marked, but minimal as one, is written with the states that it lacks.
TEST(Dot, AMachineWithoutInputsHasAnOutput) {
  const Mealy machine = mealy_of("digraph g { s0 [shape=doublecircle]; }");
  EXPECT_EQ(find_state_outputs(machine), (std::vector<std::string>{"accept"}));
}

TEST(Dot, ANondeterministicDfaIsNone) {
  EXPECT_THAT(error_of("digraph g { a [shape=doublecircle]; a -> a [label=i]; a -> b [label=i]; "
                       "b -> b [label=i]; }"),
              HasSubstr("a DFA has one transition for each input"));
}

TEST(Dot, WritesAllStatesOfAMooreMachine) {
  Random random(7);
  for (int i = 0; i < 20; ++i) {
    Mealy machine = random_mealy({.states = 8, .inputs = 2, .outputs = 3}, random);
    mark_as_moore(machine, "moore", "o1");
    const Mealy read = mealy_of(dot_of(machine));
    EXPECT_FALSE(find_difference(read, machine).has_value());
    EXPECT_EQ(find_initial_output(read), "o1");
    expect_same(mealy_of(dot_of(read)), read);
  }
}

}  // namespace
}  // namespace maide
