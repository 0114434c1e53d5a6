// Messages on their way: which writers have a wire to which models, what a program does that sends,
// and how what was sent arrives. A write is a step of the program that changes the wire alone; the
// arrival is a step of nobody, in which the model gets what the program gave.
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
#include "maide/check/system/model_actions.hpp"

namespace maide {

// Makes the wires, which the names then know, and says of each connection when its messages arrive.
// The automata of the models are there. Throws ParseError: too many components.
std::vector<ConnectionInstance> add_wires(const Declarations& file, Models& models);
// The steps of nobody: arrivals and losses. The programs were made with `actions`.
void add_arrivals(const Declarations& file, const Names& names, System& system,
                  ModelActions& actions);

using WireUses = std::vector<ModelUse>;
struct Sending {
  const Wire* wire = nullptr;
  Symbol input = 0;  // one of its letters
};
// The ways in which all these are sent in one step, to different models; each where the others are
// not.
std::vector<WireUses> ways_to_send(const std::vector<Sending>& all, ModelActions& actions);
// The ways in which nothing can be sent; none: it always can.
std::vector<WireUses> ways_to_wait(const Wire& wire, ModelActions& actions);
// What the death of the program does to wires from it and to it, and to their order.
WireUses when_dies(std::uint32_t program, const Names& names, ModelActions& actions);
// A condition: nothing is on its way.
ModelUse when_empty(const Wire& wire, ModelActions& actions);
// A condition: something is on its way.
ModelUse when_used(const Wire& wire, ModelActions& actions);

}  // namespace maide
