// Timers of Fast DDS's protocol: for how long something may still come while every thread sleeps.
// They say how late a sample is that has to be asked for again, never whether it comes, so by
// default they are made short, and a step need not wait for them.
#pragma once

#include <fastdds/rtps/attributes/ReaderAttributes.h>
#include <fastdds/rtps/attributes/WriterAttributes.h>

#include <chrono>

#include "dds/policies.hpp"
#include "participants.hpp"

namespace maide::fastdds {

class ProtocolTimers {
 public:
  // The rows of the wrapper's table that these come from.
  static OptionSpec option();
  static ProtocolTimers from(const OptionValues& options, Transport transport);

  void apply_to(eprosima::fastrtps::rtps::WriterTimes& times) const;
  void apply_to(eprosima::fastrtps::rtps::ReaderTimes& times) const;

  // How long after the last event a sample may still be on its way.
  std::chrono::milliseconds floor(const dds::Policies& policies) const;

 private:
  bool short_ = true;
  Transport transport_ = Transport::none;
};

}  // namespace maide::fastdds
