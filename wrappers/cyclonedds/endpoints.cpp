#include "endpoints.hpp"

#include <algorithm>
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
// A blocked dds_write sleeps 10 ms at a time until there is room (0.10.2, measured).
constexpr std::chrono::milliseconds longest_look{20};

Entity make_topic(dds_entity_t participant, const std::string& name) {
  return {dds_create_topic(participant, &maide_dds_Sample_desc, name.c_str(), nullptr, nullptr),
          "dds_create_topic"};
}

}  // namespace

Endpoints::Endpoints(const Domains& domains, const std::string& topic,
                     const dds::Policies& policies, const dds::EndCounts& counts)
    : participant_(domains.of_reader()),
      over_network_(domains.of_reader() != domains.of_writer()),
      reader_qos_(make_reader_qos(policies)),
      room_(policies.max_samples),
      match_(policies.match()),
      writer_topic_(make_topic(domains.of_writer(), topic)),
      topic_(make_topic(participant_, topic)),
      readers_(counts.readers) {
  for (std::size_t writer = 0; writer < counts.writers; ++writer) {
    writers_.emplace_back(dds_create_writer(domains.of_writer(), writer_topic_.get(),
                                            make_writer_qos(policies).get(), nullptr),
                          "dds_create_writer");
  }
  for (Reader& reader : readers_) {
    reader.stop = {dds_create_guardcondition(participant_), "dds_create_guardcondition"};
    reader.waitset = {dds_create_waitset(participant_), "dds_create_waitset"};
    checked(dds_waitset_attach(reader.waitset.get(), reader.stop.get(), 0), "dds_waitset_attach");
  }
  for (std::size_t reader = 0; reader < counts.readers; ++reader) connect(reader);
}

void Endpoints::connect(std::size_t number) {
  Reader& reader = readers_[number];
  reader.reader = {dds_create_reader(participant_, topic_.get(), reader_qos_.get(), nullptr),
                   "dds_create_reader"};
  reader.data = {dds_create_readcondition(reader.reader.get(), DDS_ANY_STATE),
                 "dds_create_readcondition"};
  checked(dds_waitset_attach(reader.waitset.get(), reader.data.get(), 0), "dds_waitset_attach");
  reader.is_connected = true;
  wait_for_matches();
  if (over_network_ && match_) wait_for_probes(reader);
  reader.kept = count_kept(reader);
}

void Endpoints::disconnect(std::size_t number) {
  Reader& reader = readers_[number];
  checked(dds_waitset_detach(reader.waitset.get(), reader.data.get()), "dds_waitset_detach");
  reader.data = {};
  reader.reader = {};
  reader.is_connected = false;
  reader.kept = 0;
  wait_for_matches();
}

// A writer that had no reader yet would drop what it writes.
void Endpoints::wait_for_matches() const {
  const auto readers = match_
                           ? static_cast<std::uint32_t>(std::count_if(
                                 readers_.begin(), readers_.end(),
                                 [](const Reader& reader) { return reader.is_connected.load(); }))
                           : 0;
  const std::size_t writers = match_ ? writers_.size() : 0;
  const auto know_each_other = [&] {
    for (const Entity& writer : writers_) {
      dds_publication_matched_status_t status{};
      checked(dds_get_publication_matched_status(writer.get(), &status),
              "dds_get_publication_matched_status");
      if (status.current_count != readers) return false;
    }
    for (const Reader& reader : readers_) {
      if (!reader.is_connected) continue;
      dds_subscription_matched_status_t status{};
      checked(dds_get_subscription_matched_status(reader.reader.get(), &status),
              "dds_get_subscription_matched_status");
      if (status.current_count != writers) return false;
    }
    return true;
  };
  for (int attempts = 0; attempts < matching_limit_ms; ++attempts) {
    if (know_each_other()) return;
    dds_sleepfor(DDS_MSECS(1));
  }
  throw std::runtime_error("writers and readers do not meet, or part, within 10 s");
}

