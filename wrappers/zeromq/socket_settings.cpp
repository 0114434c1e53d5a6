#include "socket_settings.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "maide/base/error.hpp"

namespace maide::zeromq {
namespace {

constexpr std::int64_t most_messages = 1'000'000;
// zmq_send looks for what its peers said at most once in 3,000,000 ticks of the CPU's clock (4.3.4,
// socket_base.cpp): 1 ms at 3 GHz. This is enough down to 1 GHz.
constexpr std::int64_t throttle_ms = 3;

OptionSpec size_row() {
  OptionSpec row = common_options::size(3, 1000);
  row.least = 0;
  row.help += "; 0: no bound but the high-water marks";
  return row;
}

void check(const SocketSettings& settings, const OptionValues& options) {
  const bool one_way = settings.pattern != Pattern::req_rep;
  if (settings.conflate && !one_way) {
    throw UsageError("option conflate: it needs pattern=push-pull or pub-sub");
  }
  if (!settings.waits && !settings.pushes_back()) {
    throw UsageError("option sndtimeo: only a write of pattern=push-pull without conflate waits");
  }
  if (!settings.polls && options.is("quiescence", "observed") &&
      options.number("floor") < throttle_ms) {
    throw UsageError("option send: plain needs floor=" + std::to_string(throttle_ms) +
                     ", because zmq_send hears of its peers only about once a millisecond");
  }
  const bool has_more_ends = settings.writers > 1 || settings.readers > 1;
  if (!one_way && has_more_ends) {
    throw UsageError("options writers, readers: pattern=req-rep has one client and one server");
  }
  if (settings.pattern == Pattern::push_pull && settings.uses_tcp && settings.readers > 1) {
    throw UsageError(
        "option readers: over TCP a socket that pushes does not tell when all its readers are "
        "there; say transport=inproc");
  }
  if (!one_way) return;
  const auto size = static_cast<std::size_t>(options.number("size"));
  if (size == 0 && settings.capacity() == 0) {
    throw UsageError(
        "option size: nothing else bounds the messages in flight, so say size=N (with "
        "transport=inproc, small sndhwm and rcvhwm bound them too)");
  }
  const std::vector<std::string> inputs = options.list("inputs");
  const bool loses = std::find(inputs.begin(), inputs.end(), "disconnect") != inputs.end();
  const bool binds = size != 0 && (settings.capacity() == 0 || settings.capacity() > size);
  if (loses && binds) {
    throw UsageError(
        "option inputs: disconnect loses messages that size counts as in flight; with "
        "transport=inproc, small sndhwm and rcvhwm bound them without it (size=0)");
  }
}

}  // namespace

std::vector<OptionSpec> SocketSettings::options() {
  std::vector<OptionSpec> rows{
      OptionSpec::choice("pattern", "push-pull", {"push-pull", "pub-sub", "req-rep"},
                         "the types of the two sockets"),
      OptionSpec::choice("transport", "inproc", {"inproc", "tcp"},
                         "between the sockets; tcp: on the loopback device"),
      OptionSpec::integer("sndhwm", 1000, 0, most_messages,
                          "high-water mark of the writing socket, 0 for none; ZeroMQ's default")
          .keeping_more_with("+"),
      OptionSpec::integer("rcvhwm", 1000, 0, most_messages,
                          "high-water mark of the reading socket, 0 for none; ZeroMQ's default")
          .keeping_more_with("+"),
      OptionSpec::choice("conflate", "no", {"no", "yes"},
                         "the reading socket keeps the last message only")
          .keeping_more_with("no"),
      OptionSpec::choice("sndtimeo", "-1", {"-1", "0"},
                         "a write without room waits for ever (ZeroMQ's default), or fails"),
      OptionSpec::choice("send", "polled", {"polled", "plain"},
                         "polled: asks for ZMQ_EVENTS before zmq_send, as a program that polls; "
                         "plain: zmq_send alone"),
      common_options::inputs(
          {"write", "read", "tryread", "disconnect", "connect", "accept", "tryaccept", "answer"}),
      common_options::observe(
          {"message", "null", "written", "failed", "accepted", "none", "answered", "rejected"}),
      common_options::payload(),
      size_row(),
      common_options::at_bound(),
  };
  for (OptionSpec& row : common_options::ends()) rows.push_back(std::move(row));
  return rows;
}

SocketSettings SocketSettings::from(const OptionValues& options) {
  SocketSettings settings;
  if (options.is("pattern", "pub-sub")) settings.pattern = Pattern::pub_sub;
  if (options.is("pattern", "req-rep")) settings.pattern = Pattern::req_rep;
  settings.uses_tcp = options.is("transport", "tcp");
  settings.sndhwm = static_cast<int>(options.number("sndhwm"));
  settings.rcvhwm = static_cast<int>(options.number("rcvhwm"));
  settings.conflate = options.is("conflate", "yes");
  settings.waits = options.is("sndtimeo", "-1");
  settings.polls = options.is("send", "polled");
  settings.is_bounded = options.number("size") > 0;
  settings.writers = static_cast<std::size_t>(options.number("writers"));
  settings.readers = static_cast<std::size_t>(options.number("readers"));
  check(settings, options);
  return settings;
}

std::size_t SocketSettings::room() const {
  if (conflate) return 1;
  if (uses_tcp || sndhwm == 0 || rcvhwm == 0) return 0;
  return static_cast<std::size_t>(sndhwm) + static_cast<std::size_t>(rcvhwm);
}

std::size_t SocketSettings::capacity() const {
  const std::size_t pipes = writers * (pattern == Pattern::push_pull ? readers : 1);
  return room() == 0 ? 0 : pipes * room() + (pushes_back() && waits ? writers : 0);
}

}  // namespace maide::zeromq
