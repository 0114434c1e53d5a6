// REQ and REP: the actor `client` sends requests and receives replies, `server` receives requests
// and sends replies. A call that is out of turn fails at once (EFSM).
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "socket_pair.hpp"

namespace maide::zeromq {

class RequestReply : public SocketPair {
 public:
  static SystemSetup setup(const SocketSettings& settings);

  // Throws zmq::error_t.
  RequestReply(std::shared_ptr<SharedContext> context, const std::string& endpoint,
               const SocketSettings& settings, EventSink& sink);

 private:
  void make_call(std::string_view input) override;
  void call_as_client(std::string_view input);
  void call_as_server(std::string_view input);

  EventSink& sink_;
  std::uint64_t requests_ = 0;
  std::uint64_t accepted_ = 0;  // the number of the request that the server took last
};

}  // namespace maide::zeromq
