#include "qos.hpp"

#include <algorithm>

namespace maide::fastdds {
namespace {

namespace fast = eprosima::fastdds::dds;

// What DataReaderQos and DataWriterQos have in common, but no base class.
template <typename EntityQos>
EntityQos make_qos(const dds::Policies& policies, const dds::EndPolicies& end) {
  EntityQos qos;
  qos.history().kind = end.keep_all ? fast::KEEP_ALL_HISTORY_QOS : fast::KEEP_LAST_HISTORY_QOS;
  qos.history().depth = end.depth;
  qos.reliability().kind =
      end.reliable ? fast::RELIABLE_RELIABILITY_QOS : fast::BEST_EFFORT_RELIABILITY_QOS;
  qos.durability().kind =
      end.transient_local ? fast::TRANSIENT_LOCAL_DURABILITY_QOS : fast::VOLATILE_DURABILITY_QOS;
  auto& limits = qos.resource_limits();
  if (policies.max_samples > 0) {
    limits.max_samples = limits.max_samples_per_instance = policies.max_samples;
    limits.max_instances = 1;
    limits.allocated_samples = std::min(limits.allocated_samples, policies.max_samples);
  }
  // The default, 400, is less than some depths.
  limits.max_samples_per_instance = std::max(limits.max_samples_per_instance, end.depth);
  return qos;
}

}  // namespace

fast::DataReaderQos make_reader_qos(const dds::Policies& policies, const ProtocolTimers& timers) {
  auto qos = make_qos<fast::DataReaderQos>(policies, policies.reader);
  timers.apply_to(qos.reliable_reader_qos().times);
  return qos;
}

fast::DataWriterQos make_writer_qos(const dds::Policies& policies, const ProtocolTimers& timers) {
  auto qos = make_qos<fast::DataWriterQos>(policies, policies.writer);
  timers.apply_to(qos.reliable_writer_qos().times);
  qos.reliability().max_blocking_time =
      policies.write_waits ? eprosima::fastrtps::c_TimeInfinite : eprosima::fastrtps::c_TimeZero;
  return qos;
}

}  // namespace maide::fastdds
