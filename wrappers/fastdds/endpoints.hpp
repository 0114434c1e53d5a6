// Writers and readers of Fast DDS, matched, and the calls that an application makes on them.
#pragma once

#include <atomic>
#include <cstdint>
#include <fastdds/dds/core/condition/GuardCondition.hpp>
#include <fastdds/dds/core/condition/WaitSet.hpp>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "dds/dds_connection.hpp"
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
            const ProtocolTimers& timers, const dds::EndCounts& counts);
  ~Endpoints() override;

  bool write(std::size_t writer, std::uint32_t number) override;
  std::optional<std::uint32_t> take(std::size_t reader) override;
  void wait_for_data(std::size_t reader) override;
  void disconnect(std::size_t reader) override;
  void connect(std::size_t reader) override;
  void stop() override;

 private:
  struct Reader {
    std::mutex mutex;  // stop() is called while the reader's thread waits for data
    eprosima::fastdds::dds::DataReader* reader = nullptr;  // none: disconnected
    eprosima::fastdds::dds::GuardCondition stop;
    eprosima::fastdds::dds::WaitSet waitset;  // for `stop` and the reader's data
  };
  void make_reader(Reader& reader);
  void delete_reader(Reader& reader);
  void delete_all();
  bool know_each_other() const;
  void wait_for_matches();

  Participants& participants_;
  const dds::Policies policies_;
  const ProtocolTimers timers_;
  eprosima::fastdds::dds::Topic* writer_topic_ = nullptr;
  eprosima::fastdds::dds::Topic* reader_topic_ = nullptr;  // the same, in one participant
  std::vector<eprosima::fastdds::dds::DataWriter*> writers_;
  std::vector<Reader> readers_;
};

}  // namespace maide::fastdds
