#include "queues.hpp"

#include <algorithm>

#include "maide/base/error.hpp"

namespace maide::ros1 {
namespace {

OptionSpec own_queue_size(std::string key, const std::string& whose) {
  OptionSpec row =
      OptionSpec::choice(std::move(key), "same", {"same"}, "queue_size of the " + whose + " alone");
  row.least = 0;
  row.most = 1000;
  return row;
}

std::uint32_t own_or(const OptionValues& options, const char* key, std::int64_t both) {
  return static_cast<std::uint32_t>(options.is(key, "same") ? both : options.number(key));
}

// With these a message in flight is not one that was written and has not been read.
void check_can_count(const OptionValues& options) {
  const std::vector<std::string> inputs = options.list("inputs");
  for (const char* input : {"burst", "disconnect"}) {
    if (std::find(inputs.begin(), inputs.end(), input) == inputs.end()) continue;
    throw UsageError("option size: messages in flight cannot be counted with the input " +
                     std::string(input) + "; leave size out, with sub_queue_size=1 or more");
  }
}

}  // namespace

std::vector<OptionSpec> Queues::options() {
  return {
      OptionSpec::integer("queue_size", 1, 0, 1000,
                          "queue_size of the publisher and of the subscriber; 0: no limit")
          .keeping_more_with("+"),
      own_queue_size("pub_queue_size", "publisher"),
      own_queue_size("sub_queue_size", "subscriber"),
      OptionSpec::choice("latch", "false", {"false", "true"},
                         "the publisher keeps its last message for subscribers to come"),
      OptionSpec::choice("transport", "tcpros", {"tcpros", "intraprocess"},
                         "TCPROS over the loopback, or roscpp's shortcut within a process"),
      OptionSpec::integer("burst", 10, 1, 1000,
                          "messages that the input burst publishes back to back"),
  };
}

Queues Queues::from(const OptionValues& options) {
  Queues queues;
  const std::int64_t both = options.number("queue_size");
  queues.publisher = own_or(options, "pub_queue_size", both);
  queues.subscriber = own_or(options, "sub_queue_size", both);
  queues.latch = options.is("latch", "true");
  if (options.is("transport", "intraprocess")) queues.transport = Transport::intraprocess;
  queues.burst = static_cast<std::size_t>(options.number("burst"));
  queues.writers = static_cast<std::size_t>(options.number("writers"));
  queues.readers = static_cast<std::size_t>(options.number("readers"));

  const auto size = static_cast<std::size_t>(options.number("size"));
  if (queues.subscriber == 0 && size == 0) {
    throw UsageError(
        "option queue_size: 0 grows without limit, so say size=N (messages in flight to try)");
  }
  if (size > 0 && (queues.subscriber == 0 || queues.subscriber > size)) check_can_count(options);
  return queues;
}

}  // namespace maide::ros1
