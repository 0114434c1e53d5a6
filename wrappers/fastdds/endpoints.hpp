// A writer and a reader of Fast DDS, matched, and the calls that an application makes on them.
#pragma once

#include <atomic>
#include <cstdint>
#include <fastdds/dds/core/condition/GuardCondition.hpp>
#include <fastdds/dds/core/condition/WaitSet.hpp>
#include <mutex>
#include <optional>
#include <string>

#include "dds/connection.hpp"
#include "dds/policies.hpp"
#include "participants.hpp"
#include "protocol_timers.hpp"

namespace eprosima::fastdds::dds {
class DataReader;
class DataWriter;
class Topic;
}  // namespace eprosima::fastdds::dds

namespace maide::fastdds {

class Endpoints : public dds::Endpoints {
 public:
  // `topic`: a name that no other of the participants has. Throws std::runtime_error.
  Endpoints(Participants& participants, const std::string& topic, const dds::Policies& policies,
            const ProtocolTimers& timers);
  ~Endpoints() override;

  bool write(std::uint32_t number) override;
  std::optional<std::uint32_t> take() override;
  void wait_for_data() override;
  void disconnect() override;
  void connect() override;
  void stop() override;

 private:
  void make_reader();
  void delete_reader();
  void delete_all();
  void wait_for_matches(std::int32_t count);

  Participants& participants_;
  const dds::Policies policies_;
  const ProtocolTimers timers_;
  eprosima::fastdds::dds::Topic* writer_topic_ = nullptr;
  eprosima::fastdds::dds::Topic* reader_topic_ = nullptr;  // the same, in one participant
  eprosima::fastdds::dds::DataWriter* writer_ = nullptr;
  std::mutex reader_mutex_;  // stop() is called while the reader's thread waits for data
  eprosima::fastdds::dds::DataReader* reader_ = nullptr;  // none: disconnected
  eprosima::fastdds::dds::GuardCondition stop_;
  eprosima::fastdds::dds::WaitSet waitset_;  // for stop_ and the reader's data
};

}  // namespace maide::fastdds
