#include "maide/check/trace.hpp"

#include <algorithm>
#include <functional>
#include <stdexcept>

#include "maide/check/ltl_automaton.hpp"

namespace maide {
namespace {

// What the loop of a run does for one program.
struct LoopShare {
  bool steps = false;        // it steps in it
  bool is_enabled = false;   // it could, somewhere
  bool is_disabled = false;  // it could not, somewhere
  bool is_fair(Fairness fairness) const {
    if (fairness == Fairness::weak) return steps || is_disabled;
    if (fairness == Fairness::strong) return steps || !is_enabled;
    return true;
  }
};

std::vector<LoopShare> share_loop(const System& system, const Trace& trace,
                                  const std::vector<GlobalState>& states) {
  std::vector<LoopShare> shares(system.programs.size());
  for (std::size_t at = *trace.loop_start; at < trace.steps.size(); ++at) {
    const auto enabled = enabled_steps(system, states[at]);
    shares[trace.steps[at].program].steps = true;
    for (std::uint32_t program = 0; program < shares.size(); ++program) {
      const bool can = std::any_of(enabled.begin(), enabled.end(),
                                   [&](const Step& step) { return step.program == program; });
      (can ? shares[program].is_enabled : shares[program].is_disabled) = true;
    }
  }
  return shares;
}

bool is_fair_loop(const std::vector<LoopShare>& shares, Fairness fairness) {
  return std::all_of(shares.begin(), shares.end(),
                     [&](const LoopShare& share) { return share.is_fair(fairness); });
}

std::string find_flaw_of_stuck(const System& system, const Trace& trace,
                               const std::vector<GlobalState>& states) {
  if (!trace.loop_start) return "nobody runs on for ever";
  const std::vector<LoopShare> shares = share_loop(system, trace, states);
  if (!is_fair_loop(shares, Fairness::weak)) return "the run is not fair";
  for (std::size_t program = 0; program < shares.size(); ++program) {
    if (!shares[program].steps &&
        !system.programs[program].is_end(states.back().programs[program])) {
      return "";
    }
  }
  return "every program that has not ended steps again";
}

// The run as what formulas and automata are evaluated on (see holds_on_lasso). `value` refers to
// the arguments.
struct Positions {
  std::size_t length = 0, loop = 0, cut = never_cut;
  std::function<bool(const Atom&, std::size_t at)> value;
};

Positions positions_of(const System& system, const Trace& trace,
                       const std::vector<GlobalState>& states) {
  const bool loops = trace.loop_start.has_value();
  Positions run;
  // A run that ends repeats its last state, without the event that led there.
  run.length = states.size() + (loops ? 0 : 1);
  run.loop = loops ? *trace.loop_start + 1 : run.length - 1;
  run.value = [&](const Atom& atom, std::size_t at) {
    const Step* step = at == 0 || at > trace.steps.size() ? nullptr : &trace.steps[at - 1];
    return is_true(atom, system, states[std::min(at, states.size() - 1)], step);
  };
  // A run that is cut, or shown no further, must have a bad prefix: whatever comes, it is violated.
  if (!loops && !enabled_steps(system, states.back()).empty()) run.cut = states.size();
  if (states.back().is_cut) run.cut = states.size() - 1;
  return run;
}

std::string find_flaw_of_run(const System& system, const Property& property, const Trace& trace,
                             const std::vector<GlobalState>& states) {
  const bool loops = trace.loop_start.has_value();
  if (loops && !is_fair_loop(share_loop(system, trace, states), property.fairness)) {
    return "the run is not fair";
  }
  if (property.kind == Property::Kind::ltl) {
    return evaluate_on_run(system, property.formula, trace, states)[0]
               ? "the formula holds on the run"
               : "";
  }
  const Positions run = positions_of(system, trace, states);
  const LtlAutomaton& never = *property.never;
  std::vector<std::uint64_t> valuations(std::min(run.cut, run.length));
  for (std::size_t at = 0; at < valuations.size(); ++at) {
    for (std::size_t atom = 0; atom < never.atoms.size(); ++atom) {
      valuations[at] |= std::uint64_t{run.value(never.atoms[atom], at)} << atom;
    }
  }
  const bool is_bad = run.cut == never_cut ? accepts(never, valuations, run.loop)
                                           : accepts_whatever_comes(never, valuations);
  return is_bad ? "" : "the automaton does not accept the run";
}

}  // namespace

std::vector<GlobalState> replay(const System& system, const Trace& trace) {
  std::vector<GlobalState> states{initial_state(system)};
  for (const Step& step : trace.steps) {
    const auto enabled = enabled_steps(system, states.back());
    if (std::find(enabled.begin(), enabled.end(), step) == enabled.end()) {
      throw std::logic_error("step " + std::to_string(states.size()) + " is not possible");
    }
    states.push_back(apply(system, states.back(), step));
  }
  if (trace.loop_start &&
      (*trace.loop_start >= trace.steps.size() || !(states[*trace.loop_start] == states.back()))) {
    throw std::logic_error("the loop does not close");
  }
  return states;
}

std::vector<bool> evaluate_on_run(const System& system, const Formula& formula, const Trace& trace,
                                  const std::vector<GlobalState>& states) {
  const Positions run = positions_of(system, trace, states);
  return evaluate_on_lasso(formula, run.length, run.loop, run.value, run.cut);
}

std::string find_flaw(const System& system, const Property& property, const Trace& trace) {
  std::vector<GlobalState> states;
  try {
    states = replay(system, trace);
  } catch (const std::logic_error& error) {
    return error.what();
  }
  if (property.kind == Property::Kind::deadlock) {
    return is_deadlock(system, states.back()) ? "" : "it ends in no deadlock";
  }
  if (property.kind == Property::Kind::stuck) return find_flaw_of_stuck(system, trace, states);
  return find_flaw_of_run(system, property, trace, states);
}

}  // namespace maide
