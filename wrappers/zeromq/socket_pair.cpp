#include "socket_pair.hpp"

#include <cstring>
#include <stdexcept>
#include <utility>

namespace maide::zeromq {
namespace {

// The number of calls under way, this one included.
class Counted {
 public:
  explicit Counted(std::atomic<int>& calls) : calls_(calls) { ++calls_; }
  ~Counted() { --calls_; }
  Counted(const Counted&) = delete;
  Counted& operator=(const Counted&) = delete;

 private:
  std::atomic<int>& calls_;
};

}  // namespace

SocketPair::SocketPair(std::shared_ptr<SharedContext> context, zmq::socket_type binding,
                       zmq::socket_type connecting, const SocketSettings& settings)
    : context_(std::move(context)), polls_(settings.polls) {
  const auto make = [&](std::size_t count, zmq::socket_type type) {
    std::vector<zmq::socket_t> sockets;
    for (std::size_t i = 0; i < count; ++i) {
      zmq::socket_t& socket = sockets.emplace_back(context_->get(), type);
      socket.set(zmq::sockopt::linger, 0);
      socket.set(zmq::sockopt::sndhwm, settings.sndhwm);
      socket.set(zmq::sockopt::rcvhwm, settings.rcvhwm);
    }
    return sockets;
  };
  binding_ = make(settings.writers, binding);
  connecting_ = make(settings.readers, connecting);
}

void SocketPair::join(const std::string& endpoint) {
  const bool is_named = endpoint.starts_with("inproc");
  for (std::size_t i = 0; i < binding_.size(); ++i) {
    binding_[i].bind(is_named ? endpoint + "-" + std::to_string(i) : endpoint);
    addresses_.push_back(binding_[i].get(zmq::sockopt::last_endpoint));
  }
  for (zmq::socket_t& socket : connecting_) connect(socket);
}

void SocketPair::connect(zmq::socket_t& socket) {
  for (const std::string& address : addresses_) socket.connect(address);
}

void SocketPair::disconnect(zmq::socket_t& socket) {
  for (const std::string& address : addresses_) socket.disconnect(address);
}

// Either this call sees that the word is over, or shutdown() sees this call.
void SocketPair::call(std::string_view input) {
  const Counted counted(calls_);
  if (stopped_) return;
  try {
    make_call(input);
  } catch (const zmq::error_t& error) {
    if (error.num() != ETERM) throw;
  }
}

void SocketPair::shutdown() {
  stopped_ = true;
  if (calls_ > 0) context_->shut_down();
}

bool SocketPair::send(zmq::socket_t& socket, std::uint64_t number) const {
  // Has the effect that all news of the peers is heard; what the events are does not matter.
  if (polls_) static_cast<void>(socket.get(zmq::sockopt::events));
  return socket.send(zmq::const_buffer(&number, sizeof number)).has_value();
}

std::optional<std::uint64_t> SocketPair::receive(zmq::socket_t& socket, bool waits) {
  zmq::message_t message;
  if (!socket.recv(message, waits ? zmq::recv_flags::none : zmq::recv_flags::dontwait)) return {};
  std::uint64_t number = 0;
  if (message.size() != sizeof number) throw std::runtime_error("a message of another size");
  std::memcpy(&number, message.data(), sizeof number);
  return number;
}

}  // namespace maide::zeromq
