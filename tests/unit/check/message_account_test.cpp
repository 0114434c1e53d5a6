// What a deadlocked program waits for, counted in messages.
#include "maide/check/verdict/message_account.hpp"

#include <gtest/gtest.h>

#include <deque>

#include "maide/base/random.hpp"
#include "systems.hpp"

namespace maide {
namespace {

// A queue of `depth` messages to which a write is always possible. State: messages held, doubled,
// and whether one is due (then it still counts); the last state: empty, and a read waits.
InterfaceAutomaton losing_queue(std::size_t depth, bool with_actors) {
  InterfaceAutomaton queue({"write", "read"}, {"message"}, 2 * depth + 3);
  const Action write{Action::Kind::input, 0}, read{Action::Kind::input, 1};
  const Action message{Action::Kind::output, 0};
  const auto holds = [](std::size_t count) { return static_cast<StateId>(2 * count); };
  const auto due = [](std::size_t count) { return static_cast<StateId>(2 * count + 1); };
  const auto waiting = static_cast<StateId>(2 * depth + 2);
  for (std::size_t count = 0; count <= depth; ++count) {
    queue.add_transition(holds(count), write, holds(std::min(count + 1, depth)));
    if (count > 0) {
      queue.add_transition(holds(count), read, due(count));
      queue.add_transition(due(count), message, holds(count - 1));
    }
  }
  queue.add_transition(holds(0), read, waiting);
  queue.add_transition(waiting, write, due(1));
  if (with_actors) queue.actors = {{"w", {"write"}, {}}, {"r", {"read"}, {"message"}}};
  return queue;
}

TEST(MessageAccount, CountsWhatAQueueWouldCount) {
  Random random(123);
  for (int round = 0; round < 200; ++round) {
    const std::size_t depth = random.between(1, 4);
    const bool with_actors = random.chance(0.5);
    const System system = parse_system(
        "models: {via: {file: x.dot}}\nprograms:\n  p: loop { via.write; }\n"
        "  q: loop { via.read -> message; }\n",
        "s.yaml", [&](const ModelRequest&) { return losing_queue(depth, with_actors); });
    Trace trace;
    std::vector<GlobalState> states{initial_state(system)};
    std::deque<std::size_t> queue;  // what is in it: numbers of messages
    std::size_t given = 0, taken = 0;
    std::vector<std::size_t> losses;
    for (std::uint64_t steps = random.between(1, 40); steps > 0; --steps) {
      const auto enabled = enabled_steps(system, states.back());
      const Step step = enabled[random.below(enabled.size())];
      const ProgramEdge& edge = edge_of(system, step);
      if (step.actor == 0) {
        ++given;
        if (queue.size() == depth) {
          losses.push_back(trace.steps.size());
        } else {
          queue.push_back(given);
        }
      } else if (edge.kind == ProgramEdge::Kind::take) {
        ++taken;
        queue.pop_front();
      }
      trace.steps.push_back(step);
      states.push_back(apply(system, states.back(), step));
    }
    Awaited awaited;
    awaited.outputs = {0};
    awaited.asking = {1};
    const auto found =
        find_awaited(system, system.programs[1], system.programs[1].edges_of(0)[0].target);
    ASSERT_TRUE(found);
    EXPECT_EQ(found->outputs, awaited.outputs);
    EXPECT_EQ(found->asking, awaited.asking);
    const auto account = take_account(system, trace, states, *found);
    ASSERT_TRUE(account);
    EXPECT_EQ(account->given, given);
    EXPECT_EQ(account->taken, taken);
    EXPECT_EQ(account->held, queue.size());
    ASSERT_EQ(account->losses.size(), losses.size());
    for (std::size_t i = 0; i < losses.size(); ++i) {
      EXPECT_EQ(account->losses[i].step, losses[i]);
      EXPECT_EQ(account->losses[i].held, depth);
      EXPECT_EQ(account->losses[i].count, 1U);
    }
    EXPECT_EQ(account->messages, std::vector<Symbol>{0});
  }
}

TEST(MessageAccount, HasNoCountWhereThereIsNoMost) {
  // A clock: asked, it always answers.
  InterfaceAutomaton clock({"ask", "set"}, {"time"}, 2);
  clock.add_transition(0, {Action::Kind::input, 0}, 1);
  clock.add_transition(0, {Action::Kind::input, 1}, 0);
  clock.add_transition(1, {Action::Kind::output, 0}, 0);
  const auto counts = count_obtainable(clock, {0, {0}, {0}});
  EXPECT_FALSE(counts[0]);
  EXPECT_FALSE(counts[1]);
}

}  // namespace
}  // namespace maide
