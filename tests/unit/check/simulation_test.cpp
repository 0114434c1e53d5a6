// Runs that are made step by step: what can come next is what the meaning says, forward and back.
#include "maide/check/system/simulation.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>

#include "maide/check/system/trace_file.hpp"
#include "systems.hpp"

namespace maide::test {
namespace {

// The end of a run that takes the first step as long as there is one.
Simulation::End end_of(const System& system) {
  Simulation simulation(system);
  while (simulation.end() == Simulation::End::none) simulation.take(0);
  return simulation.end();
}

TEST(Simulation, GoesForwardAndBack) {
  const System system = system_of("  p: repeat 3 { via.write; }\n  q: via.read -> message;\n");
  Simulation simulation(system);
  Random random(3);
  std::vector<std::vector<Step>> next;
  while (simulation.end() == Simulation::End::none) {
    EXPECT_EQ(simulation.next(), enabled_steps(system, simulation.states().back()));
    next.push_back(simulation.next());
    simulation.take(draw_step(simulation.next(), random));
  }
  EXPECT_EQ(simulation.end(), Simulation::End::ended);
  EXPECT_EQ(replay(system, simulation.trace()), simulation.states());
  while (!simulation.trace().steps.empty()) {
    simulation.go_back();
    EXPECT_EQ(simulation.next(), next.back());
    next.pop_back();
  }
  EXPECT_EQ(simulation.states(), std::vector{initial_state(system)});
}

TEST(Simulation, SaysWhyNothingFollows) {
  using End = Simulation::End;
  EXPECT_EQ(end_of(system_of("  p: sync.write;\n")), End::ended);
  EXPECT_EQ(end_of(system_of("  p: loop { idle sync.read -> message; }\n")), End::at_rest);
  EXPECT_EQ(end_of(system_of("  p: sync.read -> message;\n")), End::deadlock);
  EXPECT_EQ(end_of(system_of("  p: \"var n: 0..1; n = 2; skip;\"\n")), End::error);
  EXPECT_EQ(end_of(system_of("  p: repeat 4 { via.write; }\n")), End::cut);
  // Where programs can do nothing but die.
  const System mortal = system_of("  p: {do: \"sync.read -> message;\", may_die: true}\n");
  Simulation simulation(mortal);
  simulation.take(0);
  EXPECT_EQ(simulation.end(), End::deadlock);
  EXPECT_EQ(simulation.next().size(), 1U);
}

TEST(Simulation, DrawsActorsAndThenTheirSteps) {
  // a has one step, b three.
  const System system = system_of("  a: skip; sync.write;\n  b: \"var n: 0..2; n = any 0..2;\"\n");
  const Simulation simulation(system);
  ASSERT_EQ(simulation.next().size(), 4U);
  Random random(1);
  std::map<std::uint32_t, int> times;
  for (int i = 0; i < 1000; ++i)
    ++times[simulation.next()[draw_step(simulation.next(), random)].actor];
  EXPECT_NEAR(times[0], 500, 80);
  EXPECT_NEAR(times[1], 500, 80);
}

// A step that uses many models, each with many states.
TEST(Simulation, OfATopicWithManyReadersIsReadBack) {
  std::string text = "topics:\n  image: {writers: w, readers: [r0";
  for (int i = 1; i < 12; ++i) text += ", r" + std::to_string(i);
  text += "], use: queue, with: {size: 60}}\nprograms:\n  w: image.write;\n";
  for (int i = 0; i < 12; ++i) text += "  r" + std::to_string(i) + ": image.read -> message;\n";
  const System system = parse_system(text, "wide.yaml");
  Simulation simulation(system);
  simulation.take(0);
  const Json file = trace_file_to_json(system, "", simulation.trace());
  EXPECT_EQ(parse_trace(to_json_line(file), "t.json", system).trace, simulation.trace());
}

}  // namespace
}  // namespace maide::test
