#include "endpoints.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/Topic.hpp>
#include <stdexcept>
#include <thread>

#include "qos.hpp"
#include "sample_type.hpp"

namespace maide::fastdds {
namespace {

namespace fast = eprosima::fastdds::dds;
using Code = eprosima::fastrtps::types::ReturnCode_t;

void check(const Code& code, const char* call) {
  if (code != Code::RETCODE_OK) {
    throw std::runtime_error(fmt::format("{}: return code {}", call, code()));
  }
}

template <typename Entity>
Entity* made(Entity* entity, const char* call) {
  if (entity == nullptr) throw std::runtime_error(std::string(call) + " fails");
  return entity;
}

fast::Topic* make_topic(fast::DomainParticipant& participant, const std::string& name) {
  return made(participant.create_topic(name, "maide::dds::Sample", fast::TOPIC_QOS_DEFAULT),
              "create_topic");
}

}  // namespace

Endpoints::Endpoints(Participants& participants, const std::string& topic,
                     const dds::Policies& policies, const ProtocolTimers& timers,
                     const dds::EndCounts& counts)
    : participants_(participants), policies_(policies), timers_(timers), readers_(counts.readers) {
  try {
    writer_topic_ = make_topic(participants.of_writer(), topic);
    reader_topic_ = &participants.of_reader() == &participants.of_writer()
                        ? writer_topic_
                        : make_topic(participants.of_reader(), topic);
    for (std::size_t writer = 0; writer < counts.writers; ++writer) {
      writers_.push_back(made(participants.publisher().create_datawriter(
                                  writer_topic_, make_writer_qos(policies, timers)),
                              "create_datawriter"));
    }
    for (Reader& reader : readers_) {
      check(reader.waitset.attach_condition(reader.stop), "attach_condition");
      make_reader(reader);
    }
    wait_for_matches();
  } catch (...) {
    delete_all();
    throw;
  }
}

Endpoints::~Endpoints() { delete_all(); }

void Endpoints::delete_all() {
  for (Reader& reader : readers_) delete_reader(reader);
  for (fast::DataWriter* writer : writers_) participants_.publisher().delete_datawriter(writer);
  if (reader_topic_ != nullptr && reader_topic_ != writer_topic_) {
    participants_.of_reader().delete_topic(reader_topic_);
  }
  if (writer_topic_ != nullptr) participants_.of_writer().delete_topic(writer_topic_);
}

void Endpoints::make_reader(Reader& reader) {
  reader.reader = made(participants_.subscriber().create_datareader(
                           reader_topic_, make_reader_qos(policies_, timers_)),
                       "create_datareader");
  fast::StatusCondition& data = reader.reader->get_statuscondition();
  check(data.set_enabled_statuses(fast::StatusMask::data_available()), "set_enabled_statuses");
  check(reader.waitset.attach_condition(data), "attach_condition");
}

void Endpoints::delete_reader(Reader& reader) {
  if (reader.reader == nullptr) return;
  reader.waitset.detach_condition(reader.reader->get_statuscondition());
  participants_.subscriber().delete_datareader(reader.reader);
  reader.reader = nullptr;
}

void Endpoints::connect(std::size_t reader) {
  {
    const std::scoped_lock lock(readers_[reader].mutex);
    make_reader(readers_[reader]);
  }
  wait_for_matches();
}

void Endpoints::disconnect(std::size_t reader) {
  {
    const std::scoped_lock lock(readers_[reader].mutex);
    delete_reader(readers_[reader]);
  }
  wait_for_matches();
}

bool Endpoints::know_each_other() const {
  const bool match = policies_.match();
  const auto readers = std::count_if(readers_.begin(), readers_.end(),
                                     [](const Reader& reader) { return reader.reader != nullptr; });
  for (fast::DataWriter* writer : writers_) {
    fast::PublicationMatchedStatus status;
    check(writer->get_publication_matched_status(status), "get_publication_matched_status");
    if (status.current_count != (match ? readers : 0)) return false;
  }
  for (const Reader& reader : readers_) {
    if (reader.reader == nullptr) continue;
    fast::SubscriptionMatchedStatus status;
    check(reader.reader->get_subscription_matched_status(status),
          "get_subscription_matched_status");
    if (status.current_count != static_cast<std::int32_t>(match ? writers_.size() : 0)) {
      return false;
    }
  }
  return true;
}

// Within a participant all ends match while they are made; over UDP they tell each other.
void Endpoints::wait_for_matches() {
  const auto limit = std::chrono::steady_clock::now() + std::chrono::seconds(2);
  while (std::chrono::steady_clock::now() < limit) {
    if (know_each_other()) return;
    std::this_thread::sleep_for(std::chrono::microseconds(100));
  }
  throw std::runtime_error("writers and readers do not meet, or part, within two seconds");
}

bool Endpoints::write(std::size_t writer, std::uint32_t number) {
  Sample sample{number};
  const Code code = writers_[writer]->write(&sample, fast::HANDLE_NIL);
  if (code == Code::RETCODE_TIMEOUT) return false;
  check(code, "write");
  return true;
}

std::optional<std::uint32_t> Endpoints::take(std::size_t number) {
  Reader& reader = readers_[number];
  const std::scoped_lock lock(reader.mutex);
  if (reader.reader == nullptr) return std::nullopt;
  while (true) {
    Sample sample;
    fast::SampleInfo info;
    const Code code = reader.reader->take_next_sample(&sample, &info);
    if (code == Code::RETCODE_NO_DATA) return std::nullopt;
    check(code, "take_next_sample");
    // A sample without data tells that an instance came or went.
    if (info.valid_data) return sample.number;
  }
}

void Endpoints::wait_for_data(std::size_t number) {
  Reader& reader = readers_[number];
  const std::scoped_lock lock(reader.mutex);
  if (reader.reader == nullptr) return;
  fast::ConditionSeq active;
  check(reader.waitset.wait(active, eprosima::fastrtps::c_TimeInfinite), "wait");
}

// A writer that waits for room is let go when the readers that hold it up are no more.
void Endpoints::stop() {
  for (Reader& reader : readers_) reader.stop.set_trigger_value(true);
  for (Reader& reader : readers_) {
    const std::scoped_lock lock(reader.mutex);
    delete_reader(reader);
  }
}

}  // namespace maide::fastdds
