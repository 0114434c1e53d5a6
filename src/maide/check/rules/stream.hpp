// A stream: in which order messages of several wires were sent that go the same way, as through one
// TCP connection. Of all that is on these wires the oldest alone may arrive. Each wire holds its
// own messages (wire.hpp); the stream's state is the order of the wires that they are on.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "maide/check/rules/built_in_models.hpp"
#include "maide/check/system/model_actions.hpp"

namespace maide {

// Programs and nobody use it by actions alone.
class StreamModel : public GrowingModel {
 public:
  // A message that is put on a wire, of which the oldest may be lost by that.
  struct Sent {
    std::uint32_t wire = 0;
    bool pushes_out = false;
  };

  // `wires`: their names, for texts.
  explicit StreamModel(std::vector<std::string> wires);

  InterfaceAutomaton start() const override { return {{}, {}, 1}; }
  bool is_large() const override { return false; }

  // In that order, in one step.
  ModelUse send(ModelActions& actions, std::uint32_t model, const std::vector<Sent>& all);
  // The oldest of all leaves its wire, which is that one.
  ModelUse leave(ModelActions& actions, std::uint32_t model, std::uint32_t wire);
  // What is on these wires is gone.
  ModelUse forget(ModelActions& actions, std::uint32_t model,
                  const std::vector<std::uint32_t>& wires);

 private:
  std::vector<Follower> followers(const Contents&) const override { return {}; }
  bool is_due(const Contents&) const override { return false; }
  // `after` changes the contents; false: it is not possible there.
  template <typename After>
  ModelUse use(ModelActions& actions, std::uint32_t model, const std::string& text, After after);

  std::vector<std::string> wires_;
};

}  // namespace maide