// Over the network matched ends are not in step yet: a reliable reader takes nothing from a writer
// before it has heard the writer's first heartbeat, which it asks for after a while (RTPS 2.2,
// section 8.4.9). When this connection's own probe has arrived, all that was sent before it has.
// Each writer has an instance of its own for its probes.
void Endpoints::wait_for_probes(const Reader& reader) {
  ++probes_;
  for (std::size_t writer = 0; writer < writers_.size(); ++writer) {
    const maide_dds_Sample probe{.instance = 1 + static_cast<std::uint32_t>(writer),
                                 .number = probes_};
    bool has_come = false;
    for (int waited = 0; waited < matching_limit_ms && !has_come; ++waited) {
      // A second one is for a best-effort reader on a network that loses.
      if (waited % 2000 == 0) checked(dds_write(writers_[writer].get(), &probe), "dds_write");
      // The handle is known as soon as the probe is written, to the reader only when it has
      // arrived.
      const dds_instance_handle_t instance = dds_lookup_instance(reader.reader.get(), &probe);
      maide_dds_Sample sample{};
      void* samples[] = {&sample};
      dds_sample_info_t info[1];
      const dds_return_t taken =
          dds_take_instance(reader.reader.get(), samples, info, 1, 1, instance);
      if (taken != DDS_RETCODE_PRECONDITION_NOT_MET) checked(taken, "dds_take_instance");
      // A late reader may be given an earlier one first.
      has_come = taken > 0 && info[0].valid_data && sample.number == probe.number;
      if (!has_come) dds_sleepfor(DDS_MSECS(1));
    }
    if (!has_come) {
      throw std::runtime_error("nothing comes from a writer to a reader within 10 s");
    }
  }
}

// What a late reader was given, up to its limit.
std::int32_t Endpoints::count_kept(const Reader& reader) const {
  std::vector<maide_dds_Sample> samples(static_cast<std::size_t>(room_));
  std::vector<dds_sample_info_t> infos(samples.size());
  std::vector<void*> places;
  for (maide_dds_Sample& sample : samples) places.push_back(&sample);
  if (places.empty()) return 0;
  return checked(dds_read(reader.reader.get(), places.data(), infos.data(), places.size(),
                          static_cast<std::uint32_t>(places.size())),
                 "dds_read");
}

bool Endpoints::write(std::size_t writer, std::uint32_t number) {
  const maide_dds_Sample sample{.instance = 0, .number = number};
  ++writing_;
  const dds_return_t result = dds_write(writers_[writer].get(), &sample);
  if (result == DDS_RETCODE_OK) {
    for (Reader& reader : readers_) {
      if (reader.is_connected) ++reader.kept;
    }
  }
  --writing_;
  if (result == DDS_RETCODE_TIMEOUT) return false;
  checked(result, "dds_write");
  return true;
}

std::optional<std::uint32_t> Endpoints::take(std::size_t number) {
  Reader& reader = readers_[number];
  if (reader.reader.get() <= 0) return std::nullopt;
  maide_dds_Sample sample{};
  void* samples[] = {&sample};
  dds_sample_info_t info[1];
  while (checked(dds_take(reader.reader.get(), samples, info, 1, 1), "dds_take") > 0) {
    // A sample without data tells that an instance came or went.
    if (!info[0].valid_data || sample.instance != 0) continue;
    --reader.kept;
    room_made_ = std::chrono::steady_clock::now();
    return sample.number;
  }
  return std::nullopt;
}

void Endpoints::wait_for_data(std::size_t reader) {
  checked(dds_waitset_wait(readers_[reader].waitset.get(), nullptr, 0, DDS_INFINITY),
          "dds_waitset_wait");
}

void Endpoints::stop() {
  for (Reader& reader : readers_) dds_set_guardcondition(reader.stop.get(), true);
  for (std::size_t reader = 0; reader < readers_.size(); ++reader) {
    while (take(reader)) {  // room for a blocked write
    }
  }
}

// It needs room with all readers, and looks at one after the other: where one is full, another that
// has just made room may still be given the message.
bool Endpoints::polls_in_vain() const {
  if (room_ == 0 || writing_ == 0) return false;
  const bool is_full = std::any_of(readers_.begin(), readers_.end(),
                                   [this](const Reader& reader) { return reader.kept >= room_; });
  return is_full && (readers_.size() == 1 ||
                     std::chrono::steady_clock::now() - room_made_.load() > longest_look);
}

}  // namespace maide::cyclonedds
