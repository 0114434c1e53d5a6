// One writer and one reader of a topic of their own, matched: what one word is played on.
#pragma once

#include <atomic>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "dds_entity.hpp"
#include "maide/wire/system_wrapper.hpp"
#include "policies.hpp"

namespace maide::cyclonedds {

// The entities of a connection; they are deleted in the opposite order.
struct Endpoints {
  Entity topic, reader, writer;
  Entity stop, data, waitset;  // a guard condition, a read condition, and who waits for both
};

class Connection : public SystemInstance {
 public:
  // `topic`: a name that no other connection of the participant has. When the connection ends its
  // entities, idle from then on, go to `retired`. Throws std::runtime_error.
  Connection(dds_entity_t participant, const std::string& topic, const Policies& policies,
             EventSink& sink, std::vector<Endpoints>& retired);
  ~Connection() override { retired_.push_back(std::move(ends_)); }

  void call(std::string_view input) override;
  void shutdown() override;
  bool polls_in_vain() const override;

 private:
  void wait_until_matched() const;
  void write();
  void read();
  bool take_one();

  const std::int32_t room_;  // the reader's max_samples
  EventSink& sink_;
  std::vector<Endpoints>& retired_;
  Endpoints ends_;
  std::uint32_t written_ = 0;
  std::atomic<std::int32_t> kept_ = 0;  // accepted and not yet taken, where nothing is dropped
  std::atomic<bool> writing_ = false;   // within dds_write
  std::atomic<bool> stopped_ = false;
};

}  // namespace maide::cyclonedds
