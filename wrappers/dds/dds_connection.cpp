#include "dds/dds_connection.hpp"

#include <stdexcept>
#include <string>
#include <utility>

namespace maide::dds {

void DdsConnection::call(std::string_view input) {
  if (stopped_) return;
  if (input == "write") {
    write();
  } else if (input == "read") {
    read();
  } else if (input == "tryread") {
    try_read();
  } else if (input == "disconnect") {
    const std::size_t reader = sink_.end();
    if (std::exchange(connected_[reader], char{false}) != 0) ends_->disconnect(reader);
  } else if (input == "connect") {
    const std::size_t reader = sink_.end();
    if (std::exchange(connected_[reader], char{true}) == 0) ends_->connect(reader);
  } else {
    throw std::logic_error("no input '" + std::string(input) + "'");
  }
}

void DdsConnection::write() {
  const auto number = static_cast<std::uint32_t>(sink_.content(written_ + 1));
  if (!ends_->write(sink_.end(), number)) {
    sink_.report("failed");
    return;
  }
  ++written_;
  sink_.report("written");
}

void DdsConnection::read() {
  const std::size_t reader = sink_.end();
  if (connected_[reader] == 0) {
    sink_.report("unconnected");
    return;
  }
  while (!stopped_ && !take_one(reader)) ends_->wait_for_data(reader);
}

void DdsConnection::try_read() {
  const std::size_t reader = sink_.end();
  if (connected_[reader] == 0) {
    sink_.report("unconnected");
  } else if (!take_one(reader)) {
    sink_.report("null");
  }
}

bool DdsConnection::take_one(std::size_t reader) {
  const std::optional<std::uint32_t> number = ends_->take(reader);
  if (number) sink_.message(*number);
  return number.has_value();
}

void DdsConnection::shutdown() {
  stopped_ = true;
  ends_->stop();
}

}  // namespace maide::dds
