// MQTT learned for real, over its wrapper's pipes: what comes out is the model written by hand,
// also when broker and wrapper are killed meanwhile.
#include <gtest/gtest.h>

#include <string>

#include "killed_services.hpp"
#include "maide/automata/compare.hpp"
#include "maide/formats/model_file.hpp"
#include "mqtt_cases.hpp"
#include "wrapper_checks.hpp"

namespace maide {
namespace {

TEST(MqttLearning, FindsTheModelsOfSessions) {
  for (const test::MqttCase& tested : test::mqtt_cases()) {
    if (tested.name != "clean_session" && tested.name != "persistent_session") continue;
    const Mealy learned = test::learn_system("mqtt", tested.options).machine;
    EXPECT_EQ(learned.size(), tested.states) << tested.name;
    EXPECT_FALSE(find_difference(tested.model, learned).has_value()) << tested.name;
  }
}

// QoS 0, and any QoS below what the broker keeps, is the paper's strict port.
TEST(MqttLearning, FindsTheStrictPort) {
  const std::string folder = MAIDE_SOURCE_DIR "/tests/models/";
  for (const char* qos : {"0", "1", "2"}) {
    const InterfaceAutomaton learned = test::learn_system("mqtt", {{"qos", qos}}).automaton;
    EXPECT_TRUE(compare(read_interface_automaton(folder + "strict-3.dot"), learned).same()) << qos;
  }
}

TEST(MqttLearning, FindsTheModelOfARawClient) {
  const test::MqttCase tested = test::mqtt_single_client();
  const Mealy learned = test::learn_system("mqtt", tested.options).machine;
  EXPECT_EQ(tested.model.size(), tested.states);
  EXPECT_EQ(learned.size(), tested.states);
  EXPECT_FALSE(find_difference(tested.model, learned).has_value());
}

TEST(MqttLearning, SurvivesKilledBrokersAndWrappersAndLeavesNoProcess) {
  const test::MqttCase tested = test::mqtt_single_client();
  test::expect_same_model_when_killed("mqtt", tested.options, tested.model, 6);
}

}  // namespace
}  // namespace maide
