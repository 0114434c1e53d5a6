// Of two steps that commute only one order needs to be taken. A breadth-first search that visits
// every state still comes to most of them many times, by the same steps in every order. It need
// not: behind a step of program P it leaves out each step of an earlier program that was possible
// before that step, too, and leads to the same state in the other order. These are sleep sets
// (Godefroid, "Using partial orders to improve automatic verification methods", CAV 1990) that
// remember one step: they leave out transitions, and never a state.
//
// No state is lost, nor found at a greater depth breadth-first. Take a state X and, among all last
// steps of shortest runs to it, one of the last program: of P, from s. It is left out at s only if
// s was found by a step of a later program, from p, that commutes with it; then P's step is
// possible at p, and X is reached from there by P's step first and the other one last. But that is
// of a later program than P. In any other search: were a step left out at s for ever, take such a
// one of the last program, and of those the one whose s was found first. P's step at p is none of
// them, for p was found before s; so the state behind it is visited, and X from there, by a later
// program.
#pragma once

#include <cstdint>
#include <vector>

#include "maide/check/packed_system.hpp"

namespace maide {

class StepOrder {
 public:
  // What a step leaves out behind it.
  struct Last {
    std::uint64_t commuting = 0;  // actions of the model, by bit
    std::uint32_t model = no_model;
    std::uint32_t program = 0;
  };
  // Of the initial state: nothing is left out.
  static constexpr std::uint32_t first_state = 0;

  // Leaves out nothing in a system of more than 64 programs. O(actions^2 x transitions) of each
  // model; a model of too many actions or states is taken to commute with nothing.
  explicit StepOrder(const PackedSystem& packed);

  // The index of what the step leaves out. `state`: before it.
  template <std::size_t words>
  std::uint32_t behind(const PackedSystem& packed, const PackedState<words>& state,
                       std::size_t program, std::uint32_t edge) const {
    const Step& step = steps_[program][edge];
    if (step.action == no_action) return step.first;
    return step.first + packed.model_state(state, step.model);
  }
  const Last& operator[](std::uint32_t index) const { return lasts_[index]; }

  // Whether that step, of a program before the last one, need not be taken.
  bool leaves_out(const Last& last, std::size_t program, std::uint32_t edge) const {
    const Step& step = steps_[program][edge];
    return step.model != last.model || (last.commuting >> step.action & 1) != 0;
  }

 private:
  static constexpr std::uint32_t no_model = ~std::uint32_t{0};
  static constexpr std::uint32_t no_action = 63;  // or one of which nothing is known
  struct Step {
    std::uint32_t model = no_model - 1;  // of a choice: none
    std::uint32_t action = no_action;
    std::uint32_t first = first_state;  // in lasts_; of an action by the model's state
  };

  void add_model(const System& system, std::uint32_t model,
                 const std::vector<ProgramEdge>& actions);

  std::vector<std::vector<Step>> steps_;  // by program, by edge
  std::vector<Last> lasts_{Last{}};
};

}  // namespace maide
