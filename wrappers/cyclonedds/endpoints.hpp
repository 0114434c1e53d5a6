// A writer and a reader of Cyclone DDS, matched, and the calls that an application makes on them.
#pragma once

#include <atomic>
#include <cstdint>
#include <optional>
#include <string>

#include "dds/connection.hpp"
#include "dds/policies.hpp"
#include "dds_entity.hpp"
#include "domains.hpp"

namespace maide::cyclonedds {

class Endpoints : public dds::Endpoints {
 public:
  // `topic`: a name that no other of the participants has. Throws std::runtime_error.
  Endpoints(const Domains& domains, const std::string& topic, const dds::Policies& policies);

  bool write(std::uint32_t number) override;
  std::optional<std::uint32_t> take() override;
  void wait_for_data() override;
  void disconnect() override;
  void connect() override;
  void stop() override;
  bool polls_in_vain() const override;

 private:
  void wait_for_matches(std::uint32_t count) const;
  void wait_for_probe();
  std::int32_t count_kept() const;

  const dds_entity_t participant_;  // of the reader
  const bool over_network_;
  const Qos reader_qos_;
  const std::int32_t room_;  // the reader's max_samples; 0: no limit
  // Deleted in the opposite order.
  Entity writer_topic_, writer_, topic_;
  Entity reader_, data_;                // a reader and its read condition; none if disconnected
  Entity stop_, waitset_;               // a guard condition, and who waits for it and for data
  std::atomic<std::int32_t> kept_ = 0;  // accepted and not yet taken, where nothing is dropped
  std::atomic<bool> writing_ = false;   // within dds_write
  std::uint32_t probes_ = 0;            // of connections over the network
};

}  // namespace maide::cyclonedds
