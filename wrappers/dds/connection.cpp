#include "dds/connection.hpp"

#include <stdexcept>
#include <string>

namespace maide::dds {

void Connection::call(std::string_view input) {
  if (stopped_) return;
  if (input == "write") {
    write();
  } else if (input == "read") {
    read();
  } else if (input == "tryread") {
    if (!take_one()) sink_.report("null");
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
  do {
    ends_->wait_for_data();
  } while (!stopped_ && !take_one());
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
