// The wrapper for eProsima Fast DDS: `maide learn fastdds history=keep_last depth=10`. Writers
// and readers of one topic, in one process, with the QoS that the user names. The actor `writer`
// calls DataWriter::write; `reader` waits for data on a wait set and takes one sample (read), or
// takes one if there is one (tryread).
//
// transport=none: one participant; Fast DDS hands a sample to the readers of its own process from
// within write, and no socket is listened at. transport=udp: two participants with that shortcut
// switched off, so that samples go the way that they go between processes, over the loopback.
//
// A reset keeps process and participants; topic, writers and readers are fresh for each word.
#pragma once

#include <cstdint>
#include <memory>

#include "dds/dds_connection.hpp"
#include "dds/policies.hpp"
#include "maide/wire/wrapper/system_wrapper.hpp"
#include "participants.hpp"
#include "protocol_timers.hpp"

namespace maide::fastdds {

class FastDdsWrapper : public SystemWrapper {
 public:
  FastDdsWrapper();
  const WrapperDescription& description() const override { return description_; }
  SystemSetup configure(const OptionValues& options) override;
  std::unique_ptr<SystemInstance> reset(EventSink& sink) override;

 private:
  WrapperDescription description_;
  dds::Policies policies_;
  dds::EndCounts counts_;
  ProtocolTimers timers_;
  std::uint64_t words_ = 0;
  std::unique_ptr<Participants> participants_;
};

}  // namespace maide::fastdds
