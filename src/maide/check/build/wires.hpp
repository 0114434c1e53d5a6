// Messages on their way: which writers have a wire to which models. A write is a step of the
// program that changes the wire alone (unroll/wire_uses.hpp); the arrival is a step of nobody
// (arrivals.hpp), in which the model gets what the program gave.
//
// A wire adds no room. Where the model may refuse what is written, a write is possible only if the
// model would take it when all that is on all wires to it had arrived: a counter model says how
// much that is. So what arrives is never refused.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "maide/check/build/declarations.hpp"
#include "maide/check/build/models.hpp"
#include "maide/check/rules/service_model.hpp"
#include "maide/check/system/model_actions.hpp"

namespace maide {

// Makes the wires, which the names then know, and says of each connection when its messages arrive.
// The automata of the models are there. Throws ParseError: too many components.
std::vector<ConnectionInstance> add_wires(const Declarations& file, Models& models);

}  // namespace maide
