// What is known of the end of a session is not asked, and what refutes it is not passed on.
#include "maide/learn/oracle/error_outputs.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "maide/base/error.hpp"
#include "maide/base/random.hpp"
#include "maide/learn/lsharp/adaptive_experiment.hpp"
#include "oracles.hpp"

namespace maide {
namespace {

constexpr Symbol a = 0, b = 1;
constexpr Symbol ok = 0, alert = 1, closed = 2;

// b after a ends the session with an alert; then all is closed. Without the alert the other way, b
// before a closes at once.
Mealy session() {
  Mealy machine(Alphabet({"a", "b"}), Alphabet({"ok", "alert: bad", "closed"}), 3);
  machine.set_transition(0, a, ok, 1);
  machine.set_transition(0, b, closed, 2);
  machine.set_transition(1, a, ok, 1);
  machine.set_transition(1, b, alert, 2);
  machine.set_transition(2, a, closed, 2);
  machine.set_transition(2, b, closed, 2);
  return machine;
}

struct Stack {
  explicit Stack(const Mealy& machine, std::vector<std::string> names = {"alert: *", "closed"})
      : system(machine), check(system, ErrorOutputs(std::move(names))), oracle(check) {}
  RecordingOracle system;
  ErrorOutputCheck check;
  ErrorAwareOracle oracle;
};

TEST(ErrorOutputs, AreNamedByPatterns) {
  const ErrorOutputs errors({"alert*", "* & closed"});
  for (const char* name : {"alert", "alert: bad", "hello & closed", "alert & closed"}) {
    EXPECT_TRUE(errors.contains(name)) << name;
  }
  for (const char* name : {"an alert", "hello & closed!", "", "closed"}) {
    EXPECT_FALSE(errors.contains(name)) << name;
  }
}

TEST(ErrorAwareOracle, DoesNotAskBehindAnEndThatItKnows) {
  const Mealy machine = session();
  Stack stack(machine);
  EXPECT_EQ(stack.oracle.ask(Word{a, b}), (Word{ok, alert}));
  EXPECT_EQ(std::get<Word>(stack.system.asked.back()), (Word{a, b, a})) << "what follows an alert";
  const std::size_t asked = stack.system.asked.size();
  EXPECT_EQ(stack.oracle.ask(Word{a, b, b, a, b}), (Word{ok, alert, closed, closed, closed}));
  const std::vector<Query> tree{chain(Word{a, b, a, b}, Word{ok, alert, closed})};
  EXPECT_EQ(stack.oracle.ask(tree)[0].outputs, (Word{ok, alert, closed, closed}));
  EXPECT_EQ(stack.system.asked.size(), asked);
  EXPECT_EQ(stack.oracle.ask(Word{a, a, b, b}), (Word{ok, ok, alert, closed})) << "another word";
  EXPECT_EQ(stack.system.asked.size(), asked + 1);
}

TEST(ErrorAwareOracle, AsksTreesWithoutWhatFollowsAnEnd) {
  const Mealy machine = session();
  Stack stack(machine);
  stack.oracle.ask(Word{a, b});
  DecisionTree tree = chain(Word{a, a, b}, Word{ok, ok});
  graft(tree, 2, alert, chain(Word{b, b}, Word{closed}));
  const std::vector<Query> batch{tree};
  const std::vector<MealyAnswer> answers = stack.oracle.ask(batch);
  EXPECT_EQ(answers[0].inputs, (Word{a, a, b, b, b}));
  EXPECT_EQ(answers[0].outputs, (Word{ok, ok, alert, closed, closed}));
  EXPECT_EQ(std::get<DecisionTree>(stack.system.asked.back()).nodes.size(), 3U);
}

TEST(ErrorAwareOracle, AnswersAsTheSystemWhateverIsAsked) {
  const Mealy machine = session();
  Random random(1);
  Stack stack(machine);
  for (int i = 0; i < 200; ++i) {
    Word word;
    for (std::size_t length = random.between(1, 8); length > 0; --length) {
      word.push_back(static_cast<Symbol>(random.below(2)));
    }
    EXPECT_EQ(stack.oracle.ask(word), machine.output_word(word));
  }
}

// The session goes on after three times b.
TEST(ErrorOutputCheck, RefusesAnAnswerThatGoesOn) {
  Mealy machine = session();
  const StateId third = machine.add_state(), fourth = machine.add_state();
  for (const StateId state : {third, fourth}) {
    machine.set_transition(state, a, closed, 2);
    machine.set_transition(state, b, closed, state);
  }
  machine.set_transition(2, b, closed, third);
  machine.set_transition(third, b, ok, fourth);
  Stack stack(machine);
  EXPECT_EQ(stack.oracle.ask(Word{a, b, b}), (Word{ok, alert, closed}));
  try {
    stack.oracle.ask(Word{a, a, b, b, b});
    FAIL() << "nothing was thrown";
  } catch (const UsageError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("'alert: bad' does not end the session: \"a a b b "
                                                 "b\" was answered"));
  }
}

}  // namespace
}  // namespace maide
