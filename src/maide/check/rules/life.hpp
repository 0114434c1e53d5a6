// The life of a process of which programs begin anew, or of which several end at once. Its death is
// one step, of nobody, of who kills it, or of the process itself. Then its programs end, one after
// the other, and where it begins anew they begin in the same order. Between a death and the last
// beginning none of them does anything else.
//
//   alive -die-> ending 1 -end 1-> ... -end n-> dead -begin anew-> beginning 1 -begin 1-> ... alive
//
// There are 2 (restarts + 1) (2 programs + 2) states. Beside what is said above a state knows how
// often the process began anew by itself, and whether it was told to.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "maide/automata/interface_automaton.hpp"
#include "maide/check/system/model_actions.hpp"

namespace maide {

class LifeRules {
 public:
  struct Operation {
    enum class Kind : std::uint8_t {
      is_alive,  // a condition
      die,
      die_for_new,    // dies, and will begin anew
      is_dead,        // a condition: nobody lives whom one could kill
      tell_to_begin,  // a dead one will begin anew
      end,            // program number `program` of it
      begin_anew,
      begin,  // program number `program` of it
    };
    Kind kind = Kind::is_alive;
    std::uint32_t program = 0;
  };

  // `programs`: at least one. `restarts`: how often it begins anew without being told to.
  LifeRules(std::uint32_t programs, std::uint32_t restarts)
      : programs_(programs), restarts_(restarts) {}

  // Its state 0 is alive.
  InterfaceAutomaton automaton() const {
    return {{}, {}, 2 * std::size_t{phases()} * (restarts_ + 1)};
  }
  // Behind the operation; none where it is not possible.
  std::optional<StateId> after(StateId state, const Operation& operation) const;
  ModelUse use(ModelActions& actions, std::uint32_t model, const Operation& operation) const;
  // Whether the process has died, and that program has not begun anew.
  bool is_dead(StateId state, std::uint32_t program) const;
  // It has died, and does not begin anew unless it is told to.
  bool is_over(StateId state) const;

 private:
  // Alive, the ends of programs, dead, their begins.
  std::uint32_t phases() const { return 2 * programs_ + 2; }
  std::string text_of(const Operation& operation) const;

  std::uint32_t programs_, restarts_;
};

}  // namespace maide
