#include "endpoints.hpp"

#include <stdexcept>
#include <vector>

#include "qos.hpp"

extern "C" {
#include "sample.h"
}

namespace maide::cyclonedds {
namespace {

// Within a process both ends match while they are made; over the network the participants must
// find each other first.
constexpr int matching_limit_ms = 10'000;

Entity make_topic(dds_entity_t participant, const std::string& name) {
  return {dds_create_topic(participant, &maide_dds_Sample_desc, name.c_str(), nullptr, nullptr),
          "dds_create_topic"};
}

}  // namespace

Endpoints::Endpoints(const Domains& domains, const std::string& topic,
                     const dds::Policies& policies)
    : participant_(domains.of_reader()),
      over_network_(domains.of_reader() != domains.of_writer()),
      reader_qos_(make_reader_qos(policies)),
      room_(policies.max_samples),
      writer_topic_(make_topic(domains.of_writer(), topic)),
      writer_(dds_create_writer(domains.of_writer(), writer_topic_.get(),
                                make_writer_qos(policies).get(), nullptr),
              "dds_create_writer"),
      topic_(make_topic(participant_, topic)),
      stop_(dds_create_guardcondition(participant_), "dds_create_guardcondition"),
      waitset_(dds_create_waitset(participant_), "dds_create_waitset") {
  checked(dds_waitset_attach(waitset_.get(), stop_.get(), 0), "dds_waitset_attach");
  connect();
}

void Endpoints::connect() {
  reader_ = {dds_create_reader(participant_, topic_.get(), reader_qos_.get(), nullptr),
             "dds_create_reader"};
  data_ = {dds_create_readcondition(reader_.get(), DDS_ANY_STATE), "dds_create_readcondition"};
  checked(dds_waitset_attach(waitset_.get(), data_.get(), 0), "dds_waitset_attach");
  wait_for_matches(1);
  if (over_network_) wait_for_probe();
  kept_ = count_kept();
}

void Endpoints::disconnect() {
  checked(dds_waitset_detach(waitset_.get(), data_.get()), "dds_waitset_detach");
  data_ = {};
  reader_ = {};
  wait_for_matches(0);
}

// A writer that had no reader yet would drop what it writes.
void Endpoints::wait_for_matches(std::uint32_t count) const {
  for (int attempts = 0; attempts < matching_limit_ms; ++attempts) {
    dds_publication_matched_status_t writer{};
    dds_subscription_matched_status_t reader{};
    reader.current_count = count;
    checked(dds_get_publication_matched_status(writer_.get(), &writer),
            "dds_get_publication_matched_status");
    if (reader_.get() > 0) {
      checked(dds_get_subscription_matched_status(reader_.get(), &reader),
              "dds_get_subscription_matched_status");
    }
    if (writer.current_count == count && reader.current_count == count) return;
    dds_sleepfor(DDS_MSECS(1));
  }
  throw std::runtime_error("writer and reader do not meet, or part, within 10 s");
}

// Over the network matched ends are not in step yet: a reliable reader takes nothing from a writer
// before it has heard the writer's first heartbeat, which it asks for after a while (RTPS 2.2,
// section 8.4.9). When this connection's own probe has arrived, all that was sent before it has.
void Endpoints::wait_for_probe() {
  const maide_dds_Sample probe{.instance = 1, .number = ++probes_};
  for (int waited = 0; waited < matching_limit_ms; ++waited) {
    // A second one is for a best-effort reader on a network that loses.
    if (waited % 2000 == 0) checked(dds_write(writer_.get(), &probe), "dds_write");
    // The handle is known as soon as the probe is written, to the reader only when it has arrived.
    const dds_instance_handle_t instance = dds_lookup_instance(reader_.get(), &probe);
    maide_dds_Sample sample{};
    void* samples[] = {&sample};
    dds_sample_info_t info[1];
    const dds_return_t taken = dds_take_instance(reader_.get(), samples, info, 1, 1, instance);
    if (taken != DDS_RETCODE_PRECONDITION_NOT_MET) checked(taken, "dds_take_instance");
    // A late reader may be given an earlier one first.
    if (taken > 0 && info[0].valid_data && sample.number == probe.number) return;
    dds_sleepfor(DDS_MSECS(1));
  }
  throw std::runtime_error("nothing comes from the writer to the reader within 10 s");
}

// What a late reader was given, up to its limit.
std::int32_t Endpoints::count_kept() const {
  std::vector<maide_dds_Sample> samples(static_cast<std::size_t>(room_));
  std::vector<dds_sample_info_t> infos(samples.size());
  std::vector<void*> places;
  for (maide_dds_Sample& sample : samples) places.push_back(&sample);
  if (places.empty()) return 0;
  return checked(dds_read(reader_.get(), places.data(), infos.data(), places.size(),
                          static_cast<std::uint32_t>(places.size())),
                 "dds_read");
}

bool Endpoints::write(std::uint32_t number) {
  const maide_dds_Sample sample{.instance = 0, .number = number};
  writing_ = true;
  const dds_return_t result = dds_write(writer_.get(), &sample);
  if (result == DDS_RETCODE_OK) ++kept_;
  writing_ = false;
  if (result == DDS_RETCODE_TIMEOUT) return false;
  checked(result, "dds_write");
  return true;
}

std::optional<std::uint32_t> Endpoints::take() {
  if (reader_.get() <= 0) return std::nullopt;
  maide_dds_Sample sample{};
  void* samples[] = {&sample};
  dds_sample_info_t info[1];
  while (checked(dds_take(reader_.get(), samples, info, 1, 1), "dds_take") > 0) {
    // A sample without data tells that an instance came or went.
    if (!info[0].valid_data || sample.instance != 0) continue;
    --kept_;
    return sample.number;
  }
  return std::nullopt;
}

void Endpoints::wait_for_data() {
  checked(dds_waitset_wait(waitset_.get(), nullptr, 0, DDS_INFINITY), "dds_waitset_wait");
}

void Endpoints::stop() {
  dds_set_guardcondition(stop_.get(), true);
  while (take()) {  // room for a blocked write
  }
}

// A blocked dds_write sleeps 10 ms at a time (0.10.2, measured) until there is room.
bool Endpoints::polls_in_vain() const { return room_ > 0 && writing_ && kept_ >= room_; }

}  // namespace maide::cyclonedds
