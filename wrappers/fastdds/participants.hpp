// The participants that all words share, and the way between them: one participant that talks to
// itself within the process, or two that talk over UDP on the loopback interface. Neither meets a
// participant of another process, whatever the environment says.
#pragma once

#include <cstdint>
#include <memory>

namespace eprosima::fastdds::dds {
class DomainParticipant;
class Publisher;
class Subscriber;
}  // namespace eprosima::fastdds::dds

namespace maide::fastdds {

enum class Transport : std::uint8_t {
  none,  // Fast DDS's delivery within a process
  udp,   // the RTPS protocol
};

class Participants {
 public:
  // Throws std::runtime_error. One object at a time: it sets what holds for the whole process.
  explicit Participants(Transport transport);
  ~Participants();

  eprosima::fastdds::dds::DomainParticipant& of_writer() { return *writer_; }
  eprosima::fastdds::dds::DomainParticipant& of_reader() { return reader_ ? *reader_ : *writer_; }
  eprosima::fastdds::dds::Publisher& publisher() { return *publisher_; }
  eprosima::fastdds::dds::Subscriber& subscriber() { return *subscriber_; }

 private:
  struct Deleter {
    void operator()(eprosima::fastdds::dds::DomainParticipant* participant) const;
  };
  using Participant = std::unique_ptr<eprosima::fastdds::dds::DomainParticipant, Deleter>;

  Participant writer_, reader_;  // no reader_: the writer's is the reader's too
  eprosima::fastdds::dds::Publisher* publisher_ = nullptr;
  eprosima::fastdds::dds::Subscriber* subscriber_ = nullptr;
};

}  // namespace maide::fastdds
