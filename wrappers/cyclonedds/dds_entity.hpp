// Ownership of what Cyclone's C API hands out: entities and QoS.
#pragma once

#include <dds/dds.h>
#include <fmt/core.h>

#include <memory>
#include <stdexcept>
#include <utility>

namespace maide::cyclonedds {

// The value of a call that gives an entity, a count or a return code; throws if it failed.
template <typename Value>
Value checked(Value value, const char* call) {
  if (value < 0) throw std::runtime_error(fmt::format("{}: {}", call, dds_strretcode(-value)));
  return value;
}

// An entity, deleted with all that was made from it.
class Entity {
 public:
  Entity() = default;
  // `handle` as the call that made it returned it; throws std::runtime_error if that failed.
  Entity(dds_entity_t handle, const char* call) : handle_(checked(handle, call)) {}
  Entity(Entity&& other) noexcept : handle_(std::exchange(other.handle_, 0)) {}
  Entity& operator=(Entity&& other) noexcept {
    std::swap(handle_, other.handle_);
    return *this;
  }
  ~Entity() {
    if (handle_ > 0) dds_delete(handle_);
  }
  dds_entity_t get() const { return handle_; }

 private:
  dds_entity_t handle_ = 0;
};

struct QosDeleter {
  void operator()(dds_qos_t* qos) const { dds_delete_qos(qos); }
};
using Qos = std::unique_ptr<dds_qos_t, QosDeleter>;

}  // namespace maide::cyclonedds
