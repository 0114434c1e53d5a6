// One YARP port that writes and one that reads, open and connected, under names of their own.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "ends.hpp"
#include "loopback_ports.hpp"

namespace maide::yarp_ports {

class PortPair {
 public:
  // Opens both ends on loopback and connects them with `carrier`. `name` starts with '/' and is
  // used once. Throws std::runtime_error.
  PortPair(Kind kind, const std::string& name, std::string carrier, LoopbackPorts& ports);
  // Closes both ends; may take long, or never return, when YARP is in a bad state.
  ~PortPair();
  PortPair(const PortPair&) = delete;
  PortPair& operator=(const PortPair&) = delete;

  WriterEnd& writer() { return *writer_; }
  ReaderEnd& reader() { return *reader_; }
  // What YARP says of it.
  bool connect();
  bool disconnect();
  // Deletes the writer's port; writer() is gone then.
  void destroy_writer();
  // From now on the writer's port is closed in the end, but not deleted: that would crash.
  void keep_writer() { keeps_writer_ = true; }

 private:
  std::uint16_t open(yarp::os::Contactable& port, const std::string& name);
  void wait_until_connected();

  const std::string writer_name_, reader_name_, carrier_;
  LoopbackPorts& ports_;
  std::unique_ptr<WriterEnd> writer_;
  std::unique_ptr<ReaderEnd> reader_;
  std::uint16_t writer_port_ = 0, reader_port_ = 0;
  bool keeps_writer_ = false;
};

}  // namespace maide::yarp_ports
