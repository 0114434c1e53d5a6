#include "name_server.hpp"

#include <fmt/format.h>
#include <yarp/os/Network.h>

#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <vector>

#include "maide/base/error.hpp"
#include "maide/base/file.hpp"
#include "maide/base/numbers.hpp"

namespace maide::yarp_ports {
namespace {

using yarp::os::NetworkBase;

// What a user's environment could change of what is learned.
void clean_environment() {
  for (const char* name : {"YARP_PORT_PREFIX", "YARP_CLOCK", "YARP_FORWARD_LOG_ENABLE"}) {
    ::unsetenv(name);
  }
  ::setenv("YARP_CONFIG_HOME", "/nonexistent", 1);
}

// Never taken down: ports that were left behind may outlive everything else.
void start_network() {
  static auto* const network = new yarp::os::Network(yarp::os::YARP_CLOCK_SYSTEM);
  static_cast<void>(network);
}

struct Address {
  std::string host;
  std::uint16_t port = 0;
};

Address parse_address(const std::string& text) {
  const std::size_t colon = text.rfind(':');
  Address address;
  if (colon != std::string::npos && colon > 0) {
    address.host = text.substr(0, colon);
    address.port = parse_number<std::uint16_t>(text.substr(colon + 1)).value_or(0);
  }
  if (address.port == 0) {
    throw UsageError(fmt::format("option server={}: it is none, own or HOST:PORT", text));
  }
  return address;
}

// YARP reads where its server is from a file of its configuration; here one that exists for a
// moment.
class Configuration {
 public:
  Configuration() { ::setenv("YARP_CONFIG_HOME", folder_.path().c_str(), 1); }

  void use(const Address& address) const {
    write_file_atomically(folder_.path() / "yarp.conf",
                          fmt::format("{} {} yarp\n", address.host, address.port));
    if (!NetworkBase::checkNetwork()) {
      throw std::runtime_error(
          fmt::format("no yarpserver answers at {}:{}", address.host, address.port));
    }
  }

 private:
  TempDir folder_{"maide-yarp-"};
};

// That of the YARP which Maide was built with; where it is gone, the one on PATH.
std::string server_program() {
#ifdef MAIDE_YARPSERVER
  if (std::filesystem::exists(MAIDE_YARPSERVER)) return MAIDE_YARPSERVER;
#endif
  return "yarpserver";
}

}  // namespace

NameServer::NameServer(const std::string& where) {
  clean_environment();
  if (where == "none") {
    start_network();
    NetworkBase::setLocalMode(true);
    // Makes the local table of names; ports that are opened at the same time would each make one.
    NetworkBase::queryName("/maide");
    return;
  }
  Address address;
  if (where != "own") address = parse_address(where);
  const Configuration configuration;
  start_network();
  if (where == "own") address = {"127.0.0.1", start_own()};
  configuration.use(address);
}

std::optional<pid_t> NameServer::process() const {
  if (!own_) return std::nullopt;
  return own_->id();
}

std::uint16_t NameServer::start_own() {
  constexpr std::chrono::seconds limit{50};
  const std::uint16_t port = free_loopback_port();
  own_ = std::make_unique<ServiceProcess>(std::vector<std::string>{
      server_program(), "--ip", "127.0.0.1", "--socket", std::to_string(port), "--portdb",
      ":memory:", "--subdb", ":memory:", "--local", "--silent"});
  own_->wait_for_tcp(port, limit);
  return port;
}

}  // namespace maide::yarp_ports
