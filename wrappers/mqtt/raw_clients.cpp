#include "raw_clients.hpp"

#include <fmt/format.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/epoll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <memory>
#include <stdexcept>
#include <system_error>
#include <utility>

namespace maide::mqtt {
namespace {

using Kind = ProtocolAction::Kind;

// The same each time: a packet sent again before its handshake has ended is a duplicate, and there
// are finitely many states.
constexpr std::uint16_t qos1_id = 1, qos2_id = 2, subscribe_id = 3;

[[noreturn]] void fail(const char* what) {
  throw std::system_error(errno, std::generic_category(), what);
}

Descriptor checked(int descriptor, const char* what) {
  if (descriptor < 0) fail(what);
  return Descriptor(descriptor);
}

Descriptor connect_to(const Broker& broker) {
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  const std::string port = std::to_string(broker.port());
  if (const int error = ::getaddrinfo(broker.host().c_str(), port.c_str(), &hints, &found)) {
    throw std::runtime_error(fmt::format("{}: {}", broker.host(), ::gai_strerror(error)));
  }
  const std::unique_ptr<addrinfo, void (*)(addrinfo*)> addresses(found, ::freeaddrinfo);
  for (const addrinfo* address = found; address != nullptr; address = address->ai_next) {
    Descriptor socket(::socket(address->ai_family, SOCK_STREAM | SOCK_CLOEXEC, 0));
    if (!socket.is_open() || ::connect(socket.get(), address->ai_addr, address->ai_addrlen) != 0) {
      continue;
    }
    const int yes = 1;
    ::setsockopt(socket.get(), IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
    return socket;
  }
  fail("no connection to the broker");
}

}  // namespace

std::vector<OptionSpec> RawClientOptions::options() {
  return {
      OptionSpec::choice("clients", "1", {"1", "2"},
                         "raw clients (alphabet=protocol); names of the second begin with c2_"),
      OptionSpec::choice("reconnect", "yes", {"yes", "no"},
                         "whether a raw client whose connection has ended may connect again"),
  };
}

RawClientOptions RawClientOptions::from(const OptionValues& values) {
  RawClientOptions options;
  options.clients = static_cast<std::size_t>(values.number("clients"));
  options.qos = static_cast<int>(values.number("qos"));
  options.clean_session = values.is("session", "clean");
  options.reconnects = values.is("reconnect", "yes");
  return options;
}

SystemSetup protocol_setup(const RawClientOptions& options) {
  SystemSetup setup;
  for (std::size_t client = 0; client < options.clients; ++client) {
    const std::string prefix = client_prefix(client);
    const std::string actor = prefix.empty() ? "client" : prefix + "client";
    setup.actors.push_back(actor);
    for (const ProtocolAction& action : protocol_actions()) {
      if (action.client == client) setup.inputs.push_back({action.name, actor, {}});
    }
    for (const std::string& event : protocol_events()) {
      setup.events.push_back({prefix + event, actor});
      setup.usual_events.push_back(prefix + event);
    }
    for (const char* input : {"connect", "disconnect", "drop", "publish_qos0", "publish_qos1",
                              "subscribe", "unsubscribe", "ping"}) {
      setup.usual_inputs.push_back(prefix + input);
    }
  }
  return setup;
}

RawClients::RawClients(const Broker& broker, std::string name, const RawClientOptions& options,
                       EventSink& sink)
    : broker_(broker),
      name_(std::move(name)),
      options_(options),
      sink_(sink),
      poll_(checked(::epoll_create1(EPOLL_CLOEXEC), "epoll_create")),
      stop_(checked(::eventfd(0, EFD_CLOEXEC), "eventfd")) {
  epoll_event event{};
  event.events = EPOLLIN;
  event.data.u64 = clients_.size();
  if (::epoll_ctl(poll_.get(), EPOLL_CTL_ADD, stop_.get(), &event) != 0) fail("epoll_ctl");
  receiver_ = std::thread([this] { receive_all(); });
}

RawClients::~RawClients() {
  ::eventfd_write(stop_.get(), 1);
  receiver_.join();
  try {
    clean_up();
  } catch (const std::exception&) {
    // The broker has gone: nothing to be cleaned.
  }
}

// What sessions and retained messages would leave behind in the broker for ever. A connection with
// a clean session ends the old one, and the client's connection, with its will.
void RawClients::clean_up() {
  const std::string goodbye = encode_empty(PacketType::disconnect);
  for (std::size_t client = 0; client < options_.clients; ++client) {
    send(clients_[client], goodbye);
    clients_[client].socket.reset();
    if (options_.clean_session || !clients_[client].was_connected) continue;
    Client forget{connect_to(broker_), "", true};
    send(forget, encode_connect(client_id(client), true, std::nullopt) + goodbye);
  }
  if (!retained_) return;
  Client eraser{connect_to(broker_), "", true};
  std::string packets = encode_connect(name_ + "eraser", true, std::nullopt);
  for (std::size_t number = 0; number < 2; ++number) {
    packets += encode_publish({topic(number), "", 0, true});
  }
  send(eraser, packets + goodbye);
  std::array<char, 64> bytes{};
  while (::read(eraser.socket.get(), bytes.data(), bytes.size()) > 0) {
  }
}

std::string RawClients::topic(std::size_t number) const {
  return name_ + (number == 0 ? "/a" : "/b");
}

std::string RawClients::client_id(std::size_t client) const {
  return name_ + (client == 0 ? "c1" : "c2");
}

std::string RawClients::encode_connection(const ProtocolAction& action) const {
  std::optional<Publication> will;
  if (action.kind != Kind::connect) {
    will = Publication{topic(0), "will", options_.qos, action.kind == Kind::connect_will_retain};
  }
  return encode_connect(client_id(action.client), options_.clean_session, will);
}

std::string RawClients::encode(const ProtocolAction& action) const {
  const std::string name = topic(action.topic);
  switch (action.kind) {
    case Kind::connect:
    case Kind::connect_will:
    case Kind::connect_will_retain: return encode_connection(action);
    case Kind::disconnect: return encode_empty(PacketType::disconnect);
    case Kind::ping: return encode_empty(PacketType::pingreq);
    case Kind::invalid: return encode_empty(PacketType::reserved);
    case Kind::publish_qos0: return encode_publish({name, "qos0", 0});
    case Kind::publish_qos1: return encode_publish({name, "qos1", 1, false, qos1_id});
    case Kind::publish_qos2: return encode_publish({name, "qos2", 2, false, qos2_id});
    case Kind::pubrel: return encode_acknowledgement(PacketType::pubrel, qos2_id);
    case Kind::publish_retained: return encode_publish({name, "retained", 1, true, qos1_id});
    case Kind::delete_retained: return encode_publish({name, "", 1, true, qos1_id});
    case Kind::subscribe: return encode_subscribe(name, options_.qos, subscribe_id);
    case Kind::unsubscribe: return encode_unsubscribe(name, subscribe_id);
    case Kind::drop: break;
  }
  return "";
}

void RawClients::call(std::string_view input) {
  const auto& actions = protocol_actions();
  const auto action =
      std::find_if(actions.begin(), actions.end(),
                   [&](const ProtocolAction& known) { return known.name == input; });
  if (action == actions.end()) throw std::logic_error(fmt::format("no input '{}'", input));
  const std::scoped_lock lock(mutex_);
  Client& client = clients_[action->client];
  if (action->kind == Kind::drop && client.socket.is_open()) {
    ::shutdown(client.socket.get(), SHUT_RDWR);  // the receiver sees the end, and says so
    return;
  }
  const bool may_open = !client.was_connected || options_.reconnects;
  if (action->kind == Kind::drop || (!client.socket.is_open() && !may_open)) {
    report(action->client, "closed");
    return;
  }
  // Whatever a client sends first, it needs a TCP connection for it.
  if (!client.socket.is_open()) open(action->client);
  client.was_connected |= action->kind <= Kind::connect_will_retain;
  retained_ |= action->kind == Kind::publish_retained || action->kind == Kind::connect_will_retain;
  send(client, encode(*action));
}

void RawClients::open(std::size_t client) {
  clients_[client].socket = connect_to(broker_);
  clients_[client].received.clear();
  epoll_event event{};
  event.events = EPOLLIN;
  event.data.u64 = client;
  if (::epoll_ctl(poll_.get(), EPOLL_CTL_ADD, clients_[client].socket.get(), &event) != 0) {
    fail("epoll_ctl");
  }
}

// If the broker has closed the connection the receiver sees that, and says so.
void RawClients::send(Client& client, const std::string& bytes) {
  if (!client.socket.is_open()) return;
  static_cast<void>(::send(client.socket.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL));
}

void RawClients::report(std::size_t client, std::string_view event) {
  sink_.report(client_prefix(client) + std::string(event));
}

void RawClients::receive_all() {
  while (true) {
    epoll_event event{};
    if (::epoll_wait(poll_.get(), &event, 1, -1) < 1) continue;
    if (event.data.u64 == clients_.size()) return;
    const std::scoped_lock lock(mutex_);
    try {
      receive(event.data.u64);
    } catch (const std::exception& error) {
      sink_.crashed(error.what());
      return;
    }
  }
}

void RawClients::receive(std::size_t number) {
  Client& client = clients_[number];
  if (!client.socket.is_open()) return;
  std::array<char, 4096> bytes{};
  const ssize_t size = ::recv(client.socket.get(), bytes.data(), bytes.size(), MSG_DONTWAIT);
  if (size < 0 && (errno == EAGAIN || errno == EINTR)) return;
  if (size <= 0) {
    // By hand: as long as somebody has a copy of the descriptor - a child between fork and exec -
    // closing ours does not take it out, and it would be reported without end.
    ::epoll_ctl(poll_.get(), EPOLL_CTL_DEL, client.socket.get(), nullptr);
    client.socket.reset();
    report(number, "closed");
    return;
  }
  client.received.append(bytes.data(), static_cast<std::size_t>(size));
  while (const std::optional<Packet> packet = take_packet(client.received)) {
    handle(number, *packet);
  }
}

void RawClients::handle(std::size_t client, const Packet& packet) {
  switch (packet.type) {
    case PacketType::connack: {
      const bool refused = byte_of(packet, 1) != 0;
      const bool has_session = (byte_of(packet, 0) & 1U) != 0;
      report(client, refused ? "connack_refused" : has_session ? "connack_present" : "connack");
      return;
    }
    case PacketType::publish: handle_publication(client, packet); return;
    case PacketType::pubrel:
      report(client, "pubrel");
      send(clients_[client], encode_acknowledgement(PacketType::pubcomp, id_of(packet)));
      return;
    case PacketType::puback: report(client, "puback"); return;
    case PacketType::pubrec: report(client, "pubrec"); return;
    case PacketType::pubcomp: report(client, "pubcomp"); return;
    case PacketType::suback: report(client, "suback"); return;
    case PacketType::unsuback: report(client, "unsuback"); return;
    case PacketType::pingresp: report(client, "pingresp"); return;
    default: break;
  }
  throw std::runtime_error(
      fmt::format("the broker sent a packet of type {}", static_cast<int>(packet.type)));
}

void RawClients::handle_publication(std::size_t client, const Packet& packet) {
  const Publication message = parse_publication(packet);
  const std::string payload = message.payload.empty() ? "empty" : message.payload;
  report(client, fmt::format("message_{}{}", payload, message.topic == topic(1) ? "_b" : ""));
  if (message.qos == 0) return;
  send(clients_[client],
       encode_acknowledgement(message.qos == 1 ? PacketType::puback : PacketType::pubrec,
                              message.id));
}

}  // namespace maide::mqtt
