// Messages on their way: which writers have a wire to which models, what a program does that sends,
// and how what was sent arrives. A write is a step of the program that changes the wire alone; the
// arrival is a step of nobody, in which the model gets what the program gave.
//
// A wire adds no room. Where the model may refuse what is written, a write is possible only if the
// model would take it when all that is on all wires to it had arrived: a counter model says how
// much that is. So what arrives is never refused.
#pragma once

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
// The ways in which the input, one of the wire's letters, is sent; each where the others are not.
std::vector<WireUses> ways_to_send(const Wire& wire, Symbol input, ModelActions& actions);
// The ways in which nothing can be sent; none: it always can.
std::vector<WireUses> ways_to_wait(const Wire& wire, ModelActions& actions);
// What the death of its writer does to the wire.
ModelUse when_writer_dies(const Wire& wire, ModelActions& actions);
// A condition: nothing is on its way.
ModelUse when_empty(const Wire& wire, ModelActions& actions);
// The ways in which all that was sent has arrived, or its reader has died, who is `gone` in that
// state of the model; each where the other is not.
std::vector<WireUses> ways_arrived(const Wire& wire, std::optional<StateId> gone,
                                   ModelActions& actions);
// A condition: something is on its way to a reader that lives.
WireUses when_on_its_way(const Wire& wire, std::optional<StateId> gone, ModelActions& actions);

}  // namespace maide
