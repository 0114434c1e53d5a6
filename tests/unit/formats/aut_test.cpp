// Aldebaran files: round trips, what cannot be written, errors and their places.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

#include "maide/automata/compare.hpp"
#include "maide/automata/mealy.hpp"
#include "maide/automata/random_automata.hpp"
#include "maide/formats/model_file.hpp"

namespace maide {
namespace {

using testing::HasSubstr;

std::string aut_of(const Model& model, MarkLoss loss = MarkLoss::refuse) {
  std::ostringstream out;
  write_aut(out, model, loss);
  return out.str();
}

std::string error_of(const std::string& text) {
  try {
    read_aut(text, "m.aut");
  } catch (const ParseError& error) {
    return error.what();
  }
  return "no error";
}

TEST(Aut, RandomMachinesRoundTrip) {
  Random random(3);
  for (int round = 0; round < 50; ++round) {
    const Mealy machine = random_mealy({1 + random.below(20), 1 + random.below(4), 3}, random);
    const Mealy back = std::get<Mealy>(read_aut(aut_of(machine), "m.aut"));
    EXPECT_EQ(back.size(), machine.size());
    EXPECT_FALSE(find_difference(machine, back));

    const InterfaceAutomaton automaton = random_interface_automaton(
        {2 + random.below(20), 3, 3, 0.4, 0.0, 0.0, random.chance(0.5)}, random);
    const auto again = std::get<InterfaceAutomaton>(read_aut(aut_of(automaton), "m.aut"));
    EXPECT_EQ(again.size(), automaton.size());
    EXPECT_EQ(again.transition_count(), automaton.transition_count());
    EXPECT_FALSE(compare(automaton, again).hard);
  }
}

TEST(Aut, StrangeNamesRoundTrip) {
  InterfaceAutomaton automaton({"a,b", "\"q\"", "back\\slash", "new\nline", "ö)"}, {"x\", 0)"}, 1);
  for (Symbol input = 0; input < 5; ++input) {
    automaton.add_transition(0, {Action::Kind::input, input}, 0);
  }
  automaton.add_transition(0, {Action::Kind::output, 0}, 0);
  EXPECT_EQ(automaton, std::get<InterfaceAutomaton>(read_aut(aut_of(automaton), "m.aut")));
}

TEST(Aut, MayBeginWithAByteOrderMark) {
  const Model plain = read_aut("des (0, 2, 2)\r\n(0, \"?a\", 1)\r\n(1, \"!b\", 0)\r\n", "m.aut");
  EXPECT_EQ(
      std::get<InterfaceAutomaton>(plain),
      std::get<InterfaceAutomaton>(read_aut("\xEF\xBB\xBF"
                                            "des (0, 2, 2)\r\n(0, \"?a\", 1)\r\n(1, \"!b\", 0)\r\n",
                                            "m.aut")));
}

TEST(Aut, MarksAreOnlyDroppedWhenAsked) {
  const std::string folder = MAIDE_SOURCE_DIR "/tests/models/";
  for (const char* name : {"strict-3.dot", "strict-1-absorb.dot", "port.dot"}) {
    const Model model = read_model(folder + name);
    EXPECT_THROW(aut_of(model), UsageError) << name;
    const auto back =
        std::get<InterfaceAutomaton>(read_aut(aut_of(model, MarkLoss::accept), "m.aut"));
    EXPECT_EQ(back.transition_count(), std::get<InterfaceAutomaton>(model).transition_count());
  }
  EXPECT_EQ(marks_of(read_model(folder + "buffered.dot")), "");
}

TEST(Aut, TheFirstOutputOfAMooreMachineIsOnlyDroppedWhenAsked) {
  Mealy machine({"a"}, {"x"}, 1);
  machine.set_transition(0, 0, 0, 0);
  EXPECT_NO_THROW(aut_of(machine));
  mark_as_moore(machine, "moore", "x");
  EXPECT_THROW(aut_of(machine), UsageError);
  EXPECT_EQ(aut_of(machine, MarkLoss::accept), "des (0, 1, 1)\n(0, \"a / x\", 0)\n");
}

TEST(Aut, KindsThatWouldBeMistakenAreRefused) {
  Mealy machine({"?a"}, {"x"}, 1);
  machine.set_transition(0, 0, 0, 0);
  EXPECT_THROW(aut_of(machine), UsageError);
}

TEST(Aut, ReadsLabelsWithoutQuotesAndOddSpacing) {
  const auto automaton = std::get<InterfaceAutomaton>(
      read_aut("des(1,3,2)\r\n(0,?a(1, 2),1)\r\n ( 1 , \"!b\" , 0 )\n\n(1,!c,1)", "m.aut"));
  EXPECT_EQ(automaton.initial(), 1U);
  EXPECT_EQ(automaton.inputs().names(), std::vector<std::string>{"a(1, 2)"});
  EXPECT_EQ(automaton.transition_count(), 3U);
}

TEST(Aut, ErrorsSayWhatAndWhere) {
  struct Case {
    const char* text;
    const char* error;
  };
  for (const Case& broken : {
           Case{"", "'des' expected (m.aut:1:1)"},
           Case{"des (0, 1, 0)", "a model has at least one state (m.aut:1:12)"},
           Case{"des (2, 0, 2)", "the initial state is not below the number of states (m.aut:1:6)"},
           Case{"des (0, 2, 1)\n(0,\"?a\",0)",
                "the first line says 2 transitions, there are 1 (m.aut:1:9)"},
           Case{"des (0, 0, 99999999)", "most of them without transitions (m.aut:1:12)"},
           Case{"des (0, 0, 99999999999999999999)", "the number of states is too large"},
           Case{"des (0, 1, 1)\n(0,\"?a\",1)",
                "state 1 is not below the number of states (m.aut:2:9)"},
           Case{"des (0, 1, 1)\n(0,\"?a,0)", "unfinished label (m.aut:2:4)"},
           Case{"des (0, 1, 1)\n(0,?a 0)", "',' expected after the label (m.aut:2:4)"},
           Case{"des (0, 1, 1)\n(0,\"tau\",0)",
                "label 'tau' is not \"input / output\" (m.aut:2:4)"},
           Case{"des (x, 1, 2)", "the initial state expected (m.aut:1:6)"},
       }) {
    EXPECT_THAT(error_of(broken.text), HasSubstr(broken.error)) << broken.text;
  }
}

}  // namespace
}  // namespace maide
