#include "zeromq_wrapper.hpp"

#include <fmt/core.h>

#include "one_way.hpp"
#include "request_reply.hpp"

namespace maide::zeromq {

ZeroMqWrapper::ZeroMqWrapper() {
  int major = 0, minor = 0, patch = 0;
  zmq_version(&major, &minor, &patch);
  description_.name = "zeromq";
  description_.summary = "ZeroMQ: sockets of one pattern, in one process";
  description_.versions = {{"zeromq", fmt::format("{}.{}.{}", major, minor, patch)},
                           {"wrapper", "1"}};
  description_.options = SocketSettings::options();
}

SystemSetup ZeroMqWrapper::configure(const OptionValues& options) {
  settings_ = SocketSettings::from(options);
  return settings_.pattern == Pattern::req_rep ? RequestReply::setup(settings_)
                                               : OneWay::setup(settings_);
}

std::unique_ptr<SystemInstance> ZeroMqWrapper::reset(EventSink& sink) {
  if (!context_ || context_->is_shut_down()) context_ = std::make_shared<SharedContext>();
  const std::string endpoint =
      settings_.uses_tcp ? "tcp://127.0.0.1:*" : fmt::format("inproc://maide-{}", ++words_);
  if (settings_.pattern == Pattern::req_rep) {
    return std::make_unique<RequestReply>(context_, endpoint, settings_, sink);
  }
  return std::make_unique<OneWay>(context_, endpoint, settings_, sink);
}

}  // namespace maide::zeromq
