// Models that a system file uses without a file: a mutex, a semaphore, a queue. They are written by
// hand, and verdicts say so.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "maide/automata/interface_automaton.hpp"

namespace maide {

// `lock`, possible when nobody holds it; `unlock`, by anybody, possible when somebody does. 2
// states.
InterfaceAutomaton make_mutex();

// `acquire` while something is there, at first `count`; `release` up to `count`. count + 1 states.
InterfaceAutomaton make_semaphore(std::uint32_t count);

struct QueueSize {
  std::uint32_t size = 1;     // at least 1
  bool drops_oldest = false;  // a write into a full queue; else it is not possible
  // What is written, each "(3)" or "(3,go)"; empty: messages without a value.
  std::vector<std::string> values;
};
inline constexpr std::uint64_t max_queue_states = 200'000;
// States that make_queue() makes: 2 size + 2 without values, else the words over them up to that
// length, twice and one more.
double queue_states(const QueueSize& queue);
// A strict port: `write`; a `read` of an empty queue is taken and waits; `message` comes.
// O(states).
InterfaceAutomaton make_queue(const QueueSize& queue);

}  // namespace maide
