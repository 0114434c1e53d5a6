// The options of the wrapper, in ZeroMQ's words (zmq_setsockopt(3)), and what they mean for a
// write.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "maide/wire/wrapper/wrapper_options.hpp"

namespace maide::zeromq {

enum class Pattern : std::uint8_t { push_pull, pub_sub, req_rep };

struct SocketSettings {
  Pattern pattern = Pattern::push_pull;
  bool uses_tcp = false;
  int sndhwm = 1000, rcvhwm = 1000;  // messages; 0: no limit
  bool conflate = false;             // the reader keeps the last message only
  bool waits = true;                 // a write without room waits (SNDTIMEO -1), else it fails
  bool polls = true;                 // before a send, look at the events of the socket
  bool is_bounded = true;            // by `size`: learned for at most so many messages in flight
  std::size_t writers = 1, readers = 1;

  static std::vector<OptionSpec> options();
  // Throws UsageError for combinations that make no sense.
  static SocketSettings from(const OptionValues& options);

  // The messages that lie between a writer and a reader at most, 0 for no limit. Within a process
  // both ends share one pipe, which holds the sum of their high-water marks; with TCP in between
  // the kernel's buffers hold an unknown number.
  std::size_t room() const;
  // Writes wait for room, or for a peer.
  bool pushes_back() const { return pattern == Pattern::push_pull && !conflate; }
  // How many messages can be in flight, to one reader or, pushed, to all, those in blocked writes
  // included; 0: no limit.
  std::size_t capacity() const;
};

}  // namespace maide::zeromq
