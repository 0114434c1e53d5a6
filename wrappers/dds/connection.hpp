// One writer and one reader of a topic of their own, matched: what one word is played on, whatever
// the vendor. Here is what each input means; a vendor's Endpoints make the calls.
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

#include "maide/wire/wrapper/system_wrapper.hpp"

namespace maide::dds {

// A writer and a reader of one vendor, made and matched. What fails, other than as described,
// throws std::runtime_error. The writer and the reader are called from a thread each.
class Endpoints {
 public:
  virtual ~Endpoints() = default;
  // False if it found no room in time; blocks as the policies say.
  virtual bool write(std::uint32_t number) = 0;
  // The number in the oldest sample there is, without waiting.
  virtual std::optional<std::uint32_t> take() = 0;
  // Blocks until there may be a sample to take, or stop().
  virtual void wait_for_data() = 0;
  // Deletes the reader; returns when the writer knows.
  virtual void disconnect() = 0;
  // Makes a reader; returns when it and the writer know each other.
  virtual void connect() = 0;
  // From another thread: waits end, now and later, and a blocked write finds room.
  virtual void stop() = 0;
  // SystemInstance::polls_in_vain.
  virtual bool polls_in_vain() const { return false; }
};

class Connection : public SystemInstance {
 public:
  // Others may keep `ends` longer than the connection lives, to delete them when that is cheap.
  Connection(std::shared_ptr<Endpoints> ends, EventSink& sink)
      : ends_(std::move(ends)), sink_(sink) {}

  void call(std::string_view input) override;
  void shutdown() override;
  bool polls_in_vain() const override { return ends_->polls_in_vain(); }

 private:
  void write();
  void read();
  void try_read();
  bool take_one();

  const std::shared_ptr<Endpoints> ends_;
  EventSink& sink_;
  std::uint32_t written_ = 0;  // only the writer's thread writes
  bool connected_ = true;      // only the reader's thread connects
  std::atomic<bool> stopped_ = false;
};

}  // namespace maide::dds
