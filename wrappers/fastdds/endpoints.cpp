#include "endpoints.hpp"

#include <fmt/core.h>

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
                     const dds::Policies& policies, const ProtocolTimers& timers)
    : participants_(participants), policies_(policies), timers_(timers) {
  try {
    writer_topic_ = make_topic(participants.of_writer(), topic);
    reader_topic_ = &participants.of_reader() == &participants.of_writer()
                        ? writer_topic_
                        : make_topic(participants.of_reader(), topic);
    check(waitset_.attach_condition(stop_), "attach_condition");
    writer_ = made(participants.publisher().create_datawriter(writer_topic_,
                                                              make_writer_qos(policies, timers)),
                   "create_datawriter");
    make_reader();
    wait_for_matches(1);
  } catch (...) {
    delete_all();
    throw;
  }
}

Endpoints::~Endpoints() { delete_all(); }

void Endpoints::delete_all() {
  delete_reader();
  if (writer_ != nullptr) participants_.publisher().delete_datawriter(writer_);
  if (reader_topic_ != nullptr && reader_topic_ != writer_topic_) {
    participants_.of_reader().delete_topic(reader_topic_);
  }
  if (writer_topic_ != nullptr) participants_.of_writer().delete_topic(writer_topic_);
}

void Endpoints::make_reader() {
  reader_ = made(participants_.subscriber().create_datareader(reader_topic_,
                                                              make_reader_qos(policies_, timers_)),
                 "create_datareader");
  fast::StatusCondition& data = reader_->get_statuscondition();
  check(data.set_enabled_statuses(fast::StatusMask::data_available()), "set_enabled_statuses");
  check(waitset_.attach_condition(data), "attach_condition");
}

void Endpoints::delete_reader() {
  if (reader_ == nullptr) return;
  waitset_.detach_condition(reader_->get_statuscondition());
  participants_.subscriber().delete_datareader(reader_);
  reader_ = nullptr;
}

void Endpoints::connect() {
  {
    const std::scoped_lock lock(reader_mutex_);
    make_reader();
  }
  wait_for_matches(1);
}

void Endpoints::disconnect() {
  {
    const std::scoped_lock lock(reader_mutex_);
    delete_reader();
  }
  wait_for_matches(0);
}

// Within a participant both ends match while they are made; over UDP they tell each other.
void Endpoints::wait_for_matches(std::int32_t count) {
  const auto limit = std::chrono::steady_clock::now() + std::chrono::seconds(2);
  while (std::chrono::steady_clock::now() < limit) {
    fast::PublicationMatchedStatus writer;
    fast::SubscriptionMatchedStatus reader;
    reader.current_count = count;
    check(writer_->get_publication_matched_status(writer), "get_publication_matched_status");
    if (reader_ != nullptr) {
      check(reader_->get_subscription_matched_status(reader), "get_subscription_matched_status");
    }
    if (writer.current_count == count && reader.current_count == count) return;
    std::this_thread::sleep_for(std::chrono::microseconds(100));
  }
  throw std::runtime_error("writer and reader do not meet, or part, within two seconds");
}

bool Endpoints::write(std::uint32_t number) {
  Sample sample{number};
  const Code code = writer_->write(&sample, fast::HANDLE_NIL);
  if (code == Code::RETCODE_TIMEOUT) return false;
  check(code, "write");
  return true;
}

std::optional<std::uint32_t> Endpoints::take() {
  const std::scoped_lock lock(reader_mutex_);
  if (reader_ == nullptr) return std::nullopt;
  while (true) {
    Sample sample;
    fast::SampleInfo info;
    const Code code = reader_->take_next_sample(&sample, &info);
    if (code == Code::RETCODE_NO_DATA) return std::nullopt;
    check(code, "take_next_sample");
    // A sample without data tells that an instance came or went.
    if (info.valid_data) return sample.number;
  }
}

void Endpoints::wait_for_data() {
  const std::scoped_lock lock(reader_mutex_);
  if (reader_ == nullptr) return;
  fast::ConditionSeq active;
  check(waitset_.wait(active, eprosima::fastrtps::c_TimeInfinite), "wait");
}

// A writer that waits for room is let go when the reader that holds it up is no more.
void Endpoints::stop() {
  stop_.set_trigger_value(true);
  const std::scoped_lock lock(reader_mutex_);
  delete_reader();
}

}  // namespace maide::fastdds
