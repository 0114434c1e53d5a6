#include "qos.hpp"

namespace maide::cyclonedds {
namespace {

Qos make_qos(const dds::EndPolicies& end, dds_duration_t max_blocking_time) {
  Qos qos(dds_create_qos());
  const auto history = end.keep_all ? DDS_HISTORY_KEEP_ALL : DDS_HISTORY_KEEP_LAST;
  dds_qset_history(qos.get(), history, end.depth);
  dds_qset_reliability(qos.get(),
                       end.reliable ? DDS_RELIABILITY_RELIABLE : DDS_RELIABILITY_BEST_EFFORT,
                       max_blocking_time);
  if (end.transient_local) {
    // What is kept for late readers has a depth of its own, 1 by default.
    dds_qset_durability(qos.get(), DDS_DURABILITY_TRANSIENT_LOCAL);
    dds_qset_durability_service(qos.get(), 0, history, end.depth, DDS_LENGTH_UNLIMITED,
                                DDS_LENGTH_UNLIMITED, DDS_LENGTH_UNLIMITED);
  }
  return qos;
}

}  // namespace

Qos make_reader_qos(const dds::Policies& policies) {
  Qos qos = make_qos(policies.reader, 0);
  const std::int32_t limit = policies.max_samples > 0 ? policies.max_samples : DDS_LENGTH_UNLIMITED;
  dds_qset_resource_limits(qos.get(), limit, DDS_LENGTH_UNLIMITED, DDS_LENGTH_UNLIMITED);
  return qos;
}

Qos make_writer_qos(const dds::Policies& policies) {
  return make_qos(policies.writer, policies.write_waits ? DDS_INFINITY : 0);
}

}  // namespace maide::cyclonedds
