#include "port_wrapper.hpp"

#include <atomic>
#include <optional>
#include <stdexcept>
#include <string>

#include "reference_port.hpp"

namespace maide::port {
namespace {

// A fresh connection between an actor that writes and one that reads.
class PortInstance : public SystemInstance {
 public:
  PortInstance(std::unique_ptr<Connection> connection, EventSink& sink)
      : connection_(std::move(connection)), sink_(sink) {}

  void call(std::string_view input) override {
    if (input == "write") {
      if (connection_->write(++written_)) sink_.report("written");
    } else if (input == "read") {
      if (const auto message = connection_->read()) sink_.message(*message);
    } else if (input == "tryread") {
      const std::optional<Message> message = connection_->try_read();
      message ? sink_.message(*message) : sink_.report("null");
    } else {
      throw std::logic_error("no input '" + std::string(input) + "'");
    }
  }

  void shutdown() override { connection_->close(); }

 private:
  std::unique_ptr<Connection> connection_;
  EventSink& sink_;
  Message written_ = 0;  // only the writer's thread writes
};

}  // namespace

PortWrapper::PortWrapper() {
  description_.name = "port";
  description_.summary = "the built-in reference port: two threads and a connection between them";
  description_.versions = {{"port", "1"}};
  description_.options = {
      OptionSpec::choice("kind", "port", {"port", "buffered", "strict"},
                         "a write waits for its read; keeps the newest message; keeps all"),
      common_options::inputs({"write", "read", "tryread"}),
      common_options::observe({"message", "written", "null"}),
      common_options::payload(),
      common_options::size(3, 1'000'000),
      common_options::at_bound(),
  };
}

SystemSetup PortWrapper::configure(const OptionValues& options) {
  kind_ = options.is("kind", "port")       ? Kind::port
          : options.is("kind", "buffered") ? Kind::buffered
                                           : Kind::strict;
  SystemSetup setup;
  setup.actors = {"writer", "reader"};
  setup.inputs = {{"write", "writer", {"written"}},
                  {"read", "reader", {"message"}},
                  {"tryread", "reader", {"message", "null"}}};
  setup.events = {{"message", "reader"}, {"written", "writer"}, {"null", "reader"}};
  setup.in_flight.emplace();
  // The rendezvous and the newest-only buffer hold one message themselves: no bound is needed.
  setup.in_flight->capacity = kind_ == Kind::strict ? 0 : 1;
  return setup;
}

std::unique_ptr<SystemInstance> PortWrapper::reset(EventSink& sink) {
  if (kind_ == Kind::port) {
    return std::make_unique<PortInstance>(std::make_unique<Port>(), sink);
  }
  return std::make_unique<PortInstance>(std::make_unique<BufferedPort>(kind_ == Kind::strict),
                                        sink);
}

}  // namespace maide::port
