// The edges of a program's automaton as they are written down, with their texts, places and fair
// groups; and what a program has on its way to models.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "maide/check/rules/life.hpp"
#include "maide/check/unroll/lock_steps.hpp"
#include "maide/check/unroll/service_steps.hpp"
#include "maide/check/unroll/topic_steps.hpp"
#include "maide/check/unroll/walker.hpp"

namespace maide::program_syntax {

// The node whose callback it is; "" without one.
inline std::string node_of(const Callback* callback) {
  return callback == nullptr ? std::string() : callback->node;
}

class EdgeWriter : public Walker {
 public:
  // Keeps references.
  EdgeWriter(const Tree& tree, const Unrolled& program, ModelActions& actions, const Names& names,
             const RunControl& control)
      : Walker(tree, program, actions, names, control),
        topics_(number_, actions, names),
        services_(number_, actions, names),
        locks_(number_, actions, names),
        life_(names.life_of(number_)) {}

 protected:
  void add_edge(const ModelUse& use, ControlState target, int line, int column);
  void add_combined(CombinedStep combined, ControlState target, int line, int column);
  // The text of each of a node array's members has groups of its own: they are of a callback.
  std::uint32_t fair_group(const Callback* callback, int line, int column, Value outcome,
                           bool on_weak_runs, const std::string& text);
  std::uint32_t intern_origin(const std::optional<SourcePosition>& origin);
  using Evaluator::text_of;
  static std::string text_of(const Uses& uses, const ModelActions& actions);
  ModelUse use(const Life& life, LifeRules::Operation::Kind kind, std::uint32_t program = 0) {
    return life.rules->use(actions_, life.model, {kind, program});
  }

  // What the code of that callback gives as this input lies on it; null: it is there at once.
  const Wire* wire_for(std::uint32_t model, Symbol input, const Callback* callback) const;
  // The condition that what it gave as other inputs has arrived, where this one comes behind those.
  std::optional<ModelUse> when_own_arrived(std::uint32_t model, Symbol input,
                                           const Callback* callback);
  // The wires from this program to the model, or to the readers of the topic that are meant.
  std::vector<const Wire*> own_wires(const ModelReference& model, const Callback* callback,
                                     const Values& values) const;
  // "image!arrived", "image[logger]!arrived".
  std::string text_of_arrival(const ModelReference& model, const Values& values) const;

  // Whether something is there is not known before somebody takes it: anybody sends it.
  bool is_left_to_anybody(std::uint32_t model) const {
    return actions_.model(model).source == ModelInstance::Source::anybody;
  }
  static bool is_left_to_anybody(const Service& service) {
    return service.is_open || service.is_server_anybody;
  }

  TopicSteps topics_;
  ServiceSteps services_;
  LockSteps locks_;
  bool was_found_ = false;      // what is taken has been found: nobody waits for it any more
  const Life* life_ = nullptr;  // of its process: what it does it does as long as that lives
  std::uint32_t origin_ = 0;    // of the statement that is expanded

 private:
  std::map<std::tuple<const Callback*, int, int, Value>, std::uint32_t> fair_ids_;
  std::map<std::tuple<std::string, int, int>, std::uint32_t> origin_ids_;
};

}  // namespace maide::program_syntax
