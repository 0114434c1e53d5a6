// Races of messages over Fast DDS. Settings beside those of all programs:
// - transport=udp: on the loopback device.
// - transport=shm: shared memory.
// - transport=lossy: udp, where lost=5 of 100 data messages and fragments are lost. It is the
//   library's own transport for tests. Heartbeats then come every 50 ms, and not every 3 s.
// - intraprocess=off: ends of one process do not take the shortcut either.
// - publish=async: a thread of the library sends.
// - shared=on: messages of a fixed size, which the reader finds in the writer's own memory.
// - between=200: so many idle readers are in the wait set between the map's and the notice's.
// - look=turn: the two readers are asked one after the other, as rmw_fastrtps asks its entities.
//   Otherwise the list counts that the wait set hands out.
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastdds/rtps/transport/shared_mem/SharedMemTransportDescriptor.h>
#include <fastdds/rtps/transport/test_UDPv4TransportDescriptor.h>
#include <fastrtps/attributes/LibrarySettingsAttributes.h>
#include <fastrtps/xmlparser/XMLProfileManager.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <fastdds/dds/core/condition/WaitSet.hpp>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/domain/qos/DomainParticipantQos.hpp>
#include <fastdds/dds/log/Log.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/publisher/qos/DataWriterQos.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/subscriber/qos/DataReaderQos.hpp>
#include <fastdds/dds/topic/Topic.hpp>
#include <fastdds/dds/topic/TypeSupport.hpp>
#include <memory>
#include <random>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "delivery_race.hpp"
#include "loopback.hpp"

namespace maide::deliveries {
namespace {

namespace fast = eprosima::fastdds::dds;
namespace rtps = eprosima::fastrtps::rtps;
namespace transports = eprosima::fastdds::rtps;
using eprosima::fastrtps::types::ReturnCode_t;

void check(const ReturnCode_t& code, const char* call) {
  if (code != ReturnCode_t::RETCODE_OK) {
    throw std::runtime_error(std::string(call) + ": return code " + std::to_string(code()));
  }
}

template <typename Entity>
Entity* made(Entity* entity, const char* call) {
  if (entity == nullptr) throw std::runtime_error(std::string(call) + " fails");
  return entity;
}

// The round that a message belongs to, and as many bytes behind it as make it large. Plain memory
// of a size that is known beforehand may be shared; it need not have the encoding that DDS
// prescribes, for only this program reads it.
struct Message {
  std::uint32_t number = 0;
  std::vector<unsigned char> bytes;
};

class MessageType : public fast::TopicDataType {
 public:
  MessageType(std::size_t size, bool is_shared)
      : size_(static_cast<std::uint32_t>(head + size)), is_shared_(is_shared) {
    setName(("maide::deliveries::Message" + std::to_string(size)).c_str());
    m_typeSize = size_;
    m_isGetKeyDefined = false;
    auto_fill_type_object(false);
    auto_fill_type_information(false);
  }

  bool serialize(void* data, rtps::SerializedPayload_t* payload) override {
    const auto& message = *static_cast<const Message*>(data);
    const auto length = static_cast<std::uint32_t>(head + message.bytes.size());
    if (payload->max_size < length) return false;
    std::memcpy(payload->data, encapsulation, sizeof(encapsulation));
    std::memcpy(payload->data + sizeof(encapsulation), &message.number, sizeof(message.number));
    std::copy(message.bytes.begin(), message.bytes.end(), payload->data + head);
    payload->encapsulation = CDR_LE;
    payload->length = length;
    return true;
  }
  bool deserialize(rtps::SerializedPayload_t* payload, void* data) override {
    if (payload->length < head) return false;
    auto& message = *static_cast<Message*>(data);
    std::memcpy(&message.number, payload->data + sizeof(encapsulation), sizeof(message.number));
    message.bytes.assign(payload->data + head, payload->data + payload->length);
    return true;
  }
  std::function<std::uint32_t()> getSerializedSizeProvider(void* data) override {
    const auto length =
        static_cast<std::uint32_t>(head + static_cast<const Message*>(data)->bytes.size());
    return [length] { return length; };
  }
  void* createData() override { return new Message; }
  void deleteData(void* data) override { delete static_cast<Message*>(data); }
  bool getKey(void*, rtps::InstanceHandle_t*, bool) override { return false; }
  bool is_bounded() const override { return is_shared_; }
  bool is_plain() const override { return is_shared_; }

