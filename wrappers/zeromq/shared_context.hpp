// A ZeroMQ context that the sockets of many words share.
#pragma once

#include <atomic>
#include <zmq.hpp>

namespace maide::zeromq {

class SharedContext {
 public:
  zmq::context_t& get() { return context_; }
  // Every call on one of its sockets, blocked or yet to come, ends with ETERM. From any thread.
  void shut_down() {
    is_shut_down_ = true;
    context_.shutdown();
  }
  bool is_shut_down() const { return is_shut_down_; }

 private:
  zmq::context_t context_{1};
  std::atomic<bool> is_shut_down_ = false;
};

}  // namespace maide::zeromq
