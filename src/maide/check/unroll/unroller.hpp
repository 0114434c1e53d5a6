// Unrolling of a program's syntax tree into its automaton: each control state is expanded once,
// when it is first met, into the edges of the statement that it rests before. Walker says where
// control rests behind an edge, EdgeWriter writes edges down; those of `select` are SelectSteps',
// those of an executor's look LookSteps', those of code that spins SpinSteps'.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "maide/check/unroll/spin_steps.hpp"

namespace maide::program_syntax {

class Unroller : public SpinSteps {
 public:
  // Keeps references.
  Unroller(const Tree& tree, const Unrolled& program, ModelActions& actions, const Names& names,
           const RunControl& control)
      : SpinSteps(tree, program, actions, names, control),
        may_die_(program.may_die),
        nodes_(program.nodes) {}

  Program run();

 private:
  void expand(const Place place);
  void expand(const Place& place, const Statement& statement);
  // Keeps the guards of the `select` at the next control state.
  void note_guards(const Statement& statement);
  // Of a program whose process has a life.
  void expand_life(const Place& place, Program::State& state);
  // Where control is behind all of the text.
  ControlState out_of(const Place& place, Phase phase);
  void add_death(const Place& place);
  // Its process has died, and with it the program, wherever it is.
  void add_end_of_life(const Place& place);
  void add_begin_of_life();

  void expand_choice(const Place& place, const Statement& statement, const Values& values);
  void expand_any(const Place& place, const Statement& statement, const Values& values);
  void add_write(const Place& place, const Statement& statement, Value value, const Values& values);
  // One edge for each outcome of what is read.
  void expand_assign(const Place& place, const Statement& statement, const Values& values);
  void add_reading(const Statement& statement, const Conditions& conditions, ControlState target);
  void expand_condition(const Place& place, const Statement& statement, const Values& values);
  void expand_atomic(const Place& place, const Statement& statement, const Values& values);

  void expand_rendezvous(const Place& place, const Statement& statement, const Values& values);
  void expand_input(const Place& place, const Statement& statement, const Values& values,
                    std::uint32_t model);
  // A mutex that knows its holder, or the beginning of a wait at a condition.
  void expand_lock(const Place& place, const Statement& statement, const Values& values,
                   std::uint32_t model, const ModelUse& given);
  void expand_wait(const Place& place, const Statement& statement, const Values& values,
                   std::uint32_t condition);
  void expand_service(const Place& place, const Statement& statement, const Values& values,
                      std::uint32_t model);
  // Where the program waits for the return of what it gave there.
  ControlState in_call(const Place& place) {
    return control_state({place.frame, Phase::calls, 0, place.valuation, 0, 0});
  }
  // What ends the call of the statement, in which the program stands.
  void expand_call(const Place& place, const Statement& statement, const Values& values);
  void expand_arrival(const Place& place, const Statement& statement, const Values& values);
  void expand_end(const Place& place, const Statement& statement, const Values& values);
  // The other ends of a topic, for code at one of its ends: those that are met from the beginning,
  // and wires whose ends meet.
  struct Others {
    std::size_t met = 0;
    std::vector<const Wire*> wires;
    std::size_t count() const { return met + wires.size(); }
  };
  Others others_at(const Topic& topic, const Statement& statement) const;
  void expand_matched(const Place& place, const Statement& statement, const Values& values);
  void expand_withdraw(const Place& place, const Statement& statement, const Values& values);
  void expand_run(const Place& place, const Statement& statement, const Values& values);
  void expand_relock(const Place& place, const Statement& statement, const Values& values);
  void expand_kill(const Place& place, const Statement& statement, const Values& values);
  // "robot.work" of a `run` or `join`.
  std::string thread_of(const Statement& statement) const;

  bool may_die_ = false;
  std::vector<std::string> nodes_;  // whose callbacks it runs
  std::vector<Uses> deaths_;        // empty: not known yet
  std::map<const Statement*, std::uint32_t> guard_ids_;
};

}  // namespace maide::program_syntax
