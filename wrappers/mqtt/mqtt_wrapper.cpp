#include "mqtt_wrapper.hpp"

#include <fmt/format.h>
#include <mosquitto.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <random>
#include <string_view>
#include <utility>
#include <vector>

#include "maide/base/error.hpp"
#include "mqtt_connection.hpp"
#include "protocol_actions.hpp"

namespace maide::mqtt {
namespace {

// What `inputs=usual` and `observe=usual` stand for depends on the alphabet.
constexpr const char* usual = "usual";

// A broker that was not started here cannot be observed at its work; and unless it has
// set_tcp_nodelay, a small packet may wait for the acknowledgement of the last one: 40 ms.
constexpr std::chrono::milliseconds unobserved_floor{60};

void append(std::vector<std::string>& names, const std::vector<std::string>& more) {
  for (const std::string& name : more) {
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  }
}

OptionSpec inputs_row() {
  std::vector<std::string> names{usual};
  append(names, connection_inputs());
  for (const ProtocolAction& action : protocol_actions()) append(names, {action.name});
  OptionSpec row = common_options::inputs(std::move(names), usual);
  row.help += "; usual: write,read, or with alphabet=protocol all but wills, QoS 2, retained, _b";
  return row;
}

OptionSpec observe_row() {
  std::vector<std::string> names{usual};
  append(names, connection_events());
  for (std::size_t client = 0; client < 2; ++client) {
    for (const std::string& event : protocol_events()) {
      append(names, {client_prefix(client) + event});
    }
  }
  OptionSpec row = common_options::observe(std::move(names), usual);
  row.help += "; usual: message, or with alphabet=protocol all";
  return row;
}

// An option of the other alphabet would silently do nothing.
void refuse_options_of(const char* alphabet, const OptionValues& options,
                       const std::vector<OptionSpec>& rows,
                       const std::vector<std::string_view>& shared) {
  for (const OptionSpec& row : rows) {
    const bool is_shared = std::find(shared.begin(), shared.end(), row.key) != shared.end();
    if (is_shared || options.is(row.key, row.default_value)) continue;
    throw UsageError(
        fmt::format("option {}: it means something with alphabet={} only", row.key, alphabet));
  }
}

// What is in flight is counted by the messages that come out.
void require_messages(const OptionValues& options) {
  const std::vector<std::string> observed = options.list("observe");
  for (const char* name : {usual, "message"}) {
    if (std::find(observed.begin(), observed.end(), name) != observed.end()) return;
  }
  if (options.number("size") == 0) return;
  throw UsageError(fmt::format(
      "option observe: size={} counts messages in flight, so 'message' must be observed",
      options.number("size")));
}

std::string libmosquitto_version() {
  int major = 0, minor = 0, revision = 0;
  mosquitto_lib_version(&major, &minor, &revision);
  return fmt::format("{}.{}.{}", major, minor, revision);
}

// Several wrappers may share a given broker; their clients and topics must not meet.
std::string unique_name() {
  std::random_device random;
  return fmt::format("maide-{:08x}{:08x}-", random(), random());
}

}  // namespace

MqttWrapper::MqttWrapper() {
  description_.name = "mqtt";
  description_.summary = "MQTT: mosquitto, with a publisher and a subscriber, or raw clients";
  const std::string version = mosquitto_version();
  description_.versions = {{"mqtt", version.empty() ? "no mosquitto" : "mosquitto " + version},
                           {"libmosquitto", libmosquitto_version()},
                           {"wrapper", "1"}};
  description_.options = {
      OptionSpec::choice(
          "alphabet", "connection", {"connection", "protocol"},
          "connection: a publisher and a subscriber, as programs use them; protocol: "
          "packets and what comes back"),
      inputs_row(), observe_row()};
  for (auto* rows : {&ConnectionOptions::options, &RawClientOptions::options, &Broker::options}) {
    for (OptionSpec& row : rows()) description_.options.push_back(std::move(row));
  }
}

SystemSetup MqttWrapper::configure(const OptionValues& options) {
  const BrokerLimits limits = Broker::limits(options);
  is_protocol_ = options.is("alphabet", "protocol");
  SystemSetup setup;
  if (is_protocol_) {
    refuse_options_of("connection", options, ConnectionOptions::options(), {"qos", "session"});
    raw_clients_ = RawClientOptions::from(options);
    setup = protocol_setup(raw_clients_);
  } else {
    refuse_options_of("protocol", options, RawClientOptions::options(), {});
    connection_ = ConnectionOptions::from(options, limits);
    require_messages(options);
    setup = connection_setup(connection_, limits, options.is("payload", "gap"));
  }
  broker_.emplace(options);
  if (broker_->process() != nullptr) {
    setup.processes = {broker_->process()->id()};
  } else {
    setup.floor = unobserved_floor;
  }
  name_ = unique_name();
  return setup;
}

std::unique_ptr<SystemInstance> MqttWrapper::reset(EventSink& sink) {
  const std::string name = name_ + std::to_string(++words_);
  if (is_protocol_) return std::make_unique<RawClients>(*broker_, name, raw_clients_, sink);
  return std::make_unique<MqttConnection>(*broker_, name, connection_, sink);
}

}  // namespace maide::mqtt
