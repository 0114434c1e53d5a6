#include "maide/check/rules/stream.hpp"

#include <algorithm>
#include <utility>

namespace maide {

StreamModel::StreamModel(std::vector<std::string> wires)
    : GrowingModel({}), wires_(std::move(wires)) {}

template <typename After>
ModelUse StreamModel::use(ModelActions& actions, std::uint32_t model, const std::string& text,
                          After after) {
  return actions.action(
      model, text,
      ModelActions::StepsOfState([this, &actions, model, after = std::move(after)](StateId at) {
        if (is_elsewhere(at)) return std::vector<ModelStep>{{at, true}};
        Contents next = contents(at);
        if (!after(next)) return std::vector<ModelStep>{};
        return std::vector<ModelStep>{{state_of(actions.automaton(model), std::move(next)), false}};
      }));
}

ModelUse StreamModel::send(ModelActions& actions, std::uint32_t model,
                           const std::vector<Sent>& all) {
  std::string text;
  for (const Sent& sent : all) {
    text += (text.empty() ? "" : ", ") + wires_[sent.wire] +
            (sent.pushes_out ? " pushes out its oldest" : " is sent to");
  }
  return use(actions, model, text, [all](Contents& order) {
    for (const auto& [wire, pushes_out] : all) {
      if (pushes_out) {
        const auto oldest = std::ranges::find(order, wire);
        if (oldest == order.end()) return false;
        order.erase(oldest);
      }
      order.push_back(wire);
    }
    return true;
  });
}

ModelUse StreamModel::leave(ModelActions& actions, std::uint32_t model, std::uint32_t wire) {
  return use(actions, model, wires_[wire] + " is next", [wire](Contents& order) {
    if (order.empty() || order.front() != wire) return false;
    order.erase(order.begin());
    return true;
  });
}

ModelUse StreamModel::forget(ModelActions& actions, std::uint32_t model,
                             const std::vector<std::uint32_t>& wires) {
  std::string text;
  for (const std::uint32_t wire : wires) text += (text.empty() ? "" : ", ") + wires_[wire];
  return use(actions, model, text + ": forgotten", [wires](Contents& order) {
    std::erase_if(
        order, [&](std::uint32_t wire) { return std::ranges::find(wires, wire) != wires.end(); });
    return true;
  });
}

}  // namespace maide
