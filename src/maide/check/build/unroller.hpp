// Unrolling of a program's syntax tree into its automaton: each control state is expanded once,
// when it is first met, into the edges of the statement that it rests before. Walker says where
// control rests behind an edge. Choices, assignments, conditions and `atomic` are in unroller.cpp;
// inputs and outputs of models, and `select`, in select_steps.cpp; those of topics in
// topic_steps.cpp.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "maide/check/build/walker.hpp"
#include "maide/check/rules/service_model.hpp"

namespace maide::program_syntax {

using Uses = std::vector<ModelUse>;

// The node whose callback it is; "" without one.
inline std::string node_of(const Callback* callback) {
  return callback == nullptr ? std::string() : callback->node;
}

struct OfOthers;

class Unroller : public Walker {
 public:
  // Keeps references.
  Unroller(const Tree& tree, const Unrolled& program, ModelActions& actions, const Names& names,
           const RunControl& control)
      : Walker(tree, program, actions, names, control), may_die_(program.may_die) {}

  Program run();

 private:
  using Evaluator::text_of;

  void add_edge(const ModelUse& use, ControlState target, int line, int column);
  void add_combined(CombinedStep combined, ControlState target, int line, int column);
  // The text of each of a node array's members has groups of its own: they are of a callback.
  std::uint32_t fair_group(const Callback* callback, int line, int column, Value outcome,
                           bool on_weak_runs, const std::string& text);
  std::uint32_t intern_origin(const std::optional<SourcePosition>& origin);
  void expand(const Place place);
  void expand(const Place& place, const Statement& statement);
  // Keeps the guards of the `select` at the next control state.
  void note_guards(const Statement& statement);
  void add_death(const Place& place);
  // What the program's death does to models: one of these.
  const std::vector<Uses>& deaths();
  void expand_choice(const Place& place, const Statement& statement, const Values& values);
  void expand_any(const Place& place, const Statement& statement, const Values& values);
  void add_write(const Place& place, const Statement& statement, Value value, const Values& values);
  static std::string text_of(const std::vector<ModelUse>& uses, const ModelActions& actions);
  // One edge for each outcome of what is read.
  void expand_assign(const Place& place, const Statement& statement, const Values& values);
  void add_reading(const Statement& statement, const Conditions& conditions, ControlState target);
  void expand_condition(const Place& place, const Statement& statement, const Values& values);

  void expand_atomic(const Place& place, const Statement& statement, const Values& values);

  // ---- inputs and outputs -----------------------------------------------------------------------

  void expand_rendezvous(const Place& place, const Statement& statement, const Values& values);
  void expand_arrival(const Place& place, const Statement& statement, const Values& values);
  // The wires from this program to the model, or to the readers of the topic that are meant.
  std::vector<const Wire*> own_wires(const ModelReference& model, const Callback* callback,
                                     const Values& values) const;
  // All on these wires has arrived; and the ways in which it has not.
  Uses all_arrived(const std::vector<const Wire*>& wires);
  std::vector<Uses> not_all_arrived(const std::vector<const Wire*>& wires);
  // "image!arrived", "image[logger]!arrived".
  std::string text_of_arrival(const ModelReference& model, const Values& values) const;
  // What the code of that callback gives as this input lies on it; null: it is there at once.
  const Wire* wire_for(std::uint32_t model, Symbol input, const Callback* callback) const;
  // The condition that what it gave as other inputs has arrived, where this one comes behind those.
  std::optional<ModelUse> when_own_arrived(std::uint32_t model, Symbol input,
                                           const Callback* callback);

  // ---- services and callbacks -------------------------------------------------------------------

  using ServiceUse = ServiceModel::Operation;
  // What the input or output is to the service, at this program's or callback's end.
  ServiceUse operation_of(const Service& service, const std::string& name, bool is_input,
                          const Callback* callback) const;
  // The number of this program among those whose answers are waited for.
  std::uint32_t caller_of(const Service& service) const;
  void expand_service(const Place& place, const Statement& statement, const Values& values,
                      std::uint32_t model);
  // The arm's use of the service, with the output that it takes, and what may be due before it is
  // given.
  struct ServiceArm {
    ServiceUse use;
    std::optional<std::string> output;
    std::optional<ServiceUse> due;
  };
  ServiceArm service_arm(const SelectArm& arm, std::uint32_t model) const;
  Uses events_of(std::uint32_t model, const std::string& input, const std::string& output) const;
  // How a callback can start that takes nothing from a model of the file; and its events.
  std::pair<Uses, Uses> start_of(const SelectArm& arm);
  // A client's callback is passed over for answers to others, which are thrown away.
  ModelUse discard_of(const SelectArm& arm);
  void expand_discard(const Place& place, const SelectArm& arm, const Values& values,
                      const Uses& conditions);
  // Nothing is there for the arm's callback.
  std::vector<Uses> nothing_for(const SelectArm& arm, const Values& values);
  // Something is there for the arm's callback, or nothing is; each in some ways.
  std::pair<std::vector<Uses>, std::vector<Uses>> asked(const SelectArm& arm, const Values& values);
  // In which order a look asks for the arms, one in a step: as rmw_fastrtps does, where something
  // may be on its way. Empty: it asks for all in one step.
  std::vector<std::size_t> order_of_look(const Statement& statement, const Values& values) const;
  // The look has found these, and asked for so many.
  void go_on_looking(const Place& place, const Statement& statement, const Values& values,
                     std::uint64_t found, std::size_t asked_so_far);
  void expand_rounds(const Place& place, const Statement& statement, const Values& values);
  void expand_end(const Place& place, const Statement& statement, const Values& values);

