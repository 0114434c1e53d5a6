#include "dds/connection.hpp"

#include <stdexcept>
#include <string>
#include <utility>

namespace maide::dds {

void Connection::call(std::string_view input) {
  if (stopped_) return;
  if (input == "write") {
    write();
  } else if (input == "read") {
    read();
  } else if (input == "tryread") {
    try_read();
  } else if (input == "disconnect") {
    if (std::exchange(connected_, false)) ends_->disconnect();
  } else if (input == "connect") {
    if (!std::exchange(connected_, true)) ends_->connect();
  } else {
    throw std::logic_error("no input '" + std::string(input) + "'");
  }
}

void Connection::write() {
  if (!ends_->write(written_ + 1)) {
    sink_.report("failed");
    return;
  }
  ++written_;
  sink_.report("written");
}

void Connection::read() {
  if (!connected_) {
    sink_.report("unconnected");
    return;
  }
  while (!stopped_ && !take_one()) ends_->wait_for_data();
}

void Connection::try_read() {
  if (!connected_) {
    sink_.report("unconnected");
  } else if (!take_one()) {
    sink_.report("null");
  }
}

bool Connection::take_one() {
  const std::optional<std::uint32_t> number = ends_->take();
  if (number) sink_.message(*number);
  return number.has_value();
}

void Connection::shutdown() {
  stopped_ = true;
  ends_->stop();
}

}  // namespace maide::dds
