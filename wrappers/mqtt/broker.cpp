#include "broker.hpp"

#include <fmt/format.h>
#include <sys/mman.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <stdexcept>
#include <string_view>
#include <system_error>

#include "maide/base/error.hpp"
#include "maide/base/file.hpp"
#include "maide/base/numbers.hpp"
#include "maide/base/subprocess.hpp"
#include "maide/base/text.hpp"
#include "maide/wire/protocol/tcp.hpp"

namespace maide::mqtt {
namespace {

using namespace std::chrono_literals;

constexpr auto start_limit = 50s;
// Another program may take the port between our asking for it and mosquitto's listening.
constexpr int most_attempts = 5;

// Debian puts it where a user's PATH does not lead.
std::string find_mosquitto() {
  std::string path = "/usr/local/sbin:/usr/sbin";
  if (const char* set = std::getenv("PATH")) path = std::string(set) + ":" + path;
  for (const std::string_view folder : split(path, ':')) {
    std::string program = std::string(folder) + "/mosquitto";
    if (!folder.empty() && ::access(program.c_str(), X_OK) == 0) return program;
  }
  return "";
}

// Nothing is kept on disk, and no topic of its own changes while a word is played. Without
// set_tcp_nodelay the second of two small packets waits for the acknowledgement of the first. As
// root it would become another user, after which it would outlive us and could not be observed.
std::string configuration(std::uint16_t port, const BrokerLimits& limits) {
  return fmt::format(
      "listener {} 127.0.0.1\n"
      "allow_anonymous true\n"
      "persistence false\n"
      "set_tcp_nodelay true\n"
      "sys_interval 0\n"
      "log_dest stderr\n"
      "log_type error\n"
      "{}"
      "max_inflight_messages {}\n"
      "max_queued_messages {}\n",
      port, ::geteuid() == 0 ? "user root\n" : "", limits.max_inflight, limits.max_queued);
}

// A file without a name: nothing is left behind, however we end.
Descriptor memory_file(const std::string& text) {
  Descriptor file(::memfd_create("mosquitto.conf", MFD_CLOEXEC));
  if (!file.is_open() ||
      ::write(file.get(), text.data(), text.size()) != static_cast<ssize_t>(text.size())) {
    throw std::system_error(errno, std::generic_category(), "no memory for the configuration");
  }
  return file;
}

std::uint16_t parse_port(const std::string& text) {
  const std::uint16_t port = parse_number<std::uint16_t>(text).value_or(0);
  if (port == 0) throw UsageError(fmt::format("option broker: '{}' is not a port", text));
  return port;
}

}  // namespace

std::vector<OptionSpec> Broker::options() {
  const BrokerLimits defaults;
  return {
      OptionSpec::text("broker", "",
                       "HOST:PORT of a broker that runs already; empty: mosquitto is started"),
      OptionSpec::integer("max-inflight", defaults.max_inflight, 0, 65'535,
                          "max_inflight_messages of mosquitto: sent to a client and not yet "
                          "acknowledged; 0: no limit"),
      OptionSpec::integer("max-queued", defaults.max_queued, 0, 1'000'000,
                          "max_queued_messages of mosquitto: kept for a client beyond those; 0: no "
                          "limit")
          .keeping_more_with("+"),
  };
}

BrokerLimits Broker::limits(const OptionValues& options) {
  BrokerLimits limits{options.number("max-inflight"), options.number("max-queued")};
  const BrokerLimits defaults;
  const bool are_set =
      limits.max_inflight != defaults.max_inflight || limits.max_queued != defaults.max_queued;
  if (are_set && !options.text("broker").empty()) {
    throw UsageError(
        "options max-inflight and max-queued: they configure a broker that is "
        "started here, not one that is given by broker=HOST:PORT");
  }
  return limits;
}

Broker::Broker(const OptionValues& options) {
  const BrokerLimits wanted = limits(options);
  if (options.text("broker").empty()) {
    start(wanted);
    return;
  }
  const tcp::Address address = tcp::parse_address(options.text("broker"));
  host_ = address.host;
  port_ = parse_port(address.port);
}

void Broker::start(const BrokerLimits& limits) {
  const std::string program = find_mosquitto();
  if (program.empty()) throw std::runtime_error("there is no mosquitto (Debian: mosquitto)");
  for (int attempt = 1;; ++attempt) {
    port_ = free_loopback_port();
    const Descriptor file = memory_file(configuration(port_, limits));
    process_ = std::make_unique<ServiceProcess>(std::vector<std::string>{
        program, "-c", fmt::format("/proc/{}/fd/{}", ::getpid(), file.get())});
    try {
      process_->wait_for_tcp(port_, start_limit);
      return;
    } catch (const std::runtime_error&) {
      if (attempt == most_attempts || !process_->has_ended()) throw;
    }
  }
}

std::string mosquitto_version() {
  const std::string program = find_mosquitto();
  if (program.empty()) return "";
  SubprocessOptions options;
  options.time_limit = start_limit;
  options.output_limit = 4096;
  const std::string_view before = "mosquitto version ";
  // One that is killed before it has said a word is asked again: a wrapper that is started anew
  // must be known by the same versions.
  for (int attempt = 0; attempt < most_attempts; ++attempt) {
    const std::string help = run_program({program, "-h"}, options, {}).out;
    if (!help.starts_with(before)) continue;
    return help.substr(before.size(), help.find_first_of(" \n", before.size()) - before.size());
  }
  return "";
}

}  // namespace maide::mqtt
