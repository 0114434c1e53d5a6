// The options of the wrapper that are words of ROS 1, and what they mean for a write.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "maide/wire/wrapper/wrapper_options.hpp"

namespace maide::ros1 {

enum class Transport : std::uint8_t { tcpros, intraprocess };

struct Queues {
  std::uint32_t publisher = 1, subscriber = 1;  // queue_size of each end; 0: no limit
  Transport transport = Transport::tcpros;
  bool latch = false;
  std::size_t burst = 10;  // messages that the input `burst` publishes
  std::size_t writers = 1, readers = 1;

  // The rows of the wrapper's table that these come from.
  static std::vector<OptionSpec> options();
  // Throws UsageError for combinations that make no sense.
  static Queues from(const OptionValues& options);
};

}  // namespace maide::ros1
