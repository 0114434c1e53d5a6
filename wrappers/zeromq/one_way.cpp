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
  if (settings.is_bounded) setup.in_flight.emplace().capacity = settings.capacity();
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
      sink_(sink) {
  if (settings.conflate) connecting_.set(zmq::sockopt::conflate, true);
  if (settings.pattern == Pattern::pub_sub) connecting_.set(zmq::sockopt::subscribe, "");
  if (!settings.waits) binding_.set(zmq::sockopt::sndtimeo, 0);
  join(endpoint);
  wait_until_matched(settings.pattern);
}

// What a publisher writes before the subscription is there is lost; what is pushed before there is
// a peer waits. Both sockets are this thread's until the first input.
void OneWay::wait_until_matched(Pattern pattern) {
  const bool subscribes = pattern == Pattern::pub_sub;
  zmq::pollitem_t item{binding_.handle(), 0,
                       static_cast<short>(subscribes ? ZMQ_POLLIN : ZMQ_POLLOUT), 0};
  if (zmq::poll(&item, 1, matching_limit) == 0) {
    throw std::runtime_error("the sockets do not find each other");
  }
  zmq::message_t subscription;
  if (subscribes) static_cast<void>(binding_.recv(subscription));
}

void OneWay::make_call(std::string_view input) {
  if (input == "write") {
    write();
  } else if (input == "read" || input == "tryread") {
    const auto number = receive(connecting_, input == "read");
    number ? sink_.message(*number) : sink_.report("null");
  } else if (input == "disconnect") {
    if (std::exchange(connected_, false)) connecting_.disconnect(address());
  } else if (input == "connect") {
    if (!std::exchange(connected_, true)) connecting_.connect(address());
  } else {
    throw std::logic_error("no input '" + std::string(input) + "'");
  }
}

void OneWay::write() {
  const bool sent = send(binding_, written_ + 1);
  written_ += sent;
  sink_.report(sent ? "written" : "failed");
}

}  // namespace maide::zeromq
