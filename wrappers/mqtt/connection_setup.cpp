#include "connection_setup.hpp"

#include <fmt/format.h>

#include <utility>

#include "maide/automata/interface_automaton.hpp"
#include "maide/base/error.hpp"
#include "maide/sul/learning_purpose.hpp"

namespace maide::mqtt {
namespace {

const std::vector<SystemSetup::Input>& all_inputs() {
  static const std::vector<SystemSetup::Input> inputs{
      {"write", "writer", {}},
      // Once it waits the connection stands: whoever could break it is the reader, who is busy.
      {"read", "reader", {"message"}},
      {"tryread", "reader", {}},
      {"disconnect", "reader", {}},
      {"drop", "reader", {}},
      {"connect", "reader", {}},
      {"writer_disconnect", "writer", {}},
      {"writer_drop", "writer", {}},
      {"writer_connect", "writer", {}},
  };
  return inputs;
}

const std::vector<SystemSetup::Event>& all_events() {
  static const std::vector<SystemSetup::Event> events{
      {"message", "reader"},          {"null", "reader"},
      {"offline", "reader"},          {"connected", "reader"},
      {"disconnected", "reader"},     {"will", "reader"},
      {"written", "writer"},          {"failed", "writer"},
      {"writer_connected", "writer"}, {"writer_disconnected", "writer"},
  };
  return events;
}

// How many messages the broker keeps for a reader; 0: no limit.
struct Capacity {
  std::size_t online, offline;
};

Capacity capacity_of(const ConnectionOptions& options, const BrokerLimits& limits) {
  // Of QoS 0 the sockets' buffers keep what they can.
  if (options.qos == 0 || limits.max_inflight == 0 || limits.max_queued == 0) return {0, 0};
  const auto queued = static_cast<std::size_t>(limits.max_queued);
  return {static_cast<std::size_t>(limits.max_inflight) + queued, queued};
}

// At most `options.size` messages in flight, in each state of the two connections. A count that is
// too high would leave words untried that the bound allows, so a message that the broker does not
// keep is not counted: one to a reader that is away, beyond what the broker queues, or of a
// session that ended.
class InFlightPurpose {
 public:
  InFlightPurpose(const ConnectionOptions& options, const BrokerLimits& limits, bool tells_gaps)
      : options_(options),
        capacity_(capacity_of(options, limits)),
        automaton_({"write", "disconnect", "drop", "connect", "writer_disconnect", "writer_drop",
                    "writer_connect"},
                   {}, 4 * (options.size + 1)) {
    for (std::size_t state = 0; state < automaton_.size(); ++state) {
      add_inputs(unpack(state));
      // What comes again, retained, was not in flight.
      const Place less = with_messages(unpack(state), -1);
      for (const char* message : {"message", "next", "gap"}) {
        const bool is_used = tells_gaps != (std::string_view(message) == "message");
        if (is_used) add(unpack(state), output(message), less);
      }
    }
    automaton_.set_initial(pack({true, true, 0}));
  }

  LearningPurpose make() const {
    return LearningPurpose(automaton_,
                           options_.absorbs_at_bound ? AtBound::absorb : AtBound::refuse);
  }

 private:
  struct Place {
    bool reader = true, writer = true;  // connected
    std::size_t messages = 0;
  };

  StateId pack(Place place) const {
    return static_cast<StateId>(4 * place.messages + (place.reader ? 0 : 2) +
                                (place.writer ? 0 : 1));
  }
  Place unpack(std::size_t state) const { return {(state & 2) == 0, (state & 1) == 0, state / 4}; }
  Action input(const char* name) const {
    return {Action::Kind::input, *automaton_.inputs().find(name)};
  }
  Action output(const char* name) { return {Action::Kind::output, automaton_.intern_output(name)}; }
  void add(Place from, Action action, Place to) {
    automaton_.add_transition(pack(from), action, pack(to));
  }
  static Place with_messages(Place place, int change) {
    if (change < 0 && place.messages == 0) return place;
    place.messages += static_cast<std::size_t>(change);  // wraps round where it is negative
    return place;
  }

  bool is_kept(Place place) const {
    if (!place.writer) return false;
    if (!place.reader && (options_.clean_session || options_.qos == 0)) return false;
    const std::size_t room = place.reader ? capacity_.online : capacity_.offline;
    return room == 0 || place.messages < room;
  }

