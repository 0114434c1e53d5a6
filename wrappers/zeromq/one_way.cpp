#include "one_way.hpp"

#include <chrono>
#include <stdexcept>
#include <utility>

namespace maide::zeromq {
namespace {

constexpr std::chrono::milliseconds matching_limit{5000};

}  // namespace

SystemSetup OneWay::setup(const SocketSettings& settings) {
  SystemSetup setup;
  setup.actors = {"writer", "reader"};
  setup.inputs = {{"write", "writer", {}},
                  {"read", "reader", {"message"}},
                  {"tryread", "reader", {}},
                  {"disconnect", "reader", {}},
                  {"connect", "reader", {}}};
  if (settings.pushes_back() && settings.waits) setup.inputs[0].returns = {"written"};
  setup.events = {
      {"message", "reader"}, {"null", "reader"}, {"written", "writer"}, {"failed", "writer"}};
  if (settings.is_bounded) {
    setup.in_flight.emplace().capacity = settings.capacity();
    setup.in_flight->is_shared = settings.pattern == Pattern::push_pull;
  }
  return setup;
}

// An XPUB is a PUB that can be asked whether the subscription has arrived.
OneWay::OneWay(std::shared_ptr<SharedContext> context, const std::string& endpoint,
               const SocketSettings& settings, EventSink& sink)
    : SocketPair(
          std::move(context),
          settings.pattern == Pattern::pub_sub ? zmq::socket_type::xpub : zmq::socket_type::push,
          settings.pattern == Pattern::pub_sub ? zmq::socket_type::sub : zmq::socket_type::pull,
          settings),
      sink_(sink),
      connected_(settings.readers, char{true}) {
  for (zmq::socket_t& reader : connecting_) {
    if (settings.conflate) reader.set(zmq::sockopt::conflate, true);
    if (settings.pattern == Pattern::pub_sub) reader.set(zmq::sockopt::subscribe, "");
  }
  for (zmq::socket_t& writer : binding_) {
    if (!settings.waits) writer.set(zmq::sockopt::sndtimeo, 0);
    // Else a subscription that another reader has already is not told.
    if (settings.pattern == Pattern::pub_sub) writer.set(zmq::sockopt::xpub_verbose, true);
  }
  join(endpoint);
  wait_until_matched(settings.pattern);
}

// What a publisher writes before the subscription is there is lost; what is pushed before there is
// a peer waits. All sockets are this thread's until the first input.
void OneWay::wait_until_matched(Pattern pattern) {
  const bool subscribes = pattern == Pattern::pub_sub;
  for (zmq::socket_t& writer : binding_) {
    zmq::pollitem_t item{writer.handle(), 0,
                         static_cast<short>(subscribes ? ZMQ_POLLIN : ZMQ_POLLOUT), 0};
    for (std::size_t reader = 0; reader < connecting_.size(); ++reader) {
      if (zmq::poll(&item, 1, matching_limit) == 0) {
        throw std::runtime_error("the sockets do not find each other");
      }
      zmq::message_t subscription;
      if (subscribes) static_cast<void>(writer.recv(subscription));
    }
  }
}

void OneWay::make_call(std::string_view input) {
  const std::size_t end = sink_.end();
  if (input == "write") {
    write();
  } else if (input == "read" || input == "tryread") {
    const auto number = receive(connecting_[end], input == "read");
    number ? sink_.message(*number) : sink_.report("null");
  } else if (input == "disconnect") {
    if (std::exchange(connected_[end], char{false}) != 0) disconnect(connecting_[end]);
  } else if (input == "connect") {
    if (std::exchange(connected_[end], char{true}) == 0) connect(connecting_[end]);
  } else {
    throw std::logic_error("no input '" + std::string(input) + "'");
  }
}

void OneWay::write() {
  const bool sent = send(binding_[sink_.end()], sink_.content(written_ + 1));
  written_ += sent ? 1 : 0;
  sink_.report(sent ? "written" : "failed");
}

}  // namespace maide::zeromq
