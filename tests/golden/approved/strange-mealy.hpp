// A learned Mealy machine.
// sul: sim:strange.dot
// versions: 1 * / - - \ 2
#pragma once

#include <array>
#include <cstddef>

class strange_mealy {
 public:
  enum class State : unsigned long { s0, s1 };
  enum class Input : unsigned long {
    in_put,
    a___b,
    class_2,
    x_quoted_,
    zw_lf__,
  };
  enum class Output : unsigned long {
    quiet,
    written_message,
    mtype,
    MODULE,
  };
  // The names as the model has them, in the order of Input.
  static constexpr std::array<const char*, 5> input_names{"in put", "a / b", "class", "\"quoted\"",
                                                          "zw\303\266lf*/"};
  // The names as the model has them, in the order of Output.
  static constexpr std::array<const char*, 4> output_names{"quiet", "written,message", "mtype",
                                                           "MODULE"};

  void reset() { state_ = initial; }
  State state() const { return state_; }
  // Takes the input's transition and returns its output.
  Output step(Input input) {
    const Step& step = steps[static_cast<std::size_t>(state_)][static_cast<std::size_t>(input)];
    state_ = static_cast<State>(step.target);
    return static_cast<Output>(step.output);
  }

 private:
  struct Step {
    unsigned long target;
    unsigned long output;
  };
  static constexpr State initial = State::s1;
  static constexpr std::array<std::array<Step, 5>, 2> steps{{
      {{{1, 0}, {1, 1}, {1, 2}, {1, 3}, {1, 0}}},
      {{{0, 1}, {1, 2}, {0, 3}, {1, 0}, {0, 1}}},
  }};
  State state_ = initial;
};
