// The steps of code that spins an executor by itself, and not for ever: it runs one callback, what
// one look finds, all that is there, or whatever comes until an answer was handed over.
#pragma once

#include <cstdint>

#include "maide/check/unroll/look_steps.hpp"

namespace maide::program_syntax {

class SpinSteps : public LookSteps {
 public:
  using LookSteps::LookSteps;

 protected:
  void expand_spin(const Place& place, const Statement& statement, const Values& values);
  void expand_refused_spin(const Statement& statement);

 private:
  // `once` and `until`: each callback that can start.
  void expand_callbacks(const Place& place, const Statement& statement, const Values& values);
  // `some` and `all`: what the look before has found, or that look.
  void expand_found(const Place& place, const Statement& statement, const Values& values);
  void expand_look(const Place& place, const Statement& statement, const Values& values);
};

}  // namespace maide::program_syntax
