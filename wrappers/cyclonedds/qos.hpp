// The policies that a user names, as QoS of Cyclone DDS.
#pragma once

#include "dds/policies.hpp"
#include "dds_entity.hpp"

namespace maide::cyclonedds {

Qos make_reader_qos(const dds::Policies& policies);
Qos make_writer_qos(const dds::Policies& policies);

}  // namespace maide::cyclonedds