 private:
  static constexpr unsigned char encapsulation[] = {0, CDR_LE, 0, 0};
  static constexpr std::size_t head = sizeof(encapsulation) + sizeof(std::uint32_t);

  const std::uint32_t size_;
  const bool is_shared_;
};

// Ports of the writer's and the reader's participant that both processes know.
constexpr const char* writer_port = "writer-port";
constexpr const char* reader_port = "reader-port";

void choose_ports(Settings& settings) {
  settings.add(writer_port, std::to_string(fastdds::free_udp_port()));
  settings.add(reader_port, std::to_string(fastdds::free_udp_port()));
}

std::shared_ptr<transports::TransportDescriptorInterface> make_transport(const Settings& settings) {
  if (settings.is("transport", "shm", "udp")) {
    auto shared = std::make_shared<transports::SharedMemTransportDescriptor>();
    shared->segment_size(16 << 20);
    return shared;
  }
  if (settings.is("transport", "lossy", "udp")) {
    auto lossy = std::make_shared<transports::test_UDPv4TransportDescriptor>();
    lossy->interfaceWhiteList = {fastdds::loopback};
    // Its percentages drop each n-th message, which would always be the notice.
    const auto loses = [random = std::mt19937(settings.number("id", 0)),
                        lost = settings.number("lost", 5)](rtps::CDRMessage_t&) mutable {
      return random() % 100 < lost;
    };
    lossy->drop_data_messages_filter_ = lossy->drop_data_frag_messages_filter_ = loses;
    return lossy;
  }
  auto udp = std::make_shared<transports::UDPv4TransportDescriptor>();
  udp->interfaceWhiteList = {fastdds::loopback};
  return udp;
}

fast::DomainParticipantQos make_qos(const Settings& settings, const char* own, const char* peer) {
  fast::DomainParticipantQos qos;
  qos.transport().use_builtin_transports = false;
  qos.transport().user_transports = {make_transport(settings)};
  auto& wire = qos.wire_protocol();
  wire.builtin.discovery_config.leaseDuration_announcementperiod = {1, 0};
  // Shared memory has ports of its own, and finds its peers by the domain.
  if (!settings.is("transport", "shm", "udp")) {
    const auto at = [](std::uint32_t port) {
      return fastdds::loopback_locator(static_cast<std::uint16_t>(port));
    };
    wire.builtin.metatrafficUnicastLocatorList.push_back(at(settings.number(own, 0)));
    wire.builtin.initialPeersList.push_back(at(settings.number(peer, 0)));
    wire.default_unicast_locator_list.push_back(at(fastdds::free_udp_port()));
  }
  return qos;
}

// A participant with the two topics, and what the ends on it are made of.
class Participant {
 public:
  Participant(const Settings& settings, const char* own, const char* peer)
      : settings_(settings),
        participant_(made(fast::DomainParticipantFactory::get_instance()->create_participant(
                              1 + settings.number("id", 0) % 200, make_qos(settings, own, peer)),
                          "create_participant")) {
    const bool is_shared = settings.is("shared", "on", "off");
    for (const std::size_t size : {std::size_t{settings.number("size", 100)}, small}) {
      check(fast::TypeSupport(new MessageType(size, is_shared)).register_type(participant_),
            "register_type");
    }
    publisher_ =
        made(participant_->create_publisher(fast::PUBLISHER_QOS_DEFAULT), "create_publisher");
    subscriber_ =
        made(participant_->create_subscriber(fast::SUBSCRIBER_QOS_DEFAULT), "create_subscriber");
  }
  ~Participant() {
    participant_->delete_contained_entities();
    fast::DomainParticipantFactory::get_instance()->delete_participant(participant_);
  }
  Participant(const Participant&) = delete;
  Participant& operator=(const Participant&) = delete;

