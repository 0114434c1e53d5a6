#include "ends.hpp"

#include <yarp/os/Bottle.h>
#include <yarp/os/BufferedPort.h>
#include <yarp/os/Port.h>

#include <stdexcept>

namespace maide::yarp_ports {
namespace {

using yarp::os::Bottle;

void fill(Bottle& message, std::int64_t number) {
  message.clear();
  message.addInt64(number);
}

Received received(const Bottle& message) {
  if (message.size() == 0) return {true, std::nullopt};
  return {true, message.get(0).asInt64()};
}

class PortWriter : public WriterEnd {
 public:
  yarp::os::Contactable& port() override { return port_; }
  bool write(std::int64_t number) override {
    Bottle message;
    fill(message, number);
    return port_.write(message);
  }
  bool is_buffered() const override { return false; }
  void give_up() override { port_.close(); }

 private:
  yarp::os::Port port_;
};

class PortReader : public ReaderEnd {
 public:
  yarp::os::Contactable& port() override { return port_; }
  Received read() override {
    Bottle message;
    return port_.read(message) ? received(message) : Received{};
  }
  Received try_read() override { throw std::logic_error("a Port has no tryread"); }

 private:
  yarp::os::Port port_;
};

class BufferedWriter : public WriterEnd {
 public:
  explicit BufferedWriter(bool strict) : strict_(strict) {}
  yarp::os::Contactable& port() override { return port_; }
  bool write(std::int64_t number) override {
    fill(port_.prepare(), number);
    port_.write(strict_);
    return true;
  }
  bool is_buffered() const override { return true; }
  // A strict write sleeps until the message before is sent, also when it never will be; giving up
  // the message that it holds itself wakes it, and it finds its port closed.
  void give_up() override {
    port_.close();
    port_.unprepare();
  }

 private:
  const bool strict_;
  yarp::os::BufferedPort<Bottle> port_;
};

class BufferedReader : public ReaderEnd {
 public:
  explicit BufferedReader(bool strict) { port_.setStrict(strict); }
  yarp::os::Contactable& port() override { return port_; }
  Received read() override { return read(true); }
  Received try_read() override { return read(false); }

 private:
  Received read(bool waits) {
    const Bottle* message = port_.read(waits);
    return message != nullptr ? received(*message) : Received{};
  }

  yarp::os::BufferedPort<Bottle> port_;
};

}  // namespace

std::unique_ptr<WriterEnd> make_writer(Kind kind) {
  if (kind == Kind::port) return std::make_unique<PortWriter>();
  return std::make_unique<BufferedWriter>(kind == Kind::strict);
}

std::unique_ptr<ReaderEnd> make_reader(Kind kind) {
  if (kind == Kind::port) return std::make_unique<PortReader>();
  return std::make_unique<BufferedReader>(kind == Kind::strict);
}

}  // namespace maide::yarp_ports
