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
  static ProtocolTimers from(const OptionValues& options);

  void apply_to(eprosima::fastrtps::rtps::WriterTimes& times) const;
  void apply_to(eprosima::fastrtps::rtps::ReaderTimes& times) const;

  // How long after it was matched a reader asks, once, for what the writer has kept or it has
  // refused. 0 where that changes nothing.
  std::chrono::milliseconds settling(const dds::Policies& policies) const;
  // How long after the last event a sample may still be on its way.
  std::chrono::milliseconds floor(const dds::Policies& policies, Transport transport) const;

 private:
  bool short_ = true;
};

}  // namespace maide::fastdds