  fast::DataWriter& make_writer(Topic topic) {
    auto qos = make_end_qos<fast::DataWriterQos>();
    qos.reliability().max_blocking_time = {10, 0};
    // As ROS 2 has it.
    qos.durability().kind = fast::VOLATILE_DURABILITY_QOS;
    qos.publish_mode().kind = settings_.is("publish", "async", "sync")
                                  ? fast::ASYNCHRONOUS_PUBLISH_MODE
                                  : fast::SYNCHRONOUS_PUBLISH_MODE;
    // How late what was lost is sent again; the default is 3 s.
    if (settings_.is("transport", "lossy", "udp")) {
      qos.reliable_writer_qos().times.heartbeatPeriod = {0, 50'000'000};
    }
    return *made(publisher_->create_datawriter(this->topic(name(topic), size_of(topic)), qos),
                 "create_datawriter");
  }
  fast::DataReader& make_reader(Topic topic) { return make_reader(name(topic), size_of(topic)); }
  fast::DataReader& make_idle_reader(std::uint32_t number) {
    return make_reader("idle" + std::to_string(number), small);
  }

 private:
  static constexpr std::size_t small = 4;

  std::string name(Topic topic) const {
    return (topic == Topic::map ? "map" : "notice") + settings_.text("id", "");
  }
  std::size_t size_of(Topic topic) const {
    return topic == Topic::map ? settings_.number("size", 100) : small;
  }
  template <typename EndQos>
  EndQos make_end_qos() const {
    EndQos qos;
    qos.history().kind = fast::KEEP_LAST_HISTORY_QOS;
    qos.history().depth = 10;
    qos.reliability().kind = settings_.is_reliable() ? fast::RELIABLE_RELIABILITY_QOS
                                                     : fast::BEST_EFFORT_RELIABILITY_QOS;
    qos.resource_limits().max_samples = 20;
    qos.resource_limits().max_instances = 1;
    qos.resource_limits().max_samples_per_instance = 20;
    qos.resource_limits().allocated_samples = 0;
    if (settings_.is("shared", "on", "off")) {
      qos.data_sharing().automatic();
    } else {
      qos.data_sharing().off();
    }
    return qos;
  }
  fast::Topic* topic(const std::string& name, std::size_t size) {
    if (auto* const known =
            static_cast<fast::Topic*>(participant_->lookup_topicdescription(name))) {
      return known;
    }
    return made(
        participant_->create_topic(name, "maide::deliveries::Message" + std::to_string(size),
                                   fast::TOPIC_QOS_DEFAULT),
        "create_topic");
  }
  fast::DataReader& make_reader(const std::string& name, std::size_t size) {
    return *made(
        subscriber_->create_datareader(topic(name, size), make_end_qos<fast::DataReaderQos>()),
        "create_datareader");
  }

  const Settings settings_;
  fast::DomainParticipant* participant_;
  fast::Publisher* publisher_ = nullptr;
  fast::Subscriber* subscriber_ = nullptr;
};

class FastWriter : public Writer {
 public:
  explicit FastWriter(std::shared_ptr<Participant> participant)
      : participant_(std::move(participant)) {
    for (const Topic topic : both_topics) {
      writers_.push_back(&participant_->make_writer(topic));
    }
  }
  void write(Topic topic, std::uint32_t number, std::size_t size) override {
    message_.number = number;
    message_.bytes.resize(size);
    check(writers_[static_cast<std::size_t>(topic)]->write(&message_, fast::HANDLE_NIL), "write");
  }

 private:
  std::shared_ptr<Participant> participant_;
  std::vector<fast::DataWriter*> writers_;
  Message message_;
};

class FastReader : public Reader {
 public:
  FastReader(std::shared_ptr<Participant> participant, const Settings& settings)
      : participant_(std::move(participant)),
        looks_in_turn_(settings.is("look", "turn", "waitset")) {
    add(participant_->make_reader(Topic::map));
    for (std::uint32_t i = 0; i < settings.number("between", 0); ++i) {
      add(participant_->make_idle_reader(i));
    }
    add(participant_->make_reader(Topic::notice));
  }
  ~FastReader() override {
    for (fast::DataReader* const reader : readers_) {
      waitset_.detach_condition(reader->get_statuscondition());
    }
  }
  FastReader(const FastReader&) = delete;
  FastReader& operator=(const FastReader&) = delete;

