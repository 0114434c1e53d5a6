#include "connection.hpp"

#include <stdexcept>

extern "C" {
#include "sample.h"
}

namespace maide::cyclonedds {
namespace {

Endpoints make_endpoints(dds_entity_t participant, const std::string& topic,
                         const Policies& policies) {
  Endpoints ends;
  ends.topic = {
      dds_create_topic(participant, &maide_dds_Sample_desc, topic.c_str(), nullptr, nullptr),
      "dds_create_topic"};
  ends.reader = {
      dds_create_reader(participant, ends.topic.get(), policies.reader_qos().get(), nullptr),
      "dds_create_reader"};
  ends.writer = {
      dds_create_writer(participant, ends.topic.get(), policies.writer_qos().get(), nullptr),
      "dds_create_writer"};
  ends.stop = {dds_create_guardcondition(participant), "dds_create_guardcondition"};
  ends.data = {dds_create_readcondition(ends.reader.get(), DDS_ANY_STATE),
               "dds_create_readcondition"};
  ends.waitset = {dds_create_waitset(participant), "dds_create_waitset"};
  checked(dds_waitset_attach(ends.waitset.get(), ends.stop.get(), 0), "dds_waitset_attach");
  checked(dds_waitset_attach(ends.waitset.get(), ends.data.get(), 0), "dds_waitset_attach");
  return ends;
}

}  // namespace

Connection::Connection(dds_entity_t participant, const std::string& topic, const Policies& policies,
                       EventSink& sink, std::vector<Endpoints>& retired)
    : room_(policies.max_samples),
      sink_(sink),
      retired_(retired),
      ends_(make_endpoints(participant, topic, policies)) {
  wait_until_matched();
}

// Within a process both ends match while they are made; but a writer that had no reader yet would
// drop what it writes, so that is made sure of.
void Connection::wait_until_matched() const {
  for (int attempts = 0; attempts < 1000; ++attempts) {
    dds_publication_matched_status_t writer{};
    dds_subscription_matched_status_t reader{};
    checked(dds_get_publication_matched_status(ends_.writer.get(), &writer),
            "dds_get_publication_matched_status");
    checked(dds_get_subscription_matched_status(ends_.reader.get(), &reader),
            "dds_get_subscription_matched_status");
    if (writer.current_count == 1 && reader.current_count == 1) return;
    dds_sleepfor(DDS_MSECS(1));
  }
  throw std::runtime_error("writer and reader do not match within a second");
}

void Connection::call(std::string_view input) {
  if (stopped_) return;
  if (input == "write") {
    write();
  } else if (input == "read") {
    read();
  } else if (input == "tryread") {
    if (!take_one()) sink_.report("null");
  } else {
    throw std::logic_error("no input '" + std::string(input) + "'");
  }
}

void Connection::write() {
  const maide_dds_Sample sample{.number = written_ + 1};
  writing_ = true;
  const dds_return_t result = dds_write(ends_.writer.get(), &sample);
  if (result == DDS_RETCODE_OK) ++kept_;
  writing_ = false;
  if (result == DDS_RETCODE_TIMEOUT) {
    sink_.report("failed");
    return;
  }
  checked(result, "dds_write");
  ++written_;
  sink_.report("written");
}

void Connection::read() {
  do {
    checked(dds_waitset_wait(ends_.waitset.get(), nullptr, 0, DDS_INFINITY), "dds_waitset_wait");
  } while (!stopped_ && !take_one());
}

// Takes the oldest sample there is, without waiting; false if there is none.
bool Connection::take_one() {
  maide_dds_Sample sample{};
  void* samples[] = {&sample};
  dds_sample_info_t info[1];
  while (checked(dds_take(ends_.reader.get(), samples, info, 1, 1), "dds_take") > 0) {
    // A sample without data tells that an instance came or went.
    if (!info[0].valid_data) continue;
    --kept_;
    sink_.message(sample.number);
    return true;
  }
  return false;
}

// A blocked dds_write sleeps 10 ms at a time (0.10.2, measured) until there is room.
bool Connection::polls_in_vain() const { return writing_ && kept_ >= room_; }

void Connection::shutdown() {
  stopped_ = true;
  dds_set_guardcondition(ends_.stop.get(), true);
  while (take_one()) {  // room for a blocked write
  }
}

}  // namespace maide::cyclonedds
