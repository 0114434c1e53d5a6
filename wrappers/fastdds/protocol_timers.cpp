#include "protocol_timers.hpp"

namespace maide::fastdds {
namespace {

using namespace std::chrono_literals;
using eprosima::fastrtps::Duration_t;

// Ours. An answer is given at once, by a thread that is seen at work; only the time until someone
// asks is hidden, and counts from when its thread gets the processor.
constexpr std::chrono::milliseconds asking = 2ms, answering = 0ms, hidden = 20ms;
// A heartbeat every 3 s is answered within 5 ms. Within a process a reader asks for what it lacks
// only once, 70 ms after it was matched.
constexpr std::chrono::milliseconds default_within_process = 100ms, default_over_network = 3200ms;

Duration_t to_duration(std::chrono::milliseconds time) {
  return {0, static_cast<std::uint32_t>(std::chrono::nanoseconds(time).count())};
}

// What is refused or kept is asked for again only by a reliable reader.
bool repairs(const dds::Policies& policies) {
  return policies.reader.reliable &&
         (policies.max_samples > 0 || policies.keeps_for_late_readers());
}

}  // namespace

OptionSpec ProtocolTimers::option() {
  return OptionSpec::choice("timers", "short", {"short", "default"},
                            "the protocol's timers: as short as they work, or Fast DDS's own "
                            "(heartbeats every 3 s), which sets floor to match");
}

ProtocolTimers ProtocolTimers::from(const OptionValues& options, Transport transport) {
  ProtocolTimers timers;
  timers.transport_ = transport;
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
  // Within a process the writer knows the reader by then, and at once means that a thread is seen
  // at work; over a network the reader asks until it is answered.
  times.initialAcknackDelay = to_duration(transport_ == Transport::none ? 0ms : asking);
  times.heartbeatResponseDelay = to_duration(answering);
}

std::chrono::milliseconds ProtocolTimers::floor(const dds::Policies& policies) const {
  if (!repairs(policies)) return 0ms;
  if (transport_ == Transport::none) return short_ ? 0ms : default_within_process;
  return short_ ? hidden : default_over_network;
}

}  // namespace maide::fastdds
