#include "maide/workflow/paper_interrupt.hpp"

#include <array>
#include <span>

namespace maide {
namespace {

struct Answer {
  const char* output;
  StateId target;
};
// What a state answers to write, read and interrupt.
using Row = std::array<Answer, 3>;

// States 0 to 3 are the same in both machines: idle, a write waits, a read waits, interrupted.
constexpr Row idle{{{"quiet", 1}, {"quiet", 2}, {"done", 3}}};
constexpr Row reading{{{"written,message", 0}, {"refused", 2}, {"done", 4}}};
constexpr Row interrupted{{{"failed", 3}, {"quiet", 4}, {"done", 3}}};
constexpr Row interrupted_and_reading{{{"failed", 4}, {"refused", 4}, {"done", 4}}};

Mealy make_machine(std::span<const Row> rows) {
  Mealy machine(Alphabet({"write", "read", "interrupt"}), Alphabet(), rows.size());
  for (StateId state = 0; state < rows.size(); ++state) {
    for (Symbol input = 0; input < rows[state].size(); ++input) {
      const Answer& answer = rows[state][input];
      machine.set_transition(state, input, machine.intern_output(answer.output), answer.target);
    }
  }
  machine.actors = {{"writer", {"write"}, {"written", "failed"}},
                    {"reader", {"read"}, {"message"}},
                    {"writer_control", {"interrupt"}, {"done"}}};
  return machine;
}

}  // namespace

Mealy expected_interrupt_model() {
  constexpr Row writing{{{"refused", 1}, {"written,message", 0}, {"failed,done", 3}}};
  return make_machine(
      std::array<Row, 5>{idle, writing, reading, interrupted, interrupted_and_reading});
}

Mealy paper_interrupt_model() {
  constexpr Row writing{{{"refused", 1}, {"written,message", 0}, {"quiet", 5}}};
  constexpr Row both_wait{{{"refused", 5}, {"written,message,done", 3}, {"refused", 5}}};
  return make_machine(
      std::array<Row, 6>{idle, writing, reading, interrupted, interrupted_and_reading, both_wait});
}

std::map<std::string, std::string> interrupt_options() {
  return {{"kind", "port"},
          {"inputs", "write,read,interrupt"},
          {"observe", "message,written,failed,done"}};
}

std::vector<std::string> interrupt_systems() { return {"yarp", "port"}; }

}  // namespace maide
