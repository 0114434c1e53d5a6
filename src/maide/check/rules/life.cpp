#include "maide/check/rules/life.hpp"

#include <vector>

namespace maide {

std::optional<StateId> LifeRules::after(StateId state, const Operation& operation) const {
  using Kind = Operation::Kind;
  const std::uint32_t dead = programs_ + 1;
  std::uint32_t phase = state % phases();
  bool is_told = state / phases() % 2 != 0;
  std::uint32_t used = state / phases() / 2;  // of the restarts
  const bool ends = 0 < phase && phase <= dead;
  switch (operation.kind) {
    case Kind::is_alive:
      if (phase != 0) return std::nullopt;
      return state;
    case Kind::is_dead:
      if (!ends) return std::nullopt;
      return state;
    case Kind::die:
    case Kind::die_for_new:
      if (phase != 0) return std::nullopt;
      phase = 1;
      is_told = operation.kind == Kind::die_for_new;
      break;
    case Kind::tell_to_begin:
      if (!ends) return std::nullopt;
      is_told = true;
      break;
    case Kind::end:
      if (phase != 1 + operation.program) return std::nullopt;
      ++phase;
      break;
    case Kind::begin_anew:
      if (phase != dead || (!is_told && used == restarts_)) return std::nullopt;
      ++phase;
      if (!is_told) ++used;
      is_told = false;
      break;
    case Kind::begin:
      if (phase != dead + 1 + operation.program) return std::nullopt;
      phase = (phase + 1) % phases();
      break;
  }
  return (2 * used + (is_told ? 1 : 0)) * phases() + phase;
}

bool LifeRules::is_dead(StateId state, std::uint32_t program) const {
  const std::uint32_t phase = state % phases();
  return 0 < phase && phase <= programs_ + 2 + program;
}

bool LifeRules::is_over(StateId state) const {
  const std::uint32_t phase = state % phases();
  return 0 < phase && phase <= programs_ + 1 && state / phases() == 2 * restarts_;
}

std::string LifeRules::text_of(const Operation& operation) const {
  using Kind = Operation::Kind;
  switch (operation.kind) {
    case Kind::is_alive: return "is alive";
    case Kind::die: return "dies";
    case Kind::die_for_new: return "dies, to begin anew";
    case Kind::is_dead: return "is dead";
    case Kind::tell_to_begin: return "is told to begin anew";
    case Kind::end: return "program " + std::to_string(operation.program + 1) + " ends";
    case Kind::begin_anew: return "begins anew";
    case Kind::begin: return "program " + std::to_string(operation.program + 1) + " begins";
  }
  return "";
}

ModelUse LifeRules::use(ModelActions& actions, std::uint32_t model,
                        const Operation& operation) const {
  return actions.action(model, text_of(operation), [&] {
    ModelActions::Steps steps(actions.automaton(model).size());
    for (StateId at = 0; at < steps.size(); ++at) {
      if (const auto next = after(at, operation)) steps[at] = {{*next, false}};
    }
    return steps;
  });
}

}  // namespace maide
