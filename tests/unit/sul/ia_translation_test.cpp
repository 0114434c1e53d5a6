#include "maide/sul/ia_translation.hpp"

#include <gtest/gtest.h>

#include "maide/automata/minimize.hpp"
#include "maide/base/error.hpp"
#include "port_models.hpp"

namespace maide {
namespace {

using test::blocking_port;
using test::blocking_port_with_written;
using test::buffered_port;
using test::strict_port;

InterfaceAutomaton there_and_back(const InterfaceAutomaton& automaton, Translation translation) {
  return to_interface_automaton(to_mealy(automaton, translation), translation, automaton.actors);
}

// The same automaton once both are minimal and numbered breadth-first.
void expect_same(const InterfaceAutomaton& left, const InterfaceAutomaton& right) {
  InterfaceAutomaton expected = minimize(right);
  expected.hidden_returns.clear();  // not the translation's business
  EXPECT_EQ(minimize(left), expected);
}

class BothTranslations : public testing::TestWithParam<Translation> {};
INSTANTIATE_TEST_SUITE_P(Translations, BothTranslations,
                         testing::Values(Translation::eager, Translation::av));

TEST_P(BothTranslations, PortModelsSurviveTheRoundTrip) {
  for (const InterfaceAutomaton& port :
       {blocking_port(), blocking_port_with_written(), buffered_port(), strict_port(1),
        strict_port(3), strict_port(3, true), strict_port(6)}) {
    expect_same(there_and_back(port, GetParam()), port);
  }
}

TEST(IaTranslation, SizesOfThePapersTable1) {
  for (StateId size = 1; size <= 6; ++size) {
    const InterfaceAutomaton port = there_and_back(strict_port(size), Translation::eager);
    EXPECT_EQ(port.size(), 2 * size + 2);
    EXPECT_EQ(port.transition_count(), 3 * size + 2);
    EXPECT_EQ(to_mealy(port, Translation::eager).size(), size + 2);
    EXPECT_EQ(to_mealy(port, Translation::av).size(), 2 * size + 2);
  }
  EXPECT_EQ(strict_port(3, true).transition_count(), 15U);
}

TEST(IaTranslation, AbsorbedInputsBecomeMarkedSelfLoopsAndComeBack) {
  InterfaceAutomaton port = strict_port(2);
  InterfaceAutomaton absorbing(port.inputs(), port.outputs(), port.size());
  for (StateId state = 0; state < port.size(); ++state) {
    for (const auto& transition : port.transitions(state)) {
      absorbing.add_transition(state, transition.action, transition.target);
    }
    for (const Symbol input : port.unexplored(state)) {
      absorbing.add_transition(state, {Action::Kind::input, input}, state, true);
    }
  }
  const InterfaceAutomaton back = there_and_back(absorbing, Translation::eager);
  EXPECT_EQ(back.transition_count(), port.transition_count() + 1);
  std::size_t absorbed = 0;
  for (StateId state = 0; state < back.size(); ++state) {
    for (const auto& transition : back.transitions(state)) absorbed += transition.absorbed ? 1 : 0;
    EXPECT_TRUE(back.unexplored(state).empty());
  }
  EXPECT_EQ(absorbed, 1U);
}

TEST(IaTranslation, OutputsOfDifferentActorsComeInEveryOrder) {
  Mealy machine({"go"}, {}, 1);
  machine.set_transition(0, 0, machine.intern_output("a,b,c"), 0);
  const std::vector<Actor> actors{{"one", {"go"}, {"a", "b"}}, {"two", {}, {"c"}}};
  const auto automaton = to_interface_automaton(machine, Translation::eager, actors);
  // Interleavings of a b with c: due sets {ab,c} {b,c} {ab} {c} {b} and the quiescent state.
  EXPECT_EQ(automaton.size(), 6U);
  EXPECT_EQ(automaton.transition_count(), 1U + 2 + 2 + 1 + 1 + 1);
  EXPECT_TRUE(automaton.is_deterministic());
}

TEST(IaTranslation, RefusesMachinesThatBreakItsAssumptions) {
  Mealy moving({"go"}, {}, 2);
  moving.set_transition(0, 0, moving.intern_output("refused"), 1);
  moving.set_transition(1, 0, moving.intern_output("quiet"), 0);
  EXPECT_THROW(to_interface_automaton(moving, Translation::eager, {}), UsageError);

  Mealy endless({"go", delta_input}, {}, 1);
  endless.set_transition(0, 0, endless.intern_output("refused"), 0);
  endless.set_transition(0, 1, endless.intern_output("tick"), 0);
  Mealy talking({"go", delta_input}, {}, 2);
  talking.set_transition(0, 0, talking.intern_output("+"), 1);
  talking.set_transition(0, 1, talking.intern_output("delta"), 0);
  talking.set_transition(1, 0, talking.intern_output("refused"), 1);
  talking.set_transition(1, 1, talking.intern_output("tick"), 1);
  EXPECT_THROW(to_interface_automaton(talking, Translation::av, {}), UsageError);
}

TEST(IaTranslation, FindsReturnsThatAreHidden) {
  SulInfo info;
  info.inputs = {{"write", 0, {"written"}}, {"read", 1, {"message"}}};
  info.outputs = {{"message", 1}};
  for (const Translation translation : {Translation::eager, Translation::av}) {
    const auto hidden = [&](const InterfaceAutomaton& port) {
      return find_hidden_returns(to_mealy(port, translation), translation, info);
    };
    EXPECT_EQ(hidden(blocking_port()), std::vector<std::string>{"write"});
    EXPECT_TRUE(hidden(strict_port(1)).empty());
    EXPECT_TRUE(hidden(buffered_port()).empty());
  }
  info.outputs.push_back({"written", 0});
  const Mealy observed = to_mealy(blocking_port_with_written(), Translation::eager);
  EXPECT_TRUE(find_hidden_returns(observed, Translation::eager, info).empty());
}

}  // namespace
}  // namespace maide
