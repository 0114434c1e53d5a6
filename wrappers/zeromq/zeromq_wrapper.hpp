// The wrapper for ZeroMQ: `maide learn zeromq pattern=pub-sub sndhwm=1 rcvhwm=1`. Sockets of one
// pattern in one process, joined by inproc or by TCP on the loopback device; each is used by an
// actor of its own. Writing sockets bind, reading ones connect.
//
// A reset keeps the context, and with it ZeroMQ's threads; sockets and endpoint are fresh for each
// word. A word that ends within a blocked call takes its context with it: shutting a context down
// is the one way to get such a call back.
#pragma once

#include <cstdint>
#include <memory>

#include "maide/wire/wrapper/system_wrapper.hpp"
#include "shared_context.hpp"
#include "socket_settings.hpp"

namespace maide::zeromq {

class ZeroMqWrapper : public SystemWrapper {
 public:
  ZeroMqWrapper();
  const WrapperDescription& description() const override { return description_; }
  SystemSetup configure(const OptionValues& options) override;
  std::unique_ptr<SystemInstance> reset(EventSink& sink) override;

 private:
  WrapperDescription description_;
  SocketSettings settings_;
  std::uint64_t words_ = 0;
  std::shared_ptr<SharedContext> context_;
};

}  // namespace maide::zeromq
