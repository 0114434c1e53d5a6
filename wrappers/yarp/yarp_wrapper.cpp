#include "yarp_wrapper.hpp"

#include <fmt/format.h>
#include <unistd.h>
#include <yarp/conf/version.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "maide/base/error.hpp"
#include "yarp_connection.hpp"

namespace maide::yarp_ports {
namespace {

std::vector<SystemSetup::Input> all_inputs(Kind kind) {
  std::vector<SystemSetup::Input> inputs{
      {"write", "writer", {}},
      {"read", "reader", {"message"}},
      {"tryread", "reader", {}},
      {"write_2", "writer_2", {}},
      {"read_2", "reader_2", {"message_2"}},
      {"interrupt", "writer_control", {"done"}},
      {"resume", "writer_control", {"resumed"}},
      {"close", "writer_control", {"closed"}},
      {"destroy", "writer_control", {"destroyed"}},
      {"interrupt_reader", "reader_control", {"done_reader"}},
      {"resume_reader", "reader_control", {"resumed_reader"}},
      {"close_reader", "reader_control", {"closed_reader"}},
      {"disconnect", "network", {"disconnected", "denied"}},
      {"connect", "network", {"connected", "denied"}},
  };
  // A buffered write only waits to be strict: until the message before has arrived.
  if (kind != Kind::buffered) {
    inputs[0].returns = {"written"};
    inputs[3].returns = {"written_2"};
  }
  // A Port has no read that does not wait.
  if (kind == Kind::port) inputs.erase(inputs.begin() + 2);
  return inputs;
}

const std::vector<SystemSetup::Event>& all_events() {
  static const std::vector<SystemSetup::Event> events{
      {"message", "reader"},
      {"empty", "reader"},
      {"null", "reader"},
      {"written", "writer"},
      {"failed", "writer"},
      {"message_2", "reader_2"},
      {"null_2", "reader_2"},
      {"written_2", "writer_2"},
      {"failed_2", "writer_2"},
      {"done", "writer_control"},
      {"resumed", "writer_control"},
      {"closed", "writer_control"},
      {"destroyed", "writer_control"},
      {"done_reader", "reader_control"},
      {"resumed_reader", "reader_control"},
      {"closed_reader", "reader_control"},
      {"disconnected", "network"},
      {"connected", "network"},
      {"denied", "network"},
  };
  return events;
}

template <typename Named>
std::vector<std::string> names_of(const std::vector<Named>& all) {
  std::vector<std::string> names;
  for (const Named& one : all) names.push_back(one.name);
  return names;
}

// At most `most` times `input`, whatever comes between.
LearningPurpose at_most(std::int64_t most, const std::string& input) {
  InterfaceAutomaton counter(Alphabet({input}), Alphabet(), static_cast<std::size_t>(most) + 1);
  for (StateId count = 0; count < most; ++count) counter.add_transition(count, {}, count + 1);
  return LearningPurpose(std::move(counter));
}

// Each interrupt of a reader leaves something behind that its resume does not take away: a null to
// be read (buffered), a read that takes the next write (port). Without a bound the model is
// infinite.
void bound_interrupts(SystemSetup& setup, const OptionValues& options) {
  const std::vector<std::string> wanted = options.list("inputs");
  const auto is_wanted = [&](const char* input) {
    return std::find(wanted.begin(), wanted.end(), input) != wanted.end();
  };
  const std::int64_t most = options.number("interrupts");
  if (most == 0 || !is_wanted("interrupt_reader") || !is_wanted("resume_reader")) return;
  setup.purposes.push_back(at_most(most, "interrupt_reader"));
  setup.bound = fmt::format("at most {} interrupt{} of the reader", most, most == 1 ? "" : "s");
}

MessagesInFlight describe_flight(Kind kind, const std::string& carrier) {
  MessagesInFlight flight;
  flight.sends = {"write", "write_2"};
  flight.receives = {"message"};
  // The rendezvous and the newest-only buffer hold one message themselves: no bound is needed.
  const bool is_rendezvous = kind == Kind::port && carrier == "tcp";
  flight.capacity = is_rendezvous || kind == Kind::buffered ? 1 : 0;
  // What a Port receives over this carrier is always empty (3.9.1).
  if (kind == Kind::port && carrier == "local") flight.receives = {"empty"};
  return flight;
}

// What a call may return besides, once somebody interrupts, closes or disconnects.
void add_rare_returns(SystemSetup& setup, const std::string& carrier) {
  const bool is_disturbed = setup.actors.size() > 2;
  for (SystemSetup::Input& input : setup.inputs) {
    if (!input.returns.empty() && is_disturbed && input.name == "write") {
      input.returns.emplace_back("failed");
    } else if (!input.returns.empty() && is_disturbed && input.name == "write_2") {
      input.returns.emplace_back("failed_2");
    } else if (input.name == "read_2") {
      input.returns.emplace_back("null_2");
    } else if (input.name == "read") {
      if (is_disturbed) input.returns.emplace_back("null");
      if (is_disturbed || carrier == "local") input.returns.emplace_back("empty");
    }
  }
}

// These ask the server; one that is not the wrapper's own cannot be watched.
void check_server(const std::string& server, const OptionValues& options) {
  if (server == "none" || server == "own" || options.number("floor") > 0) return;
  for (const std::string& input : options.list("inputs")) {
    if (input == "connect" || input == "disconnect" || input == "destroy" ||
        input.starts_with("close")) {
      throw UsageError(fmt::format(
          "option server={}: input {} waits for the server, which is not observed; say floor=100",
          server, input));
    }
  }
}

// Only the actors whose inputs are asked for get a thread.
void select_actors(SystemSetup& setup, const std::vector<std::string>& wanted) {
  const auto is_wanted = [&](const std::string& actor) {
    return actor == "writer" || actor == "reader" ||
           std::any_of(setup.inputs.begin(), setup.inputs.end(), [&](const auto& input) {
             return input.actor == actor &&
                    std::find(wanted.begin(), wanted.end(), input.name) != wanted.end();
           });
  };
  for (const char* actor : {"writer", "reader", "writer_2", "reader_2", "writer_control",
                            "reader_control", "network"}) {
    if (is_wanted(actor)) setup.actors.emplace_back(actor);
  }
  const auto is_left_out = [&](const auto& of_actor) {
    return std::find(setup.actors.begin(), setup.actors.end(), of_actor.actor) ==
           setup.actors.end();
  };
  std::erase_if(setup.inputs, is_left_out);
  std::erase_if(setup.events, is_left_out);
}

}  // namespace

YarpWrapper::YarpWrapper() {
  description_.name = "yarp";
  description_.summary =
      "YARP: a port that writes and a port that reads, connected, in one process";
  description_.versions = {{"yarp", YARP_VERSION}, {"wrapper", "1"}};
  description_.options = {
      OptionSpec::choice("kind", "port", {"port", "buffered", "strict"},
                         "Port: a write waits for its read; BufferedPort: keeps the newest "
                         "message; BufferedPort, strict: keeps all")
          .keeping_more_with("strict"),
      OptionSpec::choice("carrier", "tcp", {"tcp", "fast_tcp", "udp", "local"},
                         "YARP's carrier of the connection"),
      OptionSpec::text("server", "none",
                       "name server: none (YARP's local mode), own (starts a yarpserver), or "
                       "HOST:PORT"),
      OptionSpec::integer("interrupts", 1, 0, 100,
                          "interrupts of the reader to try where it is resumed too (each leaves "
                          "something behind that a later call meets), 0: no bound"),
      common_options::inputs(names_of(all_inputs(Kind::strict))),
      common_options::observe(names_of(all_events())),
      common_options::payload(),
      common_options::size(3, 1000),
      common_options::at_bound(),
  };
}

SystemSetup YarpWrapper::configure(const OptionValues& options) {
  const Kind kind = options.is("kind", "port")       ? Kind::port
                    : options.is("kind", "buffered") ? Kind::buffered
                                                     : Kind::strict;
  const std::string& carrier = options.text("carrier");
  const std::string& server = options.text("server");
  check_server(server, options);
  server_ = std::make_unique<NameServer>(server);
  pairs_ = std::make_unique<PairStore>(kind, fmt::format("/maide/{}", ::getpid()), carrier);

  SystemSetup setup;
  if (const auto process = server_->process()) setup.processes.push_back(*process);
  setup.inputs = all_inputs(kind);
  setup.events = all_events();
  select_actors(setup, options.list("inputs"));
  add_rare_returns(setup, carrier);
  bound_interrupts(setup, options);
  setup.messages_come_again = true;
  setup.in_flight = describe_flight(kind, carrier);
  return setup;
}

std::unique_ptr<SystemInstance> YarpWrapper::reset(EventSink& sink) {
  return std::make_unique<YarpConnection>(*pairs_, server_->process().has_value(), sink);
}

}  // namespace maide::yarp_ports
