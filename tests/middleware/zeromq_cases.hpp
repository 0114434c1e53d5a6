// Configurations of ZeroMQ's one-way patterns, and the model that each must have over write and
// tryread.
#pragma once

#include <ostream>
#include <string>
#include <vector>

#include "connection_models.hpp"
#include "wrapper_checks.hpp"

namespace maide::test {

struct ZeroMqCase {
  std::string name;
  SystemOptions options;
  ConnectionModel model;
  std::size_t states;  // of the minimal machine
};

inline void PrintTo(const ZeroMqCase& tested, std::ostream* out) { *out << tested.name; }

// Both high-water marks bound the one pipe within a process, and the reader tells the writer of
// every ((sum + 1) / 2)-th message that it took.
inline ZeroMqCase zeromq_pipe(std::string name, int sndhwm, int rcvhwm, WhenFull when_full,
                              std::size_t states) {
  const auto sum = static_cast<std::size_t>(sndhwm + rcvhwm);
  ZeroMqCase made{std::move(name),
                  {{"pattern", when_full == WhenFull::drop_newest ? "pub-sub" : "push-pull"},
                   {"sndhwm", std::to_string(sndhwm)},
                   {"rcvhwm", std::to_string(rcvhwm)},
                   {"size", "0"},
                   {"payload", "gap"},
                   {"inputs", "write,tryread"},
                   {"observe", "message,null"}},
                  {.capacity = sum, .when_full = when_full, .payload_gap = true},
                  states};
  made.model.credit_batch = (sum + 1) / 2;
  if (when_full != WhenFull::drop_newest) made.model.when_alone = WhenAlone::as_when_full;
  if (when_full == WhenFull::fail) {
    made.options["sndtimeo"] = "0";
    made.options["observe"] = "message,null,failed";
  }
  return made;
}

inline ZeroMqCase zeromq_conflated(std::string name, const std::string& pattern,
                                   std::size_t states) {
  const WhenFull dropping = WhenFull::drop_oldest;
  ZeroMqCase made = zeromq_pipe(std::move(name), 1, 1, dropping, states);
  made.options["pattern"] = pattern;
  made.options["conflate"] = "yes";
  made.model = {.capacity = 1, .when_full = dropping, .payload_gap = true};
  if (pattern == "push-pull") made.model.when_alone = WhenAlone::as_when_full;
  return made;
}

// The same with the reader's disconnect and connect.
inline ZeroMqCase reconnecting(ZeroMqCase base, std::size_t states) {
  base.name += "_reconnecting";
  base.options["inputs"] = "write,tryread,disconnect,connect";
  base.model.reconnects = true;
  base.states = states;
  return base;
}

inline std::vector<ZeroMqCase> zeromq_cases() {
  const ZeroMqCase push = zeromq_pipe("push_1_1", 1, 1, WhenFull::block, 4);
  const ZeroMqCase failing = zeromq_pipe("push_failing_1_1", 1, 1, WhenFull::fail, 3);
  const ZeroMqCase publish = zeromq_pipe("publish_1_1", 1, 1, WhenFull::drop_newest, 14);
  const ZeroMqCase push_last = zeromq_conflated("push_conflated", "push-pull", 3);
  const ZeroMqCase publish_last = zeromq_conflated("publish_conflated", "pub-sub", 3);
  return {push,
          zeromq_pipe("push_1_2", 1, 2, WhenFull::block, 9),
          zeromq_pipe("push_2_2", 2, 2, WhenFull::block, 11),
          failing,
          zeromq_pipe("push_failing_2_1", 2, 1, WhenFull::fail, 7),
          publish,
          zeromq_pipe("publish_1_2", 1, 2, WhenFull::drop_newest, 17),
          push_last,
          publish_last,
          reconnecting(push, 12),
          reconnecting(failing, 8),
          reconnecting(publish, 16),
          reconnecting(push_last, 8),
          reconnecting(publish_last, 6)};
}

}  // namespace maide::test
