#include "port_wrapper.hpp"

#include <algorithm>
#include <atomic>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "reference_port.hpp"

namespace maide::port {
namespace {

// A fresh connection from the actors that write to each one that reads.
class PortInstance : public SystemInstance {
 public:
  PortInstance(std::vector<std::unique_ptr<Connection>> connections, EventSink& sink)
      : connections_(std::move(connections)), sink_(sink) {}

  void call(std::string_view input) override {
    if (input == "write") {
      sink_.report(write(sink_.content(++written_)) ? "written" : "failed");
    } else if (input == "read") {
      if (const auto message = connections_[sink_.end()]->read()) sink_.message(*message);
    } else if (input == "tryread") {
      const std::optional<Message> message = connections_[sink_.end()]->try_read();
      message ? sink_.message(*message) : sink_.report("null");
    } else if (input == "interrupt") {
      for (const auto& connection : connections_) connection->interrupt();
      sink_.report("done");
    } else if (input == "resume") {
      for (const auto& connection : connections_) connection->resume();
      sink_.report("resumed");
    } else {
      throw std::logic_error("no input '" + std::string(input) + "'");
    }
  }

  void shutdown() override {
    for (const auto& connection : connections_) connection->close();
  }

 private:
  bool write(Message message) {
    return std::all_of(connections_.begin(), connections_.end(),
                       [&](const auto& connection) { return connection->write(message); });
  }

  const std::vector<std::unique_ptr<Connection>> connections_;  // by reader
  EventSink& sink_;
  std::atomic<Message> written_ = 0;
};

bool is_listed(const OptionValues& options, const char* key, const char* name) {
  const std::vector<std::string> listed = options.list(key);
  return std::find(listed.begin(), listed.end(), name) != listed.end();
}

// A third thread, which interrupts the writer. Only for those who ask for it.
void add_interrupt(SystemSetup& setup, const OptionValues& options) {
  setup.actors.emplace_back("writer_control");
  setup.inputs.push_back({"interrupt", "writer_control", {}});
  setup.inputs.push_back({"resume", "writer_control", {}});
  setup.inputs[0].returns.emplace_back("failed");
  setup.events.push_back({"failed", "writer"});
  setup.events.push_back({"done", "writer_control"});
  setup.events.push_back({"resumed", "writer_control"});
  // A write that failed put nothing into flight.
  if (is_listed(options, "observe", "failed")) setup.in_flight->receives.emplace_back("failed");
}

}  // namespace

PortWrapper::PortWrapper() {
  description_.name = "port";
  description_.summary = "the built-in reference port: two threads and a connection between them";
  description_.versions = {{"port", "1"}};
  description_.options = {
      OptionSpec::choice("kind", "port", {"port", "buffered", "strict"},
                         "a write waits for its read; keeps the newest message; keeps all")
          .keeping_more_with("strict"),
      common_options::inputs({"write", "read", "tryread", "interrupt", "resume"}),
      common_options::observe({"message", "written", "null", "failed", "done", "resumed"}),
      common_options::payload(),
      common_options::size(3, 1'000'000),
      common_options::at_bound(),
  };
  for (OptionSpec& row : common_options::ends()) description_.options.push_back(std::move(row));
}

SystemSetup PortWrapper::configure(const OptionValues& options) {
  kind_ = options.is("kind", "port")       ? Kind::port
          : options.is("kind", "buffered") ? Kind::buffered
                                           : Kind::strict;
  readers_ = static_cast<std::size_t>(options.number("readers"));
  SystemSetup setup;
  setup.actors = {"writer", "reader"};
  setup.inputs = {{"write", "writer", {"written"}},
                  {"read", "reader", {"message"}},
                  {"tryread", "reader", {"message", "null"}}};
  setup.events = {{"message", "reader"}, {"written", "writer"}, {"null", "reader"}};
  setup.in_flight.emplace();
  // The rendezvous and the newest-only buffer hold one message themselves: no bound is needed.
  setup.in_flight->capacity = kind_ == Kind::strict ? 0 : 1;
  if (is_listed(options, "inputs", "interrupt") || is_listed(options, "inputs", "resume")) {
    add_interrupt(setup, options);
  }
  return setup;
}

std::unique_ptr<SystemInstance> PortWrapper::reset(EventSink& sink) {
  std::vector<std::unique_ptr<Connection>> connections;
  for (std::size_t reader = 0; reader < readers_; ++reader) {
    if (kind_ == Kind::port) {
      connections.push_back(std::make_unique<Port>());
    } else {
      connections.push_back(std::make_unique<BufferedPort>(kind_ == Kind::strict));
    }
  }
  return std::make_unique<PortInstance>(std::move(connections), sink);
}

}  // namespace maide::port
