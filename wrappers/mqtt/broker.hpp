// The broker: mosquitto, started on a free port of the loopback with a configuration of its own, or
// one that runs already. It is never restarted between words: clients and topics with fresh names
// meet nothing that was there before, and take 0.1 ms instead of 5.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "maide/wire/client/child_process.hpp"
#include "maide/wire/wrapper/wrapper_options.hpp"

namespace maide::mqtt {

// How many messages mosquitto keeps for one client; 0: no limit.
struct BrokerLimits {
  std::int64_t max_inflight = 20;  // of QoS 1 and 2, sent and not acknowledged
  std::int64_t max_queued = 1000;  // beyond those
};

class Broker {
 public:
  // The rows of the wrapper's table that it looks at: broker, max-inflight, max-queued.
  static std::vector<OptionSpec> options();
  // Throws UsageError where they do not go together.
  static BrokerLimits limits(const OptionValues& options);

  // Throws std::runtime_error, in a few words, if mosquitto cannot be started.
  explicit Broker(const OptionValues& options);

  const std::string& host() const { return host_; }
  std::uint16_t port() const { return port_; }
  // What was started here; null for a broker that ran already.
  const ServiceProcess* process() const { return process_.get(); }

 private:
  void start(const BrokerLimits& limits);

  std::string host_ = "127.0.0.1";
  std::uint16_t port_ = 0;
  std::unique_ptr<ServiceProcess> process_;
};

// "2.0.11", as the program that would be started says; "" if there is none.
std::string mosquitto_version();

}  // namespace maide::mqtt
