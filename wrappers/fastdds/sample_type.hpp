// The message of the experiments, as Fast DDS is told of it: its place among those written since
// the reset, from 1. Four bytes of CDR (OMG, "Data Distribution Service Interoperability Wire
// Protocol", version 2.2, 2014, section 10), written by hand: no generator is needed.
#pragma once

#include <cstdint>
#include <fastdds/dds/topic/TopicDataType.hpp>
#include <functional>

namespace maide::fastdds {

struct Sample {
  std::uint32_t number = 0;
};

class SampleType : public eprosima::fastdds::dds::TopicDataType {
 public:
  SampleType();
  bool serialize(void* data, eprosima::fastrtps::rtps::SerializedPayload_t* payload) override;
  bool deserialize(eprosima::fastrtps::rtps::SerializedPayload_t* payload, void* data) override;
  std::function<std::uint32_t()> getSerializedSizeProvider(void* data) override;
  void* createData() override { return new Sample; }
  void deleteData(void* data) override { delete static_cast<Sample*>(data); }
  // One instance: the topic has no key.
  bool getKey(void*, eprosima::fastrtps::rtps::InstanceHandle_t*, bool) override { return false; }
};

}  // namespace maide::fastdds
