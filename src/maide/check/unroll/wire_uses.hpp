// What programs, and nobody, do with wires and with services: how a message is put on its way, how
// it arrives or is lost, what waits for that, and what a death does to it. Everything is a use of
// the models that wires and services are (rules/wire.hpp, rules/service_model.hpp).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "maide/check/rules/service_model.hpp"
#include "maide/check/rules/wire.hpp"
#include "maide/check/system/model_actions.hpp"

namespace maide {

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

// What of the service's is on its way for a while: a client, and whether it is its requests.
struct ServiceWay {
  std::uint32_t client = 0;
  bool is_request = false;
};
std::vector<ServiceWay> ways_of(const Service& service);
// Something of the service's arrives or is lost.
CombinedStep step_of_service(const Service& service, std::uint32_t model,
                             const ServiceModel::Operation& operation, ModelActions& actions);

// The number of the program among those whose calls wait for what is on the wire; 0: no call does.
std::uint32_t caller_of(const Wire& wire, std::uint32_t program);
ModelUse use(const Wire& wire, ModelActions& actions, WireModel::Operation::Kind kind,
             std::uint32_t letter = 0);
// " from camera", for texts, where several have a wire there; else "".
std::string from_of(const Wire& wire, const Names& names);

// What may come of the oldest message on a wire: it arrives, or is lost.
class Coming {
 public:
  using Kind = WireModel::Operation::Kind;

  // Keeps references. `from`: " from camera", for texts; may be empty.
  Coming(const Wire& wire, ModelActions& actions, std::string from)
      : wire_(wire), actions_(actions), from_(std::move(from)) {}

  // `connection`: what leads to that model: "map", "image[logger]".
  CombinedStep arrival(Kind kind, std::uint32_t letter, const std::string& connection);
  CombinedStep loss(Kind kind, std::uint32_t letter, const std::string& connection);

 private:
  void add_leaving(Kind kind, std::uint32_t letter, CombinedStep& step);
  // A condition: something on the wire may arrive. What is lost is so in its turn.
  ModelUse takes();

  const Wire& wire_;
  ModelActions& actions_;
  std::string from_;
};

}  // namespace maide
