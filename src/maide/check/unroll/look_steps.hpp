// The steps of an executor's thread that goes by rounds: it looks which callbacks have something,
// then starts those in turn.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "maide/check/unroll/select_steps.hpp"

namespace maide::program_syntax {

class LookSteps : public SelectSteps {
 public:
  using SelectSteps::SelectSteps;

 protected:
  void expand_rounds(const Place& place, const Statement& statement, const Values& values);

 private:
  void expand_discard(const Place& place, const SelectArm& arm, const Values& values,
                      const Uses& conditions);
  // Nothing is there for the arm's callback.
  std::vector<Uses> nothing_for(const SelectArm& arm, const Values& values);
  // What stands behind `when` at the arm's callback holds, or does not; each in some ways. Where it
  // is an error, after these were passed over, that is a step.
  std::pair<std::vector<Uses>, std::vector<Uses>> may_start(const SelectArm& arm,
                                                            const Values& values,
                                                            const std::vector<Uses>& passed);
  // Something is there for the arm's callback, or nothing is; each in some ways.
  std::pair<std::vector<Uses>, std::vector<Uses>> asked(const SelectArm& arm, const Values& values);
  // In which order a look asks for the arms, one in a step: as rmw_fastrtps does, where something
  // may be on its way. Empty: it asks for all in one step.
  std::vector<std::size_t> order_of_look(const Statement& statement, const Values& values) const;
  // The look has found these, and asked for so many.
  void go_on_looking(const Place& place, const Statement& statement, const Values& values,
                     std::uint64_t found, std::size_t asked_so_far);
};

}  // namespace maide::program_syntax
