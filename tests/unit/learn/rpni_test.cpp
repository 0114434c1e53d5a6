#include "maide/learn/passive/rpni.hpp"

#include <gtest/gtest.h>

#include "maide/automata/compare.hpp"
#include "maide/automata/minimize.hpp"
#include "maide/automata/random_automata.hpp"
#include "maide/base/error.hpp"

namespace maide {
namespace {

// Random words of up to `longest` inputs, as the machine answers them.
TraceLog log_of(const Mealy& machine, std::size_t traces, std::size_t longest, Random& random) {
  TraceLog log{machine.inputs(), machine.outputs(), {}};
  for (std::size_t i = 0; i < traces; ++i) {
    Word word(random.between(0, longest));
    for (Symbol& input : word) input = static_cast<Symbol>(random.below(machine.inputs().size()));
    log.traces.push_back({word, machine.output_word(word)});
  }
  return log;
}

// The log's outputs by the learned machine's numbers: it adds "unexplored" at the end.
void expect_agreement(const Mealy& learned, const TraceLog& log) {
  for (const TraceLog::Trace& trace : log.traces) {
    ASSERT_EQ(learned.output_word(trace.inputs), trace.outputs);
  }
}

TEST(Rpni, FindsTheMachineInARichLog) {
  Random random(1);
  for (int i = 0; i < 30; ++i) {
    const Mealy machine = minimize(random_mealy({.states = 12, .inputs = 3, .outputs = 3}, random));
    const PassiveModel learned = learn_passively(log_of(machine, 4000, 14, random));
    EXPECT_FALSE(find_difference(learned.machine, machine).has_value()) << i;
    EXPECT_EQ(learned.machine.size(), machine.size());
    EXPECT_EQ(learned.unseen_transitions, 0U);
  }
}

TEST(Rpni, AgreesWithAnyLog) {
  Random random(2);
  for (int i = 0; i < 200; ++i) {
    const Mealy machine = random_mealy({.states = random.between(1, 30),
                                        .inputs = random.between(1, 4),
                                        .outputs = random.between(1, 3)},
                                       random);
    const TraceLog log = log_of(machine, random.between(0, 60), random.between(1, 30), random);
    const PassiveModel learned = learn_passively(log);
    EXPECT_TRUE(learned.machine.is_complete());
    expect_agreement(learned.machine, log);
    EXPECT_EQ(learned.machine.size(), minimize(learned.machine).size());
  }
}

TEST(Rpni, SaysWhatWasNeverSeen) {
  TraceLog log{{"a", "b"}, {"x"}, {}};
  const PassiveModel empty = learn_passively(log);
  EXPECT_EQ(empty.machine.size(), 1U);
  EXPECT_EQ(empty.unseen_transitions, 2U);
  log.traces.push_back({{0}, {0}});
  const PassiveModel one = learn_passively(log);
  EXPECT_EQ(one.unseen_transitions, 1U);
  EXPECT_EQ(one.machine.outputs().name(one.machine.output(0, 1)), "unexplored");
}

TEST(Rpni, RefusesLogsThatNoMachineGives) {
  TraceLog log{{"a", "b"}, {"x", "y"}, {{{0, 1}, {0, 0}}, {{0, 1}, {0, 1}}}};
  try {
    learn_passively(log);
    FAIL();
  } catch (const UsageError& error) {
    EXPECT_STREQ(error.what(),
                 "trace 2 contradicts one before it: \"a b\" ends in 'y' here and in 'x' there");
  }
  EXPECT_THROW(learn_passively(TraceLog{}), UsageError);
}

}  // namespace
}  // namespace maide
