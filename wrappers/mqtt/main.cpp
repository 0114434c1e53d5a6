// maide-wrap-mqtt: a broker of MQTT and its clients as a system under learning.
#include "maide/wire/wrapper/system_wrapper.hpp"
#include "mqtt_wrapper.hpp"

int main(int argc, char** argv) {
  maide::mqtt::MqttWrapper wrapper;
  return maide::run_wrapper(wrapper, argc, argv);
}