  void add_inputs(Place place) {
    if (!is_kept(place)) {
      add(place, input("write"), place);
    } else if (place.messages < options_.size) {
      add(place, input("write"), with_messages(place, 1));
    }
    const bool forgets = options_.clean_session || options_.qos == 0;
    const Place away{false, place.writer, forgets ? 0 : place.messages};
    add(place, input("disconnect"), away);
    add(place, input("drop"), away);
    add(place, input("connect"), {true, place.writer, place.messages});
    add(place, input("writer_disconnect"), {place.reader, false, place.messages});
    add(place, input("writer_drop"), {place.reader, false, place.messages});
    add(place, input("writer_connect"), {place.reader, true, place.messages});
  }

  const ConnectionOptions& options_;
  const Capacity capacity_;
  InterfaceAutomaton automaton_;
};

}  // namespace

std::vector<OptionSpec> ConnectionOptions::options() {
  OptionSpec size = common_options::size(3, 1000);
  size.least = 0;
  size.help += "; 0: as many as the broker keeps (QoS 1 and 2)";
  std::vector<OptionSpec> rows{
      OptionSpec::choice("qos", "0", {"0", "1", "2"},
                         "quality of service of what is published and subscribed to: at most "
                         "once, at least once, exactly once")
          .keeping_more_with("1"),
      OptionSpec::choice("session", "clean", {"clean", "persistent"},
                         "whether the broker keeps subscriptions and messages for a reader (or a "
                         "raw client) that is away")
          .keeping_more_with("persistent"),
      OptionSpec::choice("retain", "no", {"no", "yes"},
                         "the broker keeps the last message for those that subscribe later"),
      OptionSpec::choice("will", "no", {"no", "yes"},
                         "the writer leaves a will: published when its connection breaks"),
      common_options::payload(),
      size,
      common_options::at_bound(),
  };
  for (OptionSpec& row : common_options::ends()) rows.push_back(std::move(row));
  return rows;
}

ConnectionOptions ConnectionOptions::from(const OptionValues& values, const BrokerLimits& limits) {
  ConnectionOptions options;
  options.qos = static_cast<int>(values.number("qos"));
  options.clean_session = values.is("session", "clean");
  options.retain = values.is("retain", "yes");
  options.will = values.is("will", "yes");
  options.size = static_cast<std::size_t>(values.number("size"));
  options.absorbs_at_bound = values.is("at-bound", "absorb");
  options.writers = static_cast<std::size_t>(values.number("writers"));
  options.readers = static_cast<std::size_t>(values.number("readers"));
  for (const std::string& input : values.list("inputs")) {
    if (options.writers == 1 || !input.starts_with("writer_")) continue;
    throw UsageError("option writers: with the input " + input + " there is one writer");
  }
  if (options.size == 0 && capacity_of(options, limits).online == 0) {
    throw UsageError(
        options.qos == 0
            ? "option qos: with QoS 0 nothing but the sockets bounds what is in flight; say size=N"
            : "options max-inflight, max-queued: without a limit of the broker's, say size=N");
  }
  return options;
}

std::vector<std::string> connection_inputs() {
  std::vector<std::string> names;
  for (const SystemSetup::Input& input : all_inputs()) names.push_back(input.name);
  return names;
}

std::vector<std::string> connection_events() {
  std::vector<std::string> names;
  for (const SystemSetup::Event& event : all_events()) names.push_back(event.name);
  return names;
}

SystemSetup connection_setup(const ConnectionOptions& options, const BrokerLimits& limits,
                             bool tells_gaps) {
  SystemSetup setup;
  setup.actors = {"writer", "reader"};
  setup.inputs = all_inputs();
  if (options.will) {
    for (SystemSetup::Input& input : setup.inputs) {
      if (input.name == "read") input.returns.push_back("will");
    }
  }
  setup.events = all_events();
  setup.usual_inputs = {"write", "read"};
  setup.usual_events = {"message"};
  // Of QoS 1, what was not acknowledged is sent again after a reconnection.
  setup.messages_come_again = options.retain || (options.qos == 1 && !options.clean_session);
  const std::size_t capacity = capacity_of(options, limits).online;
  if (options.size > 0 && (capacity == 0 || options.size < capacity)) {
    setup.purposes.push_back(InFlightPurpose(options, limits, tells_gaps).make());
    setup.bound =
        fmt::format("at most {} message{} in flight{}", options.size, options.size == 1 ? "" : "s",
                    options.readers > 1 ? " to each reader" : "");
  }
  return setup;
}

}  // namespace maide::mqtt
