// The two ends of a YARP connection: yarp::os::Port, whose write waits for its read, and
// yarp::os::BufferedPort, whose reader keeps the newest message or, strictly, all of them. A
// message is a bottle that holds its number.
#pragma once

#include <yarp/os/Contactable.h>

#include <cstdint>
#include <memory>
#include <optional>

namespace maide::yarp_ports {

enum class Kind : std::uint8_t { port, buffered, strict };

class WriterEnd {
 public:
  virtual ~WriterEnd() = default;
  virtual yarp::os::Contactable& port() = 0;
  // What YARP's write returns; a buffered one returns nothing and counts as true.
  virtual bool write(std::int64_t number) = 0;
  virtual bool is_buffered() const = 0;
  // From another thread: closes the port and lets go a write that waits for the one before.
  virtual void give_up() = 0;
};

// What a read that returned brought.
struct Received {
  bool has_message = false;            // false: the read was given up (false, or a null pointer)
  std::optional<std::int64_t> number;  // nothing: the message was an empty bottle
};

class ReaderEnd {
 public:
  virtual ~ReaderEnd() = default;
  virtual yarp::os::Contactable& port() = 0;
  virtual Received read() = 0;
  // A plain Port has no read that does not wait: throws std::logic_error.
  virtual Received try_read() = 0;
};

std::unique_ptr<WriterEnd> make_writer(Kind kind);
std::unique_ptr<ReaderEnd> make_reader(Kind kind);

}  // namespace maide::yarp_ports
