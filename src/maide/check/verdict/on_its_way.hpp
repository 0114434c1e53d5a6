// What was sent along a run, and what became of it: when it was sent, and when it arrived or was
// lost. What is still on its way at the end is what a late message explains.
//
// It is read off how many messages a wire, or a service for each of its clients, holds before and
// after each step. Messages keep their order on a wire.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "maide/check/system/system.hpp"
#include "maide/check/system/trace.hpp"

namespace maide {

struct SentMessage {
  enum class Kind : std::uint8_t { message, request, answer };
  Kind kind = Kind::message;
  std::uint32_t model = 0;   // the wire, or the service, that it was on
  std::uint32_t client = 0;  // of a request or an answer: its number at the service
  std::uint32_t to = 0;      // the model that it goes to
  std::size_t sent = 0;      // by this step of the trace
  // The step by which it arrived or was lost; none: it is on its way at the end.
  std::optional<std::size_t> ended{};
  bool is_lost = false;
};

// All that was sent and did not arrive by that, in the order of the models, then of the sending.
// `states` are replay()'s. O(steps x wires).
std::vector<SentMessage> find_sent(const System& system, const Trace& trace,
                                   const std::vector<GlobalState>& states);

// What is on its way at the end, in the order of the models. Three examples:
// - "a message from mapper to map, sent at step 1".
// - "2 messages from left to scan[log], the first sent at step 3".
// - "a request of robot to lookup, sent at step 2".
std::vector<std::string> find_on_its_way(const System& system, const Trace& trace,
                                         const std::vector<GlobalState>& states);

}  // namespace maide