  // ---- topics -----------------------------------------------------------------------------------

  // A write of this program, and the taking of what is collected for it if that is due at once.
  struct Writing {
    Uses uses, events;
    std::optional<std::string> output;  // that is taken
    bool is_beyond = false;             // the input was never tried in some model
    bool calls = false;                 // the program waits for its arrival
  };
  enum class WriteKind : std::uint8_t {
    statement,
    bare_arm,          // `on t.write { }`
    arm_with_outputs,  // `on t.write -> written { }`: only where the output is due at once
  };
  // `node`: of the callback in whose code it stands.
  const std::vector<Writing>& writings(const Topic& topic, const std::string& input, WriteKind kind,
                                       const std::string& node);
  void add_writings(const Topic& topic, const std::string& input, WriteKind kind,
                    const std::string& node, const std::vector<bool>& living,
                    const OfOthers& others, std::vector<Writing>& writings);
  // The writer takes what was collected.
  struct Taking {
    Uses uses, events;
    std::string output;
  };
  std::vector<Taking> takings(const Topic& topic);
  Uses taken_events(const Topic& topic, const std::string& output) const;
  // For a writer: no model has an output due, and what it wrote is not collected.
  std::vector<Uses> quiet_of(const Topic& topic, const std::string& node);
  // That, and none of these arms can be taken: inputs, and whether they name outputs.
  struct WriteArm {
    std::string input;
    WriteKind kind = WriteKind::bare_arm;
  };
  std::vector<Uses> idle_of(const Topic& topic, const std::vector<WriteArm>& arms,
                            const std::string& node);
  void add_idle(const Topic& topic, const std::vector<WriteArm>& arms, const std::string& node,
                const OfOthers& others, std::vector<Uses>& ways);
  std::vector<const Wire*> wires_to(const Topic& topic, const std::string& node) const;
  // Where the program waits for the return of what it gave there.
  ControlState in_call(const Place& place) {
    return control_state({place.frame, Phase::calls, 0, place.valuation, 0, 0});
  }
  // What ends the call of the statement, in which the program stands.
  void expand_call(const Place& place, const Statement& statement, const Values& values);
  // The variable that says whose call has not returned, set to this program or to nobody.
  void set_caller(const Topic& topic, bool is_this, Uses& uses);
  // The steps of this program's death with a topic at which it stands: one, or one for each thing
  // that it may leave behind.
  std::vector<Uses> deaths_at(const Topic& topic);

  // ---- select -----------------------------------------------------------------------------------

  void expand_select(const Place& place, const Statement& statement, const Values& values);
  static std::string text_of(const SelectArm& arm);
  // The arm's steps where its guard holds, which asks for `conditions`.
  void expand_arm(const Place& place, const SelectArm& arm, const Values& values,
                  const std::vector<ModelUse>& conditions, std::uint32_t fair);
  // None of the outputs that the arm awaits ever follows its input.
  [[noreturn]] void fail_without_output(const SelectArm& arm, const std::string& input,
                                        const Alphabet& outputs, const Values& values) const;
  // `otherwise` and `timeout`: no arm whose guard holds can be taken, and none of their models has
  // an output due.
  void expand_otherwise(const Place& place, const Statement& statement, const SelectArm& waiting,
                        const Values& values);
  // Each is one way in which that can be. None: some arm can be taken whatever the models do.
  std::vector<Uses> idle_uses(const Statement& statement, const std::vector<std::int8_t>& guards,
                              const Values& values);
  // Both, each of some ways, where that is possible.
  std::vector<Uses> combine(const std::vector<Uses>& some, const std::vector<Uses>& others);
  static WriteKind kind_of(const SelectArm& arm);
  // The steps of an arm that writes to a topic, or takes what was written.
  template <typename Add>
  void expand_topic_arm(const Place& place, const SelectArm& arm, const Topic& topic,
                        const Values& values, const Add& add);
  // What an arm for an input does with its model in one of its steps.
  struct InputWay {
    Uses uses;                     // the first is of the model
    std::optional<Symbol> output;  // that is taken, too
    bool is_beyond = false;        // the input was never tried there
  };
  std::vector<InputWay> ways_of(const SelectArm& arm, std::uint32_t model, Symbol input);

  bool may_die_ = false;
  std::map<std::tuple<const Topic*, std::string, WriteKind, std::string>, std::vector<Writing>>
      writings_;
  std::vector<Uses> deaths_;  // empty: not known yet
  std::map<std::tuple<const Callback*, int, int, Value>, std::uint32_t> fair_ids_;
  std::map<std::tuple<std::string, int, int>, std::uint32_t> origin_ids_;
  std::map<const Statement*, std::uint32_t> guard_ids_;
  std::uint32_t origin_ = 0;  // of the statement that is expanded
};

}  // namespace maide::program_syntax
