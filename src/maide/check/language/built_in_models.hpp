// Models that a system file uses without a file: a mutex, a semaphore, a queue. They are written by
// hand, and verdicts say so.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>
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

// A queue whose states get their numbers as they are met, for one that has too many to make them
// all. A state is what the queue holds and what its reader waits for; what follows it is worked out
// when it is asked for.
class GrowingQueue {
 public:
  explicit GrowingQueue(QueueSize queue);

  // The names and the initial state, which nothing follows yet.
  InterfaceAutomaton start() const;
  // Adds to the automaton, which start() made, what follows `state`. Nothing the second time.
  void expand(InterfaceAutomaton& automaton, StateId state);
  // And what follows the messages that are due then.
  void expand_with_messages(InterfaceAutomaton& automaton, StateId state);
  // The automaton with those of its states that are marked, each expanded, and the messages due
  // behind them. All else is one state, in which no input was ever tried.
  InterfaceAutomaton cut_down(const InterfaceAutomaton& automaton,
                              const std::vector<bool>& reached) const;

 private:
  // What is kept, oldest first, and what the reader has: nothing, a read that waits, or the message
  // with that number.
  using Kept = std::pair<Word, Symbol>;
  static constexpr Symbol idle = ~Symbol{0}, waiting = idle - 1;

  StateId state_of(InterfaceAutomaton& automaton, Kept kept);
  bool is_due(StateId state) const { return met_[state].second < letters_; }

  QueueSize queue_;
  Symbol letters_ = 1;
  std::map<Kept, StateId> states_;
  std::vector<Kept> met_;
  std::vector<bool> is_expanded_;
};

}  // namespace maide
