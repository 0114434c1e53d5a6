#include "protocol_timers.hpp"

namespace maide::fastdds {
namespace {

using namespace std::chrono_literals;
using eprosima::fastrtps::Duration_t;

constexpr std::chrono::milliseconds asking = 10ms, answering = 1ms;  // ours
constexpr std::chrono::milliseconds default_initial_acknack = 70ms, default_heartbeat = 3000ms;

Duration_t to_duration(std::chrono::milliseconds time) {
  return {0, static_cast<std::uint32_t>(std::chrono::nanoseconds(time).count())};
}

// What is refused or kept is asked for again only by a reliable reader.
bool repairs(const dds::Policies& policies) {
  return policies.reliable_reader &&
         (policies.max_samples > 0 || policies.keeps_for_late_readers());
}

}  // namespace

OptionSpec ProtocolTimers::option() {
  return OptionSpec::choice("timers", "short", {"short", "default"},
                            "the protocol's timers: as short as they work, or Fast DDS's own "
                            "(heartbeats every 3 s), which sets floor to match");
}

ProtocolTimers ProtocolTimers::from(const OptionValues& options) {
  ProtocolTimers timers;
  timers.short_ = options.is("timers", "short");
  return timers;
}

void ProtocolTimers::apply_to(eprosima::fastrtps::rtps::WriterTimes& times) const {
  if (!short_) return;
  times.heartbeatPeriod = to_duration(asking);
  times.initialHeartbeatDelay = to_duration(answering);
  times.nackResponseDelay = to_duration(answering);
}

void ProtocolTimers::apply_to(eprosima::fastrtps::rtps::ReaderTimes& times) const {
  if (!short_) return;
  times.initialAcknackDelay = to_duration(asking);
  times.heartbeatResponseDelay = to_duration(answering);
}

std::chrono::milliseconds ProtocolTimers::settling(const dds::Policies& policies) const {
  if (!repairs(policies)) return 0ms;
  return (short_ ? asking : default_initial_acknack) + 2ms;
}

std::chrono::milliseconds ProtocolTimers::floor(const dds::Policies& policies,
                                                Transport transport) const {
  if (transport == Transport::none || !repairs(policies)) return 0ms;
  return short_ ? 2 * asking + 10 * answering : default_heartbeat + 200ms;
}

}  // namespace maide::fastdds
