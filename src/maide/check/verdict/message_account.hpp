// What became of the messages that a model was given along a run: which came out, which were lost,
// how many the model still holds.
//
// A learned model says nothing of queues, so this is read off the automaton. What a state holds is
// the number of awaited outputs that can be had from it by asking alone (by reads, say). An input
// is a message if giving it can raise that number. One that does not raise it lost a message: a new
// one was dropped, or an old one overwritten.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "maide/check/system/system.hpp"
#include "maide/check/system/trace.hpp"

namespace maide {

struct MessageAccount {
  // What one message's loss looks like.
  struct Loss {
    std::size_t step = 0;   // index into the trace
    std::size_t given = 0;  // messages given so far, this one included
    std::size_t taken = 0;  // taken out so far
    std::size_t held = 0;   // before the step
    std::size_t count = 1;  // messages lost in it
    // Outputs that tell that a message is missing show which one it was.
    enum class Which : std::uint8_t { unknown, oldest, newest };
    Which which = Which::unknown;
  };
  std::size_t given = 0;           // by inputs that are messages
  std::size_t taken = 0;           // outputs that brought one
  std::size_t held = 0;            // in the end
  std::vector<Loss> losses;        // in the order of the run
  std::set<std::uint32_t> givers;  // programs that gave messages
  std::set<std::uint32_t> takers;  // programs that took them
  std::vector<Symbol> messages;    // the inputs that are messages
  std::size_t lost() const;
};

// Whether an output of that name brings a message, and is no answer of another kind.
bool is_message_name(const std::string& output);

// What a program awaits of an instance: outputs, and the inputs that ask for them.
struct Awaited {
  std::uint32_t model = 0;
  std::vector<Symbol> outputs;  // ascending
  std::vector<Symbol> asking;   // ascending
};

// What the program awaits in this state, by a statement that takes outputs; nothing otherwise. The
// inputs that ask are those of the actor that has these outputs, or, where the model does not name
// its actors, those after which some program takes one of them.
std::optional<Awaited> find_awaited(const System& system, const Program& program,
                                    ControlState state);

// How many of the awaited outputs can be had from each state by asking alone; none where there is
// no most. O(states x transitions).
std::vector<std::optional<std::size_t>> count_obtainable(const InterfaceAutomaton& automaton,
                                                         const Awaited& awaited);

// The messages that the model holds in that state, as outputs, in the order in which they come if
// one asks; none where it is not known, or no output brings a message.
// O(edges + states x transitions).
std::optional<std::vector<Symbol>> find_held(const System& system, std::uint32_t model,
                                             StateId state);

// How many messages each state of the model holds; where that is not known more than there are
// states. O(edges + states x transitions).
std::vector<std::uint32_t> count_held(const System& system, std::uint32_t model);

// The account of the run so far; nothing where the model holds no countable messages. `states` are
// replay()'s. O(steps + states x transitions).
std::optional<MessageAccount> take_account(const System& system, const Trace& trace,
                                           const std::vector<GlobalState>& states,
                                           const Awaited& awaited);

// The account of each instance that lost messages which some program takes. `states` are
// replay()'s. In the order of the system. O(instances x steps + states x transitions).
std::map<std::uint32_t, MessageAccount> find_losses(const System& system, const Trace& trace,
                                                    const std::vector<GlobalState>& states);

}  // namespace maide
