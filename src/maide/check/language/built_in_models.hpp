// Models that a system file uses without a file: a mutex, a semaphore, a queue. They are written by
// hand, and verdicts say so. And what becomes of a model that stands for one reader of a topic.
#pragma once

#include <cstdint>
#include <optional>
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

// The model of one reader of a topic: outputs of the actor "writer" are collected in the step in
// which they come due, and stay until the writer takes them from all readers' models; until then it
// gives nothing else. Throws UsageError if the model does not name its actors.
struct CollectedModel {
  InterfaceAutomaton automaton;
  std::vector<std::optional<Symbol>> collected;  // by state
  std::vector<StateId> cleared;                  // by state: behind the taking
};
CollectedModel collect_writes(const InterfaceAutomaton& model);
// Whether the actor "writer" has that input or output, which stands without values.
bool is_of_writer(const InterfaceAutomaton& model, const std::string& name);

}  // namespace maide
