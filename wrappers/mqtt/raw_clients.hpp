// What one word is played on in the alphabet of the protocol: one or two clients that send packets
// of MQTT over TCP, and report the packets that come back. A thread receives for all of them; it
// acknowledges messages at once, as client libraries do.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <thread>

#include "broker.hpp"
#include "maide/base/file.hpp"
#include "maide/wire/wrapper/system_wrapper.hpp"
#include "packets.hpp"
#include "protocol_actions.hpp"

namespace maide::mqtt {

struct RawClientOptions {
  std::size_t clients = 1;  // 1 or 2
  int qos = 0;              // of subscriptions and wills
  bool clean_session = true;
  bool reconnects = true;  // a client whose connection has ended may connect again

  static std::vector<OptionSpec> options();
  static RawClientOptions from(const OptionValues& values);
};

SystemSetup protocol_setup(const RawClientOptions& options);

class RawClients : public SystemInstance {
 public:
  // `name`: of the topics and clients, such as no other client of the broker has.
  RawClients(const Broker& broker, std::string name, const RawClientOptions& options,
             EventSink& sink);
  ~RawClients() override;

  void call(std::string_view input) override;
  void shutdown() override {}  // no call waits for anything

 private:
  struct Client {
    Descriptor socket;
    std::string received;  // the beginning of a packet
    bool was_connected = false;
  };

  void open(std::size_t client);
  void send(Client& client, const std::string& bytes);
  std::string encode(const ProtocolAction& action) const;
  std::string encode_connection(const ProtocolAction& action) const;
  std::string topic(std::size_t number) const;
  std::string client_id(std::size_t client) const;

  void receive_all();
  void receive(std::size_t client);
  void handle(std::size_t client, const Packet& packet);
  void handle_publication(std::size_t client, const Packet& packet);
  void report(std::size_t client, std::string_view event);
  void clean_up();

  const Broker& broker_;
  const std::string name_;
  const RawClientOptions options_;
  EventSink& sink_;

  std::mutex mutex_;  // of the clients
  std::array<Client, 2> clients_;
  bool retained_ = false;  // something may be retained
  Descriptor poll_, stop_;
  std::thread receiver_;
};

}  // namespace maide::mqtt
