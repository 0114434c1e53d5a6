// The policies that a user names, as QoS of Fast DDS. What is not named stays Fast DDS's default.
#pragma once

#include <fastdds/dds/publisher/qos/DataWriterQos.hpp>
#include <fastdds/dds/subscriber/qos/DataReaderQos.hpp>

#include "dds/policies.hpp"
#include "protocol_timers.hpp"

namespace maide::fastdds {

eprosima::fastdds::dds::DataReaderQos make_reader_qos(const dds::Policies& policies,
                                                      const ProtocolTimers& timers);
eprosima::fastdds::dds::DataWriterQos make_writer_qos(const dds::Policies& policies,
                                                      const ProtocolTimers& timers);

}  // namespace maide::fastdds
