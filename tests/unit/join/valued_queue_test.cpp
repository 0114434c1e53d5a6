#include "maide/join/valued_queue.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "maide/automata/compare.hpp"
#include "maide/base/error.hpp"
#include "maide/check/rules/built_in_models.hpp"
#include "maide/formats/model_file.hpp"

namespace maide {
namespace {

using Values = std::vector<std::string>;

InterfaceAutomaton queue_of(std::uint32_t size, bool drops_oldest, const Values& values = {}) {
  QueueSize wanted{size, drops_oldest, {}};
  for (const std::string& value : values) wanted.values.push_back("(" + value + ")");
  return make_queue(wanted);
}

InterfaceAutomaton model(const std::string& name) {
  return read_interface_automaton(MAIDE_SOURCE_DIR "/tests/models/" + name + ".dot");
}

TEST(ValuedQueue, IsTheQueueWithValues) {
  const Values values{"0,new", "1,old", "2,old"};
  for (const std::uint32_t size : {1u, 2u, 3u}) {
    for (const bool drops_oldest : {true, false}) {
      const auto made =
          make_valued_queue(queue_of(size, drops_oldest), values, LossRule::oldest, 10'000);
      ASSERT_TRUE(made);
      EXPECT_TRUE(compare(queue_of(size, drops_oldest, values), *made).same());
    }
  }
}

TEST(ValuedQueue, TellsWhichMessageIsLost) {
  const Values values{"go", "stop"};
  const auto newest = make_valued_queue(queue_of(1, true), values, LossRule::newest, 10'000);
  ASSERT_TRUE(newest);
  const IaComparison comparison = compare(queue_of(1, true, values), *newest);
  ASSERT_TRUE(comparison.hard);
  EXPECT_EQ(comparison.hard->word, (Values{"?write(go)", "?write(stop)", "?read", "!message(go)"}));
}

TEST(ValuedQueue, KeepsWhatWasNeverTried) {
  const auto made =
      make_valued_queue(model("strict-2"), Values{"a", "b"}, LossRule::oldest, 10'000);
  ASSERT_TRUE(made);
  EXPECT_EQ(made->actors[0].inputs, (Values{"write(a)", "write(b)"}));
  std::size_t untried = 0;
  for (StateId state = 0; state < made->size(); ++state) untried += made->unexplored(state).size();
  EXPECT_EQ(untried, 2u * 4u);  // two writes behind each of four contents
}

TEST(ValuedQueue, RefusesWhatIsNone) {
  const Values values{"go", "stop"};
  EXPECT_FALSE(make_valued_queue(make_mutex(), values, LossRule::oldest, 10'000));
  // A message that comes again and again.
  InterfaceAutomaton again({"write", "read"}, {"message"}, 2);
  again.add_transition(0, {Action::Kind::input, 0}, 0);
  again.add_transition(0, {Action::Kind::input, 1}, 1);
  again.add_transition(1, {Action::Kind::output, 0}, 0);
  EXPECT_FALSE(make_valued_queue(again, values, LossRule::oldest, 10'000));
  // One that comes back when the reader does.
  InterfaceAutomaton kept = queue_of(1, true);
  InterfaceAutomaton late({"write", "read", "connect"}, kept.outputs(), kept.size());
  for (StateId state = 0; state < kept.size(); ++state) {
    for (const auto& transition : kept.transitions(state)) {
      late.add_transition(state, transition.action, transition.target);
    }
  }
  late.add_transition(0, {Action::Kind::input, 2}, 1);  // empty before, and not behind it
  EXPECT_FALSE(make_valued_queue(late, values, LossRule::oldest, 10'000));
}

TEST(ValuedQueue, HasALimit) {
  EXPECT_THROW(
      make_valued_queue(queue_of(8, true), Values{"a", "b", "c", "d"}, LossRule::oldest, 1000),
      UsageError);
}

}  // namespace
}  // namespace maide
