// The ways out of a place where a program waits for a step that is more than one input or output:
// the arms of a `select`, what comes over a service. Of each: whose steps would make it possible,
// and what keeps these from coming.
//
// A step makes an awaited one possible if it brings one of the models that refuse it from a state
// where it is not possible into one where it is. Of a guard over the program's own variables it is
// a step of the same program: behind it these have values with which control was met behind the
// guard.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "maide/check/system/system.hpp"

namespace maide {

// What keeps a program from a step.
enum class Obstacle : std::uint8_t {
  none,         // nothing that is known
  ended,        // the program has ended
  passed,       // it never comes there again
  own_thread,   // the callback would run on the thread that waits
  own_group,    // it is in the group of the callback that waits
  no_thread,    // no thread of its executor is idle
  busy,         // its thread, or its group, runs another callback
  not_started,  // nothing comes for which it would start
};

// Who would take a step, and why it does not.
struct Helper {
  std::uint32_t program = 0;
  std::optional<std::uint32_t> callback;  // of a node, whose step it is
  Obstacle obstacle = Obstacle::none;
  // Of own_thread, own_group, no_thread, busy: the callbacks that have what this one needs. None of
  // own_thread and busy: the program runs its start, or what spins.
  std::vector<std::uint32_t> holders;
  bool operator==(const Helper&) const = default;
};

struct WayOut {
  std::vector<ProgramEdge> edges;       // the steps; none where a guard does not hold
  std::optional<Program::Guard> guard;  // which does not hold
  std::vector<ModelUse> refused;        // of the steps: inputs that their models do not take
  std::vector<Helper> helpers;  // by program and callback; those of other ways may be among them
};

// In whose code each control state of the program stands. O(edges).
std::vector<std::optional<std::uint32_t>> callbacks_in(const Program& program);

// The callback whose code the program stands in, of those that it runs; by its number.
std::optional<std::uint32_t> running_callback(const System& system, const GlobalState& state,
                                              std::uint32_t program);

// The ways out of where the program waits, in the order of the text. O(edges x states of models).
std::vector<WayOut> find_ways_out(const System& system, const GlobalState& state,
                                  std::uint32_t program);

// What keeps that callback from starting while the program waits. Nothing if no program runs it.
std::optional<Helper> find_starter(const System& system, const GlobalState& state,
                                   std::uint32_t program, std::uint32_t callback);

}  // namespace maide
