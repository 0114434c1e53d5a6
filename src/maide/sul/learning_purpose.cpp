#include "maide/sul/learning_purpose.hpp"

#include <algorithm>
#include <string_view>
#include <utility>

#include "maide/base/error.hpp"

namespace maide {

LearningPurpose::LearningPurpose(InterfaceAutomaton automaton, AtBound at_bound)
    : automaton_(std::move(automaton)), at_bound_(at_bound) {
  if (!automaton_.is_deterministic()) {
    throw UsageError("a learning purpose must be deterministic");
  }
}

LearningPurpose LearningPurpose::in_flight(std::size_t bound, std::size_t capacity,
                                           std::span<const std::string> sends,
                                           std::span<const std::string> receives,
                                           AtBound at_bound) {
  const bool saturates = capacity != 0 && capacity <= bound;
  const std::size_t most = saturates ? capacity : bound;
  InterfaceAutomaton counter(Alphabet(sends), Alphabet(receives), most + 1);
  for (StateId count = 0; count <= most; ++count) {
    for (Symbol send = 0; send < sends.size(); ++send) {
      if (count < most || saturates) {
        const auto next = static_cast<StateId>(std::min<std::size_t>(count + 1, most));
        counter.add_transition(count, {Action::Kind::input, send}, next);
      }
    }
    for (Symbol receive = 0; receive < receives.size(); ++receive) {
      if (count > 0) counter.add_transition(count, {Action::Kind::output, receive}, count - 1);
    }
  }
  return LearningPurpose(std::move(counter), at_bound);
}

bool LearningPurpose::Monitor::allows(std::string_view input) const {
  const InterfaceAutomaton& automaton = purpose_->automaton();
  const auto symbol = automaton.inputs().find(input);
  return !symbol || automaton.successor(state_, {Action::Kind::input, *symbol}) != Mealy::no_state;
}

void LearningPurpose::Monitor::on_input(std::string_view input) {
  const InterfaceAutomaton& automaton = purpose_->automaton();
  if (const auto symbol = automaton.inputs().find(input)) {
    const StateId next = automaton.successor(state_, {Action::Kind::input, *symbol});
    if (next != Mealy::no_state) state_ = next;
  }
}

void LearningPurpose::Monitor::on_output(std::string_view output) {
  const InterfaceAutomaton& automaton = purpose_->automaton();
  if (const auto symbol = automaton.outputs().find(output)) {
    const StateId next = automaton.successor(state_, {Action::Kind::output, *symbol});
    if (next != Mealy::no_state) state_ = next;
  }
}

}  // namespace maide
