// The port models of the paper's Table 1, written by hand from what the ports do: k messages kept,
// or a reader that waits. They are what learned models are compared with.
#pragma once

#include "maide/automata/interface_automaton.hpp"

namespace maide::test {

inline Action input(const InterfaceAutomaton& automaton, std::string_view name) {
  return {Action::Kind::input, automaton.inputs().at(name)};
}
inline Action output(const InterfaceAutomaton& automaton, std::string_view name) {
  return {Action::Kind::output, automaton.outputs().at(name)};
}

// A strict queue of at most `size` messages in flight; 2 size + 2 states, 3 size + 2 transitions
// (size + 1 more with tryread).
inline InterfaceAutomaton strict_port(StateId size, bool has_tryread = false) {
  std::vector<std::string> inputs{"write", "read"};
  if (has_tryread) inputs.emplace_back("tryread");
  InterfaceAutomaton port(Alphabet(inputs), {"message"}, 2 * size + 2);
  const StateId waiting = size + 1;                                // the reader waits
  const auto due = [&](StateId rest) { return size + 2 + rest; };  // a message is due
  for (StateId kept = 0; kept <= size; ++kept) {
    if (kept < size) port.add_transition(kept, input(port, "write"), kept + 1);
    if (kept == size) port.mark_unexplored(kept, port.inputs().at("write"));
    port.add_transition(kept, input(port, "read"), kept > 0 ? due(kept - 1) : waiting);
    if (has_tryread)
      port.add_transition(kept, input(port, "tryread"), kept > 0 ? due(kept - 1) : 0);
    if (kept < size) port.add_transition(due(kept), output(port, "message"), kept);
  }
  port.add_transition(waiting, input(port, "write"), due(0));
  port.actors = {
      {"writer", {"write"}, {}},
      {"reader",
       has_tryread ? std::vector<std::string>{"read", "tryread"} : std::vector<std::string>{"read"},
       {"message"}}};
  return port;
}

// A port whose write blocks until the read: 4 states, 5 transitions.
inline InterfaceAutomaton blocking_port() {
  InterfaceAutomaton port({"write", "read"}, {"message"}, 4);
  port.add_transition(0, input(port, "write"), 1);
  port.add_transition(0, input(port, "read"), 2);
  port.add_transition(1, input(port, "read"), 3);
  port.add_transition(2, input(port, "write"), 3);
  port.add_transition(3, output(port, "message"), 0);
  port.actors = {{"writer", {"write"}, {}}, {"reader", {"read"}, {"message"}}};
  port.hidden_returns = {"write"};
  return port;
}

// The same with `written` observed: after the meeting of write and read both outputs are due, in
// either order.
inline InterfaceAutomaton blocking_port_with_written() {
  InterfaceAutomaton port({"write", "read"}, {"written", "message"}, 6);
  port.add_transition(0, input(port, "write"), 1);
  port.add_transition(0, input(port, "read"), 2);
  port.add_transition(1, input(port, "read"), 3);
  port.add_transition(2, input(port, "write"), 3);
  port.add_transition(3, output(port, "message"), 4);
  port.add_transition(3, output(port, "written"), 5);
  port.add_transition(4, output(port, "written"), 0);
  port.add_transition(5, output(port, "message"), 0);
  port.actors = {{"writer", {"write"}, {"written"}}, {"reader", {"read"}, {"message"}}};
  return port;
}

// A buffer that keeps the newest message: 4 states, 6 transitions.
inline InterfaceAutomaton buffered_port() {
  InterfaceAutomaton port({"write", "read"}, {"message"}, 4);
  port.add_transition(0, input(port, "write"), 1);
  port.add_transition(1, input(port, "write"), 1);
  port.add_transition(2, input(port, "write"), 3);
  port.add_transition(0, input(port, "read"), 2);
  port.add_transition(1, input(port, "read"), 3);
  port.add_transition(3, output(port, "message"), 0);
  port.actors = {{"writer", {"write"}, {}}, {"reader", {"read"}, {"message"}}};
  return port;
}

}  // namespace maide::test
