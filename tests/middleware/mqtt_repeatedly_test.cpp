// The same models of MQTT twenty times in a row, on a busy machine too.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "mqtt_cases.hpp"
#include "wrapper_checks.hpp"

namespace maide {
namespace {

struct Repeated {
  std::string name;
  test::SystemOptions options;
  std::size_t states;
};

std::vector<Repeated> repeated() {
  test::SystemOptions gap = test::mqtt_options(1, 1, 1);
  gap["payload"] = "gap";
  test::SystemOptions persistent = test::mqtt_options(1, 1, 1);
  persistent["session"] = "persistent";
  persistent["inputs"] = "write,tryread,disconnect,connect";
  return {{"drop_newest", gap, 14},
          {"persistent", persistent, 6},
          {"raw_client",
           {{"alphabet", "protocol"}, {"inputs", "connect,drop,publish_qos1,subscribe"}},
           3}};
}

class MqttRepeatedly : public testing::TestWithParam<std::size_t> {};

TEST_P(MqttRepeatedly, GivesTheSameModelTwentyTimes) {
  for (const Repeated& tested : repeated()) {
    SCOPED_TRACE(tested.name);
    test::expect_same_twenty_times("mqtt", tested.options, tested.states, GetParam());
  }
}

INSTANTIATE_TEST_SUITE_P(BusyProcesses, MqttRepeatedly, testing::Values(0, 2));

}  // namespace
}  // namespace maide
