// Races of messages over ZeroMQ. pattern=push (to a PULL socket), or pub (to a SUB socket); each
// topic has sockets of its own. transport=inproc (within one process alone), ipc or tcp; a word of
// "lost" has no meaning here, for none of them loses.
#include <poll.h>

#include <cstring>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>
#include <zmq.hpp>

#include "delivery_race.hpp"
#include "maide/wire/client/child_process.hpp"

namespace maide::deliveries {
namespace {

std::string endpoint(const Settings& settings, Topic topic) {
  const std::string transport = settings.text("transport", "inproc");
  const std::string name = topic == Topic::map ? "map" : "notice";
  if (transport == "tcp") return "tcp://127.0.0.1:" + settings.text(name + "-port", "");
  // A name with '@' is of no file.
  const std::string sign = transport == "ipc" ? "@" : "";
  return transport + "://" + sign + "maide-" + name + settings.text("id", "");
}

zmq::socket_t make_socket(zmq::context_t& context, const Settings& settings, bool is_writer) {
  const bool publishes = settings.is("pattern", "pub", "push");
  zmq::socket_t socket(context, is_writer
                                    ? publishes ? zmq::socket_type::pub : zmq::socket_type::push
                                : publishes ? zmq::socket_type::sub
                                            : zmq::socket_type::pull);
  socket.set(zmq::sockopt::linger, 0);
  return socket;
}

class ZeroMqWriter : public Writer {
 public:
  ZeroMqWriter(zmq::context_t& context, const Settings& settings) {
    for (const Topic topic : both_topics) {
      sockets_.push_back(make_socket(context, settings, true));
      sockets_.back().connect(endpoint(settings, topic));
    }
  }
  void write(Topic topic, std::uint32_t number, std::size_t size) override {
    zmq::message_t message(size);
    std::memcpy(message.data(), &number, sizeof(number));
    sockets_[static_cast<std::size_t>(topic)].send(message, zmq::send_flags::none);
  }

 private:
  std::vector<zmq::socket_t> sockets_;
};

class ZeroMqReader : public Reader {
 public:
  ZeroMqReader(zmq::context_t& context, const Settings& settings) {
    for (const Topic topic : both_topics) {
      sockets_.push_back(make_socket(context, settings, false));
      if (settings.is("pattern", "pub", "push")) {
        sockets_.back().set(zmq::sockopt::subscribe, "");
      }
      sockets_.back().bind(endpoint(settings, topic));
    }
  }
  std::optional<std::uint32_t> take(Topic topic) override {
    std::optional<std::uint32_t> newest;
    zmq::message_t message;
    while (sockets_[static_cast<std::size_t>(topic)].recv(message, zmq::recv_flags::dontwait)) {
      newest.emplace();
      std::memcpy(&*newest, message.data(), sizeof(*newest));
    }
    return newest;
  }
  Found look(std::chrono::milliseconds limit) override {
    std::vector<zmq::pollitem_t> items;
    for (zmq::socket_t& socket : sockets_) items.push_back({socket.handle(), 0, ZMQ_POLLIN, 0});
    zmq::poll(items, limit);
    return {items.front().revents != 0, items.back().revents != 0};
  }

 private:
  std::vector<zmq::socket_t> sockets_;
};

class ZeroMq : public Middleware {
 public:
  explicit ZeroMq(const Settings& settings) : settings_(settings) {}
  std::unique_ptr<Writer> make_writer() override {
    return std::make_unique<ZeroMqWriter>(context_, settings_);
  }
  std::unique_ptr<Reader> make_reader() override {
    return std::make_unique<ZeroMqReader>(context_, settings_);
  }

 private:
  const Settings settings_;
  zmq::context_t context_;
};

}  // namespace
}  // namespace maide::deliveries

int main(int count, char** words) {
  using namespace maide::deliveries;
  const auto prepare = [](Settings& settings) {
    for (const char* const port : {"map-port", "notice-port"}) {
      settings.add(port, std::to_string(maide::free_loopback_port()));
    }
  };
  return run(count, words, {prepare, [](const Settings& settings) {
                              return std::make_unique<ZeroMq>(settings);
                            }});
}
