// The alphabet of a connection: what the other wrappers have too - write, read, disconnect, connect
// - and what QoS, session, retained messages and wills of MQTT mean for it.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "broker.hpp"
#include "maide/wire/wrapper/system_wrapper.hpp"

namespace maide::mqtt {

struct ConnectionOptions {
  int qos = 0;
  bool clean_session = true;  // of the reader
  bool retain = false;        // of what is written
  bool will = false;          // of the writer
  std::size_t size = 0;       // messages in flight to learn for; 0: what the broker keeps
  bool absorbs_at_bound = false;
  std::size_t writers = 1, readers = 1;

  // The rows of the wrapper's table that these come from.
  static std::vector<OptionSpec> options();
  // Throws UsageError for combinations that make no sense.
  static ConnectionOptions from(const OptionValues& values, const BrokerLimits& limits);
};

std::vector<std::string> connection_inputs();
std::vector<std::string> connection_events();

// `tells_gaps`: messages are observed as next, gap and old.
SystemSetup connection_setup(const ConnectionOptions& options, const BrokerLimits& limits,
                             bool tells_gaps);

}  // namespace maide::mqtt
