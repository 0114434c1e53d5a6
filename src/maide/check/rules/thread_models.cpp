#include "maide/check/rules/thread_models.hpp"

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace maide {

InterfaceAutomaton make_runs(std::uint32_t count) {
  std::vector<std::string> inputs;
  for (std::uint32_t run = 0; run < count; ++run) {
    inputs.push_back("start" + std::to_string(run + 1));
    inputs.push_back("end" + std::to_string(run + 1));
  }
  InterfaceAutomaton runs(Alphabet(std::span<const std::string>(inputs)), {},
                          std::size_t{1} << count);
  for (StateId set = 0; set < runs.size(); ++set) {
    std::uint32_t first = 0;
    while ((set >> first & 1) != 0) ++first;
    if (first < count) {
      runs.add_transition(set, {Action::Kind::input, 2 * first}, set | StateId{1} << first);
    }
    for (std::uint32_t run = 0; run < count; ++run) {
      if ((set >> run & 1) == 0) continue;
      runs.add_transition(set, {Action::Kind::input, 2 * run + 1}, set & ~(StateId{1} << run));
    }
  }
  return runs;
}

InterfaceAutomaton make_copies(std::uint32_t count, bool are_asked) {
  constexpr std::uint32_t idle = 0, asked = 1, runs = 2;
  std::vector<std::string> inputs{"run", "join"};
  std::vector<StateId> power{1};  // of 3, by copy
  for (std::uint32_t copy = 0; copy < count; ++copy) {
    inputs.push_back("begin" + std::to_string(copy + 1));
    inputs.push_back("end" + std::to_string(copy + 1));
    power.push_back(power.back() * 3);
  }
  InterfaceAutomaton copies(Alphabet(std::span<const std::string>(inputs)), {}, power.back());
  for (StateId state = 0; state < copies.size(); ++state) {
    const auto add = [&](CopyInput input, std::uint32_t copy, StateId target) {
      copies.add_transition(state, {Action::Kind::input, input_of_copy(input, copy)}, target);
    };
    bool has_idle = false;
    for (std::uint32_t copy = 0; copy < count; ++copy) {
      const std::uint32_t does = state / power[copy] % 3;
      if (does == idle && !has_idle) add(CopyInput::run, 0, state + power[copy] * (asked - idle));
      has_idle = has_idle || does == idle;
      if (does == asked) add(CopyInput::begin, copy, state + power[copy] * (runs - asked));
      if (does == runs) add(CopyInput::end, copy, state - power[copy] * (runs - idle));
    }
    if (state == 0) add(CopyInput::join, 0, state);
  }
  if (are_asked) copies.set_initial((power.back() - 1) / 2);
  return copies;
}

InterfaceAutomaton make_gate() {
  const std::vector<std::string> inputs{"open", "pass"};
  InterfaceAutomaton gate(Alphabet(std::span<const std::string>(inputs)), {}, 2);
  gate.add_transition(0, {Action::Kind::input, 0}, 1);
  gate.add_transition(1, {Action::Kind::input, 1}, 1);
  return gate;
}

}  // namespace maide
