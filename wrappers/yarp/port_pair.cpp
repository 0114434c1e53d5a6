#include "port_pair.hpp"

#include <fmt/format.h>
#include <yarp/os/Contact.h>
#include <yarp/os/Network.h>

#include <chrono>
#include <stdexcept>
#include <thread>
#include <utility>

namespace maide::yarp_ports {
namespace {

using namespace std::chrono_literals;
using yarp::os::Contact;
using yarp::os::NetworkBase;

constexpr int open_attempts = 20;

}  // namespace

PortPair::PortPair(Kind kind, const std::string& name, std::string carrier, LoopbackPorts& ports)
    : writer_name_(name + "/out"),
      reader_name_(name + "/in"),
      carrier_(std::move(carrier)),
      ports_(ports),
      writer_(make_writer(kind)),
      reader_(make_reader(kind)) {
  reader_port_ = open(reader_->port(), reader_name_);
  writer_port_ = open(writer_->port(), writer_name_);
  if (!connect()) throw std::runtime_error("YARP does not connect " + writer_name_);
  wait_until_connected();
}

// YARP enters a port into the table of names only where it may choose the number itself; so the
// entry is made, and taken away, by hand.
std::uint16_t PortPair::open(yarp::os::Contactable& port, const std::string& name) {
  for (int attempt = 0; attempt < open_attempts; ++attempt) {
    const std::uint16_t number = ports_.take();
    const Contact contact(name, "tcp", "127.0.0.1", number);
    if (!port.open(contact, false)) continue;  // somebody else has the number: not given back
    NetworkBase::registerContact(contact);
    return number;
  }
  throw std::runtime_error(
      fmt::format("YARP does not open {}, tried {} TCP ports", name, open_attempts));
}

bool PortPair::connect() {
  return NetworkBase::connect(writer_name_, reader_name_, carrier_, true);
}

bool PortPair::disconnect() { return NetworkBase::disconnect(writer_name_, reader_name_, true); }

// The reader counts its input a little after `connect` has returned.
void PortPair::wait_until_connected() {
  constexpr auto limit = 5s;
  const auto start = std::chrono::steady_clock::now();
  while (reader_->port().getInputCount() < 1) {
    if (std::chrono::steady_clock::now() - start > limit) {
      throw std::runtime_error("the reader has no connection within 5 seconds");
    }
    std::this_thread::sleep_for(50us);
  }
}

void PortPair::destroy_writer() { writer_.reset(); }

PortPair::~PortPair() {
  reader_->port().close();
  if (writer_) writer_->port().close();
  NetworkBase::unregisterName(reader_name_);
  NetworkBase::unregisterName(writer_name_);
  reader_.reset();
  if (keeps_writer_) static_cast<void>(writer_.release());
  writer_.reset();
  ports_.give_back(reader_port_);
  ports_.give_back(writer_port_);
}

}  // namespace maide::yarp_ports
