// When what is sent comes to a model, by what the file says, what the model was learned from, and
// where its ends are. Learning sees a connection at rest, so its model does not tell.
#pragma once

#include <string>

#include "maide/check/build/declarations.hpp"
#include "maide/check/rules/wire.hpp"
#include "maide/check/system/system.hpp"

namespace maide {

struct DeliveryRule {
  Delivery delivery = Delivery::late;
  WireRules wire;   // of what is late
  std::string why;  // in words: "the file says so"
  // What is late comes in one order with all between the same processes that says the same; "":
  // with nothing.
  std::string stream{};
};

// Where it is asked.
struct DeliveryPlace {
  bool is_topic = false;
  bool is_in_one_process = false;  // both ends, or all of them
  bool is_of_ros2 = false;         // of a service: the file says so, or it is one between nodes
};
// Of a connection with a learned or built-in model.
DeliveryRule delivery_of(const ModelInstance& model, const ModelOrigin& origin,
                         const DeliveryWish& wish, const DeliveryPlace& place);
// Of a service, whose rules are those of ROS 2.
DeliveryRule delivery_of(const Service& service, const DeliveryWish& wish,
                         const DeliveryPlace& place);

}  // namespace maide
