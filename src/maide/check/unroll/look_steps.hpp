// The steps of an executor's thread that goes by rounds: it looks which callbacks have something,
// then starts those in turn.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "maide/check/unroll/select_steps.hpp"

namespace maide::program_syntax {

class LookSteps : public SelectSteps {
 public:
  using SelectSteps::SelectSteps;

 protected:
  void expand_rounds(const Place& place, const Statement& statement, const Values& values);

  // What a look may find, each by some ways: the arms' bits.
  struct Look {
    std::vector<Uses> ways;
    std::uint64_t found = 0;
    std::string text;  // "robot.tick, robot.on_scan"
  };
  // By a statement's arms that are callbacks, behind these ways; `only`: of those that no timer is,
  // this one is asked for alone.
  std::vector<Look> looks_behind(std::vector<Uses> passed, const Statement& statement,
                                 const Values& values, std::optional<std::size_t> only = {});
  // On fair runs each timer is due again and again, alone and together with others, and so is what
  // anybody may have sent, which a look may miss: the group of a look that finds these. 0: none.
  std::uint32_t fair_look(const Statement& statement, const Values& values, std::uint64_t found);
  // The look's step, in each of its ways, to that control state.
  void add_look(const Look& look, const std::string& if_nothing, const Statement& statement,
                const Values& values, ControlState target);
  // The arm's callback starts, of those that a look found, after others were passed over; then
  // control goes on at `next`. Returns how it is passed over itself; empty: never.
  std::vector<Uses> start_found(const Place& place, const SelectArm& arm, const Values& values,
                                const std::vector<Uses>& passed, bool discards, FrameId next);

  // Anybody may have sent something for the arm's callback; and he need not.
  bool may_be_missed(const SelectArm& arm, const Values& values);
  bool awaits_anybody(const SelectArm& arm, const Values& values);

 private:
  void expand_discard(const SelectArm& arm, const Values& values, const Uses& conditions,
                      FrameId next);
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
