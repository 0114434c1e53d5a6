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
#include "maide/check/rules/service_model.hpp"
#include "maide/check/system/model_actions.hpp"

namespace maide {

// Makes the wires, which the names then know, and says of each connection when its messages arrive.
// The automata of the models are there. Throws ParseError: too many components.
std::vector<ConnectionInstance> add_wires(const Declarations& file, Models& models);
// The steps of nobody: arrivals and losses. The programs were made with `actions`.
void add_arrivals(const Declarations& file, const Names& names, System& system,
                  ModelActions& actions);

struct Sending {
  const Wire* wire = nullptr;
  Symbol input = 0;          // one of its letters
  std::uint32_t caller = 0;  // the program
};
// The ways in which all these are sent in one step, to different models; each where the others are
// not.
std::vector<Uses> ways_to_send(const std::vector<Sending>& all, ModelActions& actions);
// The ways in which nothing can be sent; none: it always can.
std::vector<Uses> ways_to_wait(const Wire& wire, ModelActions& actions);
// Of a model that may refuse what another writer gives it at once: how many messages are on all
// wires to it, at most; a condition, that they are so many; and whether it takes so many more
// there. Null: nobody has a wire to it, or it refuses nothing.
const Wire* counted_wire(const Names& names, std::uint32_t model);
std::uint32_t most_counted(const Wire& wire, const ModelActions& actions);
ModelUse when_counted(const Wire& wire, ModelActions& actions, std::uint32_t held);
bool has_room_for(const Wire& wire, StateId state, std::uint32_t needed);
// What the death of the program does to wires from it and to it, and to their order.
Uses when_dies(std::uint32_t program, const Names& names, ModelActions& actions);
// Some of what is sent there is on its way for a while.
bool is_on_its_way(const Service& service);
// The ways in which the service, which is that model, is used so, where what is sent is in a
// stream; else one way.
std::vector<Uses> ways_to_use(const Service& service, std::uint32_t model,
                              const ServiceModel::Operation& operation, ModelActions& actions);
// Of a program that stands in the call of an answer: the steps that end it.
std::vector<CombinedStep> ends_of_answer(const Service& service, std::uint32_t model,
                                         std::uint32_t caller, ModelActions& actions);
// Of a program that stands in a call which returns when what it sent on these wires has arrived, or
// its readers have died: the steps that end it. `names`: of the connections that the wires are.
std::vector<CombinedStep> ends_of_call(const std::vector<const Wire*>& wires, std::uint32_t caller,
                                       const Names& names, ModelActions& actions);
// The call has returned, by the death of readers: conditions.
Uses when_returned(const std::vector<const Wire*>& wires, std::uint32_t caller,
                   ModelActions& actions);
// A condition: nothing is on its way.
ModelUse when_empty(const Wire& wire, ModelActions& actions);
// Conditions: all on these wires has arrived; and the ways in which it has not.
Uses when_all_arrived(const std::vector<const Wire*>& wires, ModelActions& actions);
std::vector<Uses> ways_not_all_arrived(const std::vector<const Wire*>& wires,
                                       ModelActions& actions);

}  // namespace maide
