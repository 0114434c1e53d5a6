// Of two steps that commute only one order needs to be taken. A breadth-first search that visits
// every state still comes to most of them many times, by the same steps in every order. Parts of
// nobody count as more programs, the last ones. Behind a step of program P it leaves out each step
// of an earlier program that was possible before that step, too, and leads to the same state in the
// other order. These are sleep sets (Godefroid, "Using partial orders to improve automatic
// verification methods", CAV 1990) that remember one step.
//
// Invariant: transitions are left out, and never a state. Breadth-first no state is found at a
// greater depth. The idea of the proof: of all steps that lead to a state, one of the last program
// is never left out, for the order that was taken instead ends with a step of a later program
// (docs/design/reductions.md). A step that uses several models leaves out nothing behind it, and is
// itself never left out; nor is a step into an error, behind which nothing else comes.
//
// Example: program `a` takes one mutex, `b` another one. Behind the step of `b` that of `a` is left
// out: `a` and then `b` leads to the same state. Where both want one mutex nothing is left out.
#pragma once

#include <cstdint>
#include <vector>

#include "maide/check/packed/packed_system.hpp"

namespace maide {

class StepOrder {
 public:
  // What a step leaves out behind it.
  struct Last {
    std::uint64_t commuting = 0;  // actions of the model, by bit
    std::uint32_t model = no_model;
    std::uint32_t program = 0;
  };
  // Says of the initial state that nothing is left out.
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
    if (step.model != last.model) return !step.is_kept;
    return (last.commuting >> step.action & 1) != 0;
  }

 private:
  static constexpr std::uint32_t no_model = ~std::uint32_t{0};
  static constexpr std::uint32_t no_action = 63;  // or one of which nothing is known
  struct Step {
    std::uint32_t model = no_model - 1;  // of a choice: none
    std::uint32_t action = no_action;
    std::uint32_t first = first_state;  // in lasts_; of an action by the model's state
    bool is_kept = false;               // is never left out
  };

  void add_model(const PackedSystem& packed, std::uint32_t model,
                 const std::vector<ModelUse>& actions);

  std::vector<std::vector<Step>> steps_;  // by actor, by edge or action of nobody
  std::vector<Last> lasts_{Last{}};
};

}  // namespace maide
