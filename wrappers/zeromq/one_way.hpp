// PUSH and PULL, or PUB and SUB: the actor `writer` calls zmq_send, `reader` zmq_recv. A reader's
// socket can be disconnected from the writers', and connected again.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "socket_pair.hpp"

namespace maide::zeromq {

class OneWay : public SocketPair {
 public:
  static SystemSetup setup(const SocketSettings& settings);

  // Returns once all ends know of each other. Throws std::runtime_error, zmq::error_t.
  OneWay(std::shared_ptr<SharedContext> context, const std::string& endpoint,
         const SocketSettings& settings, EventSink& sink);

 private:
  void make_call(std::string_view input) override;
  void wait_until_matched(Pattern pattern);
  void write();

  EventSink& sink_;
  std::atomic<std::uint64_t> written_ = 0;
  std::vector<char> connected_;  // by reader
};

}  // namespace maide::zeromq
