// Which states of its large queues and of its services a system's programs bring them to. A queue
// over v values that holds n has some 2 v^n states, of which programs mostly reach few. So it is an
// automaton given by functions (GrowingModel), whose states are numbered as a search of the system
// meets them. Where that search does not end soon, a model that is small under all that programs do
// with it is made whole. Afterwards it is an automaton like all others, and engines, reductions,
// exports and traces need not know.
//
// Invariant: in a state that was not met no input was tried. So a run that comes to one, because
// the search gave up, is cut there, and the verdict says so.
// Cost: that of visiting all states of the components that have such a queue, once, before anything
// is checked; without reductions, and with 64 bits kept of each.
#pragma once

#include <cstdint>
#include <map>
#include <memory>

#include "maide/base/run_control.hpp"
#include "maide/check/rules/built_in_models.hpp"
#include "maide/check/system/model_actions.hpp"
#include "maide/check/system/system.hpp"

namespace maide {

// What is large, and how far the search goes.
struct QueueLimits {
  std::uint64_t states = max_queue_states;  // of a queue that is made whole
  std::uint64_t met_states = 1'000'000;     // of a queue that grows
  std::uint64_t met_steps = 3'000'000;      // states of a service, times what is done with it
  std::uint64_t searched = 2'000'000;       // states of a component
  std::uint64_t small_states = 50'000;      // of a model that is made whole by what is done with it
  std::uint64_t searched_first = 20'000;    // before models are made whole
};

using GrowingModels = std::map<std::uint32_t, std::shared_ptr<GrowingModel>>;  // by model

// Grows the models, which are as GrowingModel::start() made them, and cuts them down to what was
// met. The system's programs were made with `actions`, and have to be made anew, with the actions
// that there are then. Gives up when the control's time is up; throws Interrupted when it is told
// to stop.
void grow_models(System& system, ModelActions& actions, GrowingModels& models,
                 const QueueLimits& limits, const RunControl& control);

}  // namespace maide
