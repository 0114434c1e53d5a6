// Writers and readers of a topic of their own, matched: what one word is played on, whatever the
// vendor. Here is what each input means; a vendor's Endpoints make the calls.
//
//   write       writes one sample: `written`, or `failed` if it found no room in time
//   read        waits for a sample, without limit, and takes it: `message`
//   tryread     takes a sample if there is one: `message` or `null`
//   disconnect  deletes the reader; until it is made again, reads say `unconnected`
//   connect     makes the reader anew: a late joiner, if something was written before
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "maide/wire/wrapper/system_wrapper.hpp"

namespace maide::dds {

// How many ends the options `writers` and `readers` ask for.
struct EndCounts {
  std::size_t writers = 1, readers = 1;
};

// Writers and readers of one vendor, made and matched, each with a number from 0. What fails, other
// than as described, throws std::runtime_error. Each end is called from a thread of its own.
class Endpoints {
 public:
  virtual ~Endpoints() = default;
  // False if it found no room in time; blocks as the policies say.
  virtual bool write(std::size_t writer, std::uint32_t number) = 0;
  // The number in the oldest sample there is, without waiting.
  virtual std::optional<std::uint32_t> take(std::size_t reader) = 0;
  // Blocks until there may be a sample to take, or stop().
  virtual void wait_for_data(std::size_t reader) = 0;
  // Deletes the reader; returns when all writers know.
  virtual void disconnect(std::size_t reader) = 0;
  // Makes the reader anew; returns when it and all writers know each other.
  virtual void connect(std::size_t reader) = 0;
  // From another thread: waits end, now and later, and a blocked write finds room.
  virtual void stop() = 0;
  // SystemInstance::polls_in_vain.
  virtual bool polls_in_vain() const { return false; }
};

class DdsConnection : public SystemInstance {
 public:
  // Others may keep `ends` longer than the connection lives, to delete them when that is cheap.
  DdsConnection(std::shared_ptr<Endpoints> ends, const EndCounts& counts, EventSink& sink)
      : ends_(std::move(ends)), sink_(sink), connected_(counts.readers, char{true}) {}

  void call(std::string_view input) override;
  void shutdown() override;
  bool polls_in_vain() const override { return ends_->polls_in_vain(); }

 private:
  void write();
  void read();
  void try_read();
  bool take_one(std::size_t reader);

  const std::shared_ptr<Endpoints> ends_;
  EventSink& sink_;
  std::atomic<std::uint32_t> written_ = 0;
  std::vector<char> connected_;  // by reader, whose thread alone connects it
  std::atomic<bool> stopped_ = false;
};

}  // namespace maide::dds
