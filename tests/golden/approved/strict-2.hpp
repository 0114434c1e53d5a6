// A learned interface automaton.
#pragma once

#include <array>
#include <cstddef>

class strict_2 {
 public:
  enum class State : unsigned long { s0, s1, s2, s3, s4, s5 };
  enum class Input : unsigned long {
    write,
    read,
  };
  enum class Output : unsigned long {
    message,
  };
  // The names as the model has them, in the order of Input.
  static constexpr std::array<const char*, 2> input_names{"write", "read"};
  // The names as the model has them, in the order of Output.
  static constexpr std::array<const char*, 1> output_names{"message"};

  // What the model says of an input in the present state.
  enum class Answer {
    accepted,     // it is possible
    refused,      // the system does not take it here: it would wait
    never_tried,  // learning did not go that far: nothing is known
  };

  void reset() { state_ = initial; }
  State state() const { return state_; }

  Answer try_input(Input input) const {
    const long target = input_target(input);
    return target >= 0 ? Answer::accepted : target == -1 ? Answer::refused : Answer::never_tried;
  }
  bool can(Input input) const { return input_target(input) >= 0; }
  // Gives the input; false, and no change, if it is refused or was never tried.
  bool input(Input input) { return move(input_target(input)); }

  // The system may emit this output now.
  bool is_due(Output output) const { return output_target(output) >= 0; }
  // Takes the output; false, and no change, if it is not due.
  bool take(Output output) { return move(output_target(output)); }
  // No output is due: the system waits for an input.
  bool is_quiescent() const {
    for (const long target : output_targets[static_cast<std::size_t>(state_)]) {
      if (target >= 0) return false;
    }
    return true;
  }

 private:
  long input_target(Input input) const {
    return input_targets[static_cast<std::size_t>(state_)][static_cast<std::size_t>(input)];
  }
  long output_target(Output output) const {
    return output_targets[static_cast<std::size_t>(state_)][static_cast<std::size_t>(output)];
  }
  bool move(long target) {
    if (target < 0) return false;
    state_ = static_cast<State>(target);
    return true;
  }

  static constexpr State initial = State::s0;
  // The next state; -1: refused, -2: never tried.
  static constexpr std::array<std::array<long, 2>, 6> input_targets{{
      {{2, 1}},
      {{4, -1}},
      {{3, 4}},
      {{-2, 5}},
      {{-1, -1}},
      {{-1, -1}},
  }};
  static constexpr std::array<std::array<long, 1>, 6> output_targets{{
      {{-1}},
      {{-1}},
      {{-1}},
      {{-1}},
      {{0}},
      {{2}},
  }};
  State state_ = initial;
};
