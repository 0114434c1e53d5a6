// Writers and readers of Cyclone DDS, matched, and the calls that an application makes on them.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "dds/dds_connection.hpp"
#include "dds/policies.hpp"
#include "dds_entity.hpp"
#include "domains.hpp"

namespace maide::cyclonedds {

class Endpoints : public dds::Endpoints {
 public:
  // `topic`: a name that no other of the participants has. Throws std::runtime_error.
  Endpoints(const Domains& domains, const std::string& topic, const dds::Policies& policies,
            const dds::EndCounts& counts);

  bool write(std::size_t writer, std::uint32_t number) override;
  std::optional<std::uint32_t> take(std::size_t reader) override;
  void wait_for_data(std::size_t reader) override;
  void disconnect(std::size_t reader) override;
  void connect(std::size_t reader) override;
  void stop() override;
  bool polls_in_vain() const override;

 private:
  struct Reader {
    Entity reader, data;                 // with its read condition; none if disconnected
    Entity stop, waitset;                // a guard condition, and who waits for it and for data
    std::atomic<std::int32_t> kept = 0;  // accepted and not yet taken, where nothing is dropped
    std::atomic<bool> is_connected = false;
  };
  void wait_for_matches() const;
  void wait_for_probes(const Reader& reader);
  std::int32_t count_kept(const Reader& reader) const;

  const dds_entity_t participant_;  // of the readers
  const bool over_network_;
  const Qos reader_qos_;
  const std::int32_t room_;  // the reader's max_samples; 0: no limit
  const bool match_;         // else writers and readers never meet
  // Deleted in the opposite order.
  Entity writer_topic_;
  std::vector<Entity> writers_;
  Entity topic_;
  std::vector<Reader> readers_;
  std::atomic<int> writing_ = 0;  // within dds_write
  // When a reader last made room: a blocked write finds it at its next look.
  std::atomic<std::chrono::steady_clock::time_point> room_made_{};
  std::uint32_t probes_ = 0;  // of connections over the network
};

}  // namespace maide::cyclonedds
