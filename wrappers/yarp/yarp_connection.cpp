#include "yarp_connection.hpp"

#include <stdexcept>
#include <string>
#include <utility>

namespace maide::yarp_ports {
namespace {

// One more for as long as it lives.
class Count {
 public:
  explicit Count(std::atomic<int>& calls) : calls_(calls) { ++calls_; }
  ~Count() { --calls_; }
  Count(const Count&) = delete;
  Count& operator=(const Count&) = delete;

 private:
  std::atomic<int>& calls_;
};

}  // namespace

YarpConnection::YarpConnection(PairStore& store, bool server_polls, EventSink& sink)
    : store_(store), server_polls_(server_polls), pair_(store.take()), sink_(sink) {}

YarpConnection::~YarpConnection() { store_.give_back(std::move(pair_)); }

void YarpConnection::call(std::string_view input) {
  if (shut_down_) return;
  if (input == "write" || input == "write_2") {
    write(input);
  } else if (input == "read") {
    read(true);
  } else if (input == "tryread") {
    read(false);
  } else if (input == "read_2") {
    read_2();
  } else if (input == "connect" || input == "disconnect") {
    call_network(input);
  } else if (input.ends_with("_reader")) {
    call_reader_control(input);
  } else {
    call_writer_control(input);
  }
}

void YarpConnection::write(std::string_view input) {
  if (destroyed_) return;
  bool was_sent = false;
  {
    const Count writing(writing_);
    const auto place = static_cast<std::uint64_t>(++written_);
    was_sent = pair_->writer().write(static_cast<std::int64_t>(sink_.content(place)));
  }
  if (input == "write") {
    sink_.report(was_sent ? "written" : "failed");
  } else {
    sink_.report(was_sent ? "written_2" : "failed_2");
  }
}

void YarpConnection::read(bool waits) {
  const Count reading(reading_);
  const Received received = waits ? pair_->reader().read() : pair_->reader().try_read();
  if (!received.has_message) {
    sink_.report("null");
  } else if (received.number) {
    sink_.message(static_cast<std::uint64_t>(*received.number));
  } else {
    sink_.report("empty");
  }
}

void YarpConnection::read_2() {
  const Count reading(reading_);
  sink_.report(pair_->reader().read().has_message ? "message_2" : "null_2");
}

void YarpConnection::call_writer_control(std::string_view input) {
  if (destroyed_) return;
  yarp::os::Contactable& port = pair_->writer().port();
  if (input == "interrupt") {
    // A buffered port that was interrupted and written to cannot be deleted (3.9.1).
    if (pair_->writer().is_buffered()) pair_->keep_writer();
    port.interrupt();
    sink_.report("done");
  } else if (input == "resume") {
    port.resume();
    sink_.report("resumed");
  } else if (input == "close") {
    {
      const Count closing(closing_);
      port.close();
    }
    sink_.report("closed");
  } else if (input == "destroy") {
    {
      const Count closing(closing_);
      destroyed_ = true;
      pair_->destroy_writer();
    }
    sink_.report("destroyed");
  } else {
    throw std::logic_error("no input '" + std::string(input) + "'");
  }
}

void YarpConnection::call_reader_control(std::string_view input) {
  yarp::os::Contactable& port = pair_->reader().port();
  if (input == "interrupt_reader") {
    port.interrupt();
    sink_.report("done_reader");
  } else if (input == "resume_reader") {
    port.resume();
    sink_.report("resumed_reader");
  } else if (input == "close_reader") {
    port.close();
    sink_.report("closed_reader");
  } else {
    throw std::logic_error("no input '" + std::string(input) + "'");
  }
}

void YarpConnection::call_network(std::string_view input) {
  const bool connects = input == "connect";
  const bool is_done = connects ? pair_->connect() : pair_->disconnect();
  sink_.report(!is_done ? "denied" : connects ? "connected" : "disconnected");
}

// Closing a port that writes sleeps and looks, up to some 5 s, whether the write is over; which it
// will not be while all else sleeps.
bool YarpConnection::polls_in_vain() const { return closing_ > 0 ? writing_ > 0 : server_polls_; }

// A write that waits for its read is let go by one (and with it the interrupt, close or disconnect
// that waits for the write); a read by closing its port; a strict write that waits for the one
// before by closing its port and taking its message away.
void YarpConnection::shutdown() {
  shut_down_ = true;
  if (writing_ > 0 && reading_ == 0 && !pair_->writer().is_buffered()) {
    pair_->reader().port().resume();
    pair_->reader().read();
  }
  // Closing wakes one reader only.
  for (int others = reading_; others > 1; --others) pair_->reader().port().interrupt();
  pair_->reader().port().close();
  if (writing_ > 0) pair_->writer().give_up();
}

}  // namespace maide::yarp_ports
