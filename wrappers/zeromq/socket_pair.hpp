// Two connected sockets, and how to get their blocked calls back: what both kinds of instances are
// made of. The first socket binds, the second connects.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
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
  // Makes both sockets with their high-water marks; nothing is bound or connected yet.
  SocketPair(std::shared_ptr<SharedContext> context, zmq::socket_type binding,
             zmq::socket_type connecting, const SocketSettings& settings);

  // Binds one to `endpoint`, connects the other. What is sent may still find no peer.
  void join(const std::string& endpoint);
  // Where the first is bound.
  const std::string& address() const { return address_; }

  virtual void make_call(std::string_view input) = 0;

  // Sends a message that carries `number`; false if the socket would have to wait and was told not
  // to. Throws zmq::error_t.
  bool send(zmq::socket_t& socket, std::uint64_t number) const;
  // The number of the next message; nothing if there is none and it must not wait.
  static std::optional<std::uint64_t> receive(zmq::socket_t& socket, bool waits);

 private:
  // Before the sockets: they are closed first.
  std::shared_ptr<SharedContext> context_;
  std::string address_;
  const bool polls_;
  std::atomic<int> calls_ = 0;  // under way
  std::atomic<bool> stopped_ = false;

 protected:
  zmq::socket_t binding_, connecting_;
};

}  // namespace maide::zeromq