  std::optional<std::uint32_t> take(Topic topic) override {
    fast::DataReader& reader = reader_of(topic);
    std::optional<std::uint32_t> newest;
    while (true) {
      fast::SampleInfo info;
      const ReturnCode_t code = reader.take_next_sample(&message_, &info);
      if (code == ReturnCode_t::RETCODE_NO_DATA) return newest;
      check(code, "take_next_sample");
      if (info.valid_data) newest = message_.number;
    }
  }

  Found look(std::chrono::milliseconds limit) override {
    fast::ConditionSeq list;
    const auto nanoseconds = std::chrono::nanoseconds(limit).count();
    const ReturnCode_t code = waitset_.wait(list, {0, static_cast<std::uint32_t>(nanoseconds)});
    if (code != ReturnCode_t::RETCODE_TIMEOUT) check(code, "wait");
    if (!looks_in_turn_) return {is_in(list, Topic::map), is_in(list, Topic::notice)};
    return look_in_turn([this](Topic topic) {
      fast::SampleInfo info;
      return reader_of(topic).get_first_untaken_info(&info) == ReturnCode_t::RETCODE_OK;
    });
  }

 private:
  fast::DataReader& reader_of(Topic topic) {
    return topic == Topic::map ? *readers_.front() : *readers_.back();
  }
  bool is_in(const fast::ConditionSeq& list, Topic topic) {
    return std::find(list.begin(), list.end(), &reader_of(topic).get_statuscondition()) !=
           list.end();
  }
  void add(fast::DataReader& reader) {
    fast::StatusCondition& data = reader.get_statuscondition();
    check(data.set_enabled_statuses(fast::StatusMask::data_available()), "set_enabled_statuses");
    check(waitset_.attach_condition(data), "attach_condition");
    readers_.push_back(&reader);
  }

  std::shared_ptr<Participant> participant_;
  fast::WaitSet waitset_;
  std::vector<fast::DataReader*> readers_;  // the map's, idle ones, the notice's
  const bool looks_in_turn_;
  Message message_;
};

class FastDds : public Middleware {
 public:
  explicit FastDds(const Settings& settings) : settings_(settings) {
    ::setenv("SKIP_DEFAULT_XML", "1", 1);
    for (const char* const name :
         {"FASTRTPS_DEFAULT_PROFILES_FILE", "FASTDDS_DEFAULT_PROFILES_FILE",
          "FASTDDS_ENVIRONMENT_FILE", "ROS_DISCOVERY_SERVER"}) {
      ::unsetenv(name);
    }
    fast::Log::ClearConsumers();
    eprosima::fastrtps::LibrarySettingsAttributes library;
    library.intraprocess_delivery = settings.is("intraprocess", "off", "full")
                                        ? eprosima::fastrtps::INTRAPROCESS_OFF
                                        : eprosima::fastrtps::INTRAPROCESS_FULL;
    eprosima::fastrtps::xmlparser::XMLProfileManager::library_settings(library);
  }

  std::unique_ptr<Writer> make_writer() override {
    if (!participant_) participant_ = make_participant(writer_port, reader_port);
    return std::make_unique<FastWriter>(participant_);
  }
  std::unique_ptr<Reader> make_reader() override {
    const std::shared_ptr<Participant> own = make_participant(reader_port, writer_port);
    if (settings_.is("ends", "threads", "threads")) participant_ = own;
    return std::make_unique<FastReader>(own, settings_);
  }

 private:
  std::shared_ptr<Participant> make_participant(const char* own, const char* peer) const {
    return std::make_shared<Participant>(settings_, own, peer);
  }

  const Settings settings_;
  std::shared_ptr<Participant> participant_;  // the writer's
};

}  // namespace
}  // namespace maide::deliveries

int main(int count, char** words) {
  using namespace maide::deliveries;
  return run(count, words, {choose_ports, [](const Settings& settings) {
                              return std::make_unique<FastDds>(settings);
                            }});
}
