#include "request_reply.hpp"

#include <stdexcept>
#include <utility>

namespace maide::zeromq {

SystemSetup RequestReply::setup(const SocketSettings&) {
  SystemSetup setup;
  setup.actors = {"client", "server"};
  setup.inputs = {{"write", "client", {}},     {"read", "client", {"message", "failed"}},
                  {"tryread", "client", {}},   {"accept", "server", {"accepted", "rejected"}},
                  {"tryaccept", "server", {}}, {"answer", "server", {}}};
  setup.events = {{"message", "client"},  {"null", "client"},     {"written", "client"},
                  {"failed", "client"},   {"accepted", "server"}, {"none", "server"},
                  {"answered", "server"}, {"rejected", "server"}};
  return setup;
}

// A request that finds no peer waits, so nothing needs to be waited for here.
RequestReply::RequestReply(std::shared_ptr<SharedContext> context, const std::string& endpoint,
                           const SocketSettings& settings, EventSink& sink)
    : SocketPair(std::move(context), zmq::socket_type::rep, zmq::socket_type::req, settings),
      sink_(sink) {
  join(endpoint);
}

void RequestReply::make_call(std::string_view input) {
  const bool is_client = input == "write" || input == "read" || input == "tryread";
  try {
    is_client ? call_as_client(input) : call_as_server(input);
  } catch (const zmq::error_t& error) {
    if (error.num() != EFSM) throw;
    sink_.report(is_client ? "failed" : "rejected");
  }
}

void RequestReply::call_as_client(std::string_view input) {
  if (input == "write") {
    send(connecting_.front(), sink_.content(requests_ + 1));
    ++requests_;
    sink_.report("written");
    return;
  }
  const auto number = receive(connecting_.front(), input == "read");
  number ? sink_.message(*number) : sink_.report("null");
}

// A reply carries the number of its request.
void RequestReply::call_as_server(std::string_view input) {
  if (input == "answer") {
    send(binding_.front(), accepted_);
    sink_.report("answered");
    return;
  }
  if (input != "accept" && input != "tryaccept") {
    throw std::logic_error("no input '" + std::string(input) + "'");
  }
  const auto number = receive(binding_.front(), input == "accept");
  if (number) accepted_ = *number;
  sink_.report(number ? "accepted" : "none");
}

}  // namespace maide::zeromq
