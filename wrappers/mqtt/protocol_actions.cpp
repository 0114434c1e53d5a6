#include "protocol_actions.hpp"

#include <utility>

namespace maide::mqtt {
namespace {

using Kind = ProtocolAction::Kind;

constexpr std::pair<const char*, Kind> of_a_client[] = {
    {"connect", Kind::connect},
    {"connect_will", Kind::connect_will},
    {"connect_will_retain", Kind::connect_will_retain},
    {"disconnect", Kind::disconnect},
    {"drop", Kind::drop},
    {"ping", Kind::ping},
    {"invalid", Kind::invalid},
    {"pubrel", Kind::pubrel},
};

constexpr std::pair<const char*, Kind> of_a_topic[] = {
    {"publish_qos0", Kind::publish_qos0},       {"publish_qos1", Kind::publish_qos1},
    {"publish_qos2", Kind::publish_qos2},       {"publish_retained", Kind::publish_retained},
    {"delete_retained", Kind::delete_retained}, {"subscribe", Kind::subscribe},
    {"unsubscribe", Kind::unsubscribe},
};

std::vector<ProtocolAction> make_actions() {
  std::vector<ProtocolAction> actions;
  for (std::size_t client = 0; client < 2; ++client) {
    const std::string prefix = client_prefix(client);
    for (const auto& [name, kind] : of_a_client) actions.push_back({prefix + name, kind, client});
    for (const auto& [name, kind] : of_a_topic) {
      actions.push_back({prefix + name, kind, client, 0});
      actions.push_back({prefix + name + "_b", kind, client, 1});
    }
  }
  return actions;
}

std::vector<std::string> make_events() {
  std::vector<std::string> events{"connack",  "connack_present", "connack_refused", "puback",
                                  "pubrec",   "pubrel",          "pubcomp",         "suback",
                                  "unsuback", "pingresp",        "closed"};
  for (const char* payload : {"qos0", "qos1", "qos2", "retained", "empty", "will"}) {
    events.push_back(std::string("message_") + payload);
    events.push_back(events.back() + "_b");
  }
  return events;
}

}  // namespace

std::string client_prefix(std::size_t client) { return client == 0 ? "" : "c2_"; }

const std::vector<ProtocolAction>& protocol_actions() {
  static const std::vector<ProtocolAction> actions = make_actions();
  return actions;
}

const std::vector<std::string>& protocol_events() {
  static const std::vector<std::string> events = make_events();
  return events;
}

}  // namespace maide::mqtt
