// The model of a topic, put together from the models of its readers.
#include "topic_composition.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "maide/automata/compare.hpp"
#include "maide/base/error.hpp"
#include "maide/check/rules/built_in_models.hpp"

namespace maide {
namespace {

using Names = std::vector<std::string>;

InterfaceAutomaton queue(std::uint32_t size, bool drops_oldest) {
  return make_queue({size, drops_oldest, {}});
}

// The writer of a rendezvous waits for the reader.
InterfaceAutomaton rendezvous() {
  InterfaceAutomaton port({"write", "read"}, {"message", "written"}, 5);
  port.actors = {{"writer", {"write"}, {"written"}}, {"reader", {"read"}, {"message"}}};
  port.add_transition(0, {Action::Kind::input, 0}, 1);
  port.add_transition(0, {Action::Kind::input, 1}, 2);
  port.add_transition(1, {Action::Kind::input, 1}, 3);
  port.add_transition(2, {Action::Kind::input, 0}, 3);
  port.add_transition(3, {Action::Kind::output, 0}, 4);
  port.add_transition(4, {Action::Kind::output, 1}, 0);
  return port;
}

TEST(TopicComposition, OfOneReaderIsItsModel) {
  const std::vector<InterfaceAutomaton> one{queue(2, true)};
  EXPECT_TRUE(compare(one.front(), test::compose_topic(one, {})).same());
}

TEST(TopicComposition, GivesEachReaderEachMessage) {
  const std::vector<InterfaceAutomaton> readers(2, queue(1, true));
  const InterfaceAutomaton topic = test::compose_topic(readers, {2, false});
  EXPECT_EQ(topic.inputs().names(), (Names{"write", "write2", "read", "read2"}));
  EXPECT_THAT(topic.outputs().names(), testing::UnorderedElementsAre("message", "message2"));
  ASSERT_EQ(topic.actors.size(), 4u);
  EXPECT_EQ(topic.actors[3].name, "reader2");
  // write2, read: the message is there, and the other reader has one, too.
  StateId at = topic.successor(topic.initial(), {Action::Kind::input, 1});
  at = topic.successor(at, {Action::Kind::input, 2});
  EXPECT_EQ(topic.successor(at, {Action::Kind::input, 3}), Mealy::no_state);  // an output is due
  at = topic.successor(at, {Action::Kind::output, *topic.outputs().find("message")});
  at = topic.successor(at, {Action::Kind::input, 3});
  at = topic.successor(at, {Action::Kind::output, *topic.outputs().find("message2")});
  EXPECT_EQ(at, topic.initial());
}

TEST(TopicComposition, WaitsForTheReaderThatIsFull) {
  const std::vector<InterfaceAutomaton> readers{queue(1, false), queue(2, false)};
  const InterfaceAutomaton topic = test::compose_topic(readers, {1, false});
  const StateId full = topic.successor(topic.initial(), {Action::Kind::input, 0});
  EXPECT_EQ(topic.successor(full, {Action::Kind::input, 0}), Mealy::no_state);
}

TEST(TopicComposition, DeliversToOne) {
  const std::vector<InterfaceAutomaton> readers(2, queue(1, false));
  const InterfaceAutomaton topic = test::compose_topic(readers, {1, true});
  EXPECT_FALSE(topic.is_deterministic());
  std::size_t ways = 0;
  for (const auto& transition : topic.transitions(topic.initial())) {
    ways += transition.action == Action{Action::Kind::input, 0} ? 1 : 0;
  }
  EXPECT_EQ(ways, 2u);
}

TEST(TopicComposition, TellsTheWriterWhenAllHaveIt) {
  const std::vector<InterfaceAutomaton> readers(2, rendezvous());
  const InterfaceAutomaton topic = test::compose_topic(readers, {2, false});
  const auto output = [&](const char* name) {
    return Action{Action::Kind::output, *topic.outputs().find(name)};
  };
  StateId at = topic.successor(topic.initial(), {Action::Kind::input, 1});  // write2
  at = topic.successor(at, {Action::Kind::input, 2});                       // read
  at = topic.successor(at, output("message"));
  EXPECT_TRUE(topic.is_quiescent(at));
  EXPECT_EQ(topic.successor(at, {Action::Kind::input, 0}), Mealy::no_state);
  at = topic.successor(at, {Action::Kind::input, 3});  // read2
  at = topic.successor(at, output("message2"));
  EXPECT_EQ(topic.successor(at, output("written")), Mealy::no_state);
  EXPECT_EQ(topic.successor(at, output("written2")), topic.initial());
}

TEST(TopicComposition, NeedsAWriter) {
  EXPECT_THROW(test::compose_topic({}, {}), UsageError);
  const std::vector<InterfaceAutomaton> mutex{make_mutex()};
  EXPECT_THROW(test::compose_topic(mutex, {}), UsageError);
}

}  // namespace
}  // namespace maide
