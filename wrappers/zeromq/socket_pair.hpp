// Connected sockets, and how to get their blocked calls back: what both kinds of instances are made
// of. Some bind, and each of the others connects to all of these.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>
#include <zmq.hpp>

#include "maide/wire/wrapper/system_wrapper.hpp"
#include "shared_context.hpp"
#include "socket_settings.hpp"

namespace maide::zeromq {

class SocketPair : public SystemInstance {
 public:
  // Makes the call, unless the word is over; a call that shutdown() ends just returns.
  void call(std::string_view input) final;
  void shutdown() final;

 protected:
  // Makes the sockets with their high-water marks; nothing is bound or connected yet.
  SocketPair(std::shared_ptr<SharedContext> context, zmq::socket_type binding,
             zmq::socket_type connecting, const SocketSettings& settings);

  // Binds some to `endpoint`, of inproc with their number behind it, and connects the others. What
  // is sent may still find no peer.
  void join(const std::string& endpoint);
  // Of one of those that connect, with all that are bound.
  void connect(zmq::socket_t& socket);
  void disconnect(zmq::socket_t& socket);

  virtual void make_call(std::string_view input) = 0;

  // Sends a message that carries `number`; false if the socket would have to wait and was told not
  // to. Throws zmq::error_t.
  bool send(zmq::socket_t& socket, std::uint64_t number) const;
  // The number of the next message; nothing if there is none and it must not wait.
  static std::optional<std::uint64_t> receive(zmq::socket_t& socket, bool waits);

 private:
  // Before the sockets: they are closed first.
  std::shared_ptr<SharedContext> context_;
  std::vector<std::string> addresses_;  // where sockets are bound
  const bool polls_;
  std::atomic<int> calls_ = 0;  // under way
  std::atomic<bool> stopped_ = false;

 protected:
  std::vector<zmq::socket_t> binding_, connecting_;
};

}  // namespace maide::zeromq
