#include "endpoints.hpp"

#include <stdexcept>

#include "qos.hpp"

extern "C" {
#include "sample.h"
}

namespace maide::cyclonedds {

Endpoints::Endpoints(dds_entity_t participant, const std::string& topic,
                     const dds::Policies& policies)
    : room_(policies.max_samples),
      topic_(dds_create_topic(participant, &maide_dds_Sample_desc, topic.c_str(), nullptr, nullptr),
             "dds_create_topic"),
      reader_(
          dds_create_reader(participant, topic_.get(), make_reader_qos(policies).get(), nullptr),
          "dds_create_reader"),
      writer_(
          dds_create_writer(participant, topic_.get(), make_writer_qos(policies).get(), nullptr),
          "dds_create_writer"),
      stop_(dds_create_guardcondition(participant), "dds_create_guardcondition"),
      data_(dds_create_readcondition(reader_.get(), DDS_ANY_STATE), "dds_create_readcondition"),
      waitset_(dds_create_waitset(participant), "dds_create_waitset") {
  checked(dds_waitset_attach(waitset_.get(), stop_.get(), 0), "dds_waitset_attach");
  checked(dds_waitset_attach(waitset_.get(), data_.get(), 0), "dds_waitset_attach");
  wait_until_matched();
}

// Within a process both ends match while they are made; but a writer that had no reader yet would
// drop what it writes, so that is made sure of.
void Endpoints::wait_until_matched() const {
  for (int attempts = 0; attempts < 1000; ++attempts) {
    dds_publication_matched_status_t writer{};
    dds_subscription_matched_status_t reader{};
    checked(dds_get_publication_matched_status(writer_.get(), &writer),
            "dds_get_publication_matched_status");
    checked(dds_get_subscription_matched_status(reader_.get(), &reader),
            "dds_get_subscription_matched_status");
    if (writer.current_count == 1 && reader.current_count == 1) return;
    dds_sleepfor(DDS_MSECS(1));
  }
  throw std::runtime_error("writer and reader do not match within a second");
}

bool Endpoints::write(std::uint32_t number) {
  const maide_dds_Sample sample{.number = number};
  writing_ = true;
  const dds_return_t result = dds_write(writer_.get(), &sample);
  if (result == DDS_RETCODE_OK) ++kept_;
  writing_ = false;
  if (result == DDS_RETCODE_TIMEOUT) return false;
  checked(result, "dds_write");
  return true;
}

std::optional<std::uint32_t> Endpoints::take() {
  maide_dds_Sample sample{};
  void* samples[] = {&sample};
  dds_sample_info_t info[1];
  while (checked(dds_take(reader_.get(), samples, info, 1, 1), "dds_take") > 0) {
    // A sample without data tells that an instance came or went.
    if (!info[0].valid_data) continue;
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
