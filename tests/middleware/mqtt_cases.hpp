// Configurations of MQTT, and the model that each must have: of a connection as the other
// middlewares have it, of a session that outlives its connection, and of a raw client.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "connection_models.hpp"
#include "made_machine.hpp"
#include "wrapper_checks.hpp"

namespace maide::test {

struct MqttCase {
  std::string name;
  SystemOptions options;
  Mealy model;
  std::size_t states;
};

inline void PrintTo(const MqttCase& tested, std::ostream* out) { *out << tested.name; }

inline SystemOptions mqtt_options(int qos, std::size_t inflight, std::size_t queued) {
  return {{"qos", std::to_string(qos)},
          {"max-inflight", std::to_string(inflight)},
          {"max-queued", std::to_string(queued)},
          {"size", "0"},
          {"inputs", "write,tryread"},
          {"observe", "message,null"}};
}

// A session that the broker keeps: what was sent and not acknowledged, and what is queued; for a
// reader that is away it queues no more than `queued`, the others counted.
inline Mealy make_persistent_session(std::size_t inflight, std::size_t queued) {
  struct State {
    std::size_t messages = 0;
    bool away = false;
    auto operator<=>(const State&) const = default;
  };
  return make_machine({"write", "tryread", "disconnect", "connect"}, State{},
                      [=](State state, const std::string& input) {
                        std::string output = "quiet";
                        if (input == "write") {
                          const std::size_t room = state.away ? queued : inflight + queued;
                          if (state.messages < room) ++state.messages;
                        } else if (input == "tryread") {
                          const bool has_message = !state.away && state.messages > 0;
                          output = has_message ? "message" : "null";
                          if (has_message) --state.messages;
                        } else {
                          state.away = input == "disconnect";
                        }
                        return std::pair(output, state);
                      });
}

inline std::vector<MqttCase> mqtt_cases() {
  std::vector<MqttCase> all;
  for (const int qos : {1, 2}) {
    for (const auto& [inflight, queued] : {std::pair(1, 1), {2, 1}, {1, 2}}) {
      const auto capacity = static_cast<std::size_t>(inflight + queued);
      ConnectionModel model{capacity, WhenFull::drop_newest, true};
      MqttCase made{
          "qos" + std::to_string(qos) + "_inflight_" + std::to_string(inflight) + "_queued_" +
              std::to_string(queued),
          mqtt_options(qos, static_cast<std::size_t>(inflight), static_cast<std::size_t>(queued)),
          {},
          (std::size_t{1} << (capacity + 2)) - 2};
      made.options["payload"] = "gap";
      made.model = make_connection(model);
      all.push_back(made);
      model.payload_gap = false;
      made.name += "_uncounted";
      made.options["payload"] = "none";
      made.model = make_connection(model);
      made.states = capacity + 1;
      all.push_back(std::move(made));
    }
  }
  ConnectionModel clean{2, WhenFull::drop_newest, false, true};
  all.push_back({"clean_session", mqtt_options(1, 1, 1), make_connection(clean), 4});
  all.push_back({"persistent_session", mqtt_options(1, 1, 1), make_persistent_session(1, 1), 6});
  all.push_back(
      {"persistent_session_2_3", mqtt_options(1, 2, 3), make_persistent_session(2, 3), 12});
  for (MqttCase& made : all) {
    if (!made.name.starts_with("clean") && !made.name.starts_with("persistent")) continue;
    made.options["inputs"] = "write,tryread,disconnect,connect";
    if (made.name.starts_with("persistent")) made.options["session"] = "persistent";
  }
  return all;
}

// A raw client that connects once, and two topics, of which the second has a retained message or
// not: what MQTT says of them (OASIS, "MQTT Version 3.1.1", 2014).
inline MqttCase mqtt_single_client() {
  struct State {
    enum class Connection { never, open, ended } connection = Connection::never;
    bool subscribed = false, subscribed_b = false, retained_b = false;
    auto operator<=>(const State&) const = default;
  };
  const std::vector<std::string> inputs{"connect",           "disconnect",   "drop",
                                        "publish_qos0",      "publish_qos1", "publish_retained_b",
                                        "delete_retained_b", "subscribe",    "unsubscribe",
                                        "subscribe_b",       "unsubscribe_b"};
  const auto step = [](State state, const std::string& input) -> std::pair<std::string, State> {
    using Connection = State::Connection;
    if (state.connection != Connection::open) {
      if (state.connection == Connection::ended || input != "connect") return {"closed", state};
      state.connection = Connection::open;
      return {"connack", state};
    }
    if (input == "connect" || input == "disconnect" || input == "drop") {
      return {"closed", {Connection::ended}};
    }
    if (input == "publish_qos0") return {state.subscribed ? "message_qos0" : "quiet", state};
    if (input == "publish_qos1") {
      return {state.subscribed ? "message_qos1,puback" : "puback", state};
    }
    if (input == "publish_retained_b" || input == "delete_retained_b") {
      state.retained_b = input == "publish_retained_b";
      const std::string message = state.retained_b ? "message_retained_b" : "message_empty_b";
      return {state.subscribed_b ? message + ",puback" : "puback", state};
    }
    const bool is_b = input.ends_with("_b");
    const bool subscribes = input.starts_with("subscribe");
    (is_b ? state.subscribed_b : state.subscribed) = subscribes;
    if (!subscribes) return {"unsuback", state};
    return {is_b && state.retained_b ? "suback,message_retained_b" : "suback", state};
  };
  std::string names;
  for (const std::string& input : inputs) names += (names.empty() ? "" : ",") + input;
  return {"single_client",
          {{"alphabet", "protocol"}, {"reconnect", "no"}, {"inputs", names}},
          make_machine(inputs, State{}, step),
          10};
}

}  // namespace maide::test
