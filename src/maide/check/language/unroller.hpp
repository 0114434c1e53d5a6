// Unrolling of a program's syntax tree into its automaton: each control state is expanded once,
// when it is first met, into the edges of the statement that it rests before. Walker says where
// control rests behind an edge. Choices, assignments, conditions and `atomic` are in unroller.cpp;
// inputs and outputs of models and topics in rendezvous.cpp; `select` in select_steps.cpp.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "maide/check/language/walker.hpp"

namespace maide::program_syntax {

// What the evaluation of an expression comes to.
struct Result {
  std::optional<Value> value;
  std::string error;  // if there is no value
  int line = 0, column = 0;
  bool operator==(const Result&) const = default;
};

// Of `atomic`: what it leaves behind.
struct AtomicResult {
  Values values;
  SharedValues writes;
  std::string error;
  int line = 0, column = 0;
  bool operator==(const AtomicResult&) const = default;
};

using Uses = std::vector<ModelUse>;

class Unroller : public Walker {
 public:
  // Keeps references.
  Unroller(const Tree& tree, const Unrolled& program, SharedActions& actions,
           const std::vector<Topic>& topics)
      : Walker(tree, program, actions, topics), may_die_(program.may_die) {}

  Program run();

 private:
  using Evaluator::text_of;

  void add_edge(const ModelUse& use, ControlState target, int line, int column);
  void add_joint(Joint joint, ControlState target, int line, int column);
  std::uint32_t fair_group(int line, int column, Value outcome, bool on_weak_runs,
                           const std::string& text);
  void expand(const Place place);
  void expand(const Place& place, const Statement& statement);
  void add_death(const Place& place);
  void expand_choice(const Place& place, const Statement& statement, const Values& values);
  void expand_any(const Place& place, const Statement& statement, const Values& values);
  // Where the value of an assignment is known: before its writing to a shared variable, or behind
  // that to one of the program's own.
  ControlState with_value(const Place& place, const Statement& statement, Value value,
                          Values values);
  void add_write(const Place& place, const Statement& statement, Value value, const Values& values);
  std::vector<Outcome<Result>> outcomes(const Expression& expression, const Values& values,
                                        const SourcePosition& where);
  static std::string text_of(const std::vector<ModelUse>& uses, const SharedActions& actions);
  // One edge for each outcome of what is read.
  void expand_assign(const Place& place, const Statement& statement, const Values& values);
  void add_reading(const Statement& statement, const Conditions& conditions, ControlState target);
  void expand_condition(const Place& place, const Statement& statement, const Values& values);

  // ---- atomic -----------------------------------------------------------------------------------

  void execute(const Block& block, const SharedValues& shared, AtomicResult& result) const;
  void expand_atomic(const Place& place, const Statement& statement, const Values& values);

  // ---- inputs and outputs -----------------------------------------------------------------------

  void expand_rendezvous(const Place& place, const Statement& statement, const Values& values);

  // ---- topics -----------------------------------------------------------------------------------

  // The event with the models of all readers, or of one of them.
  Uses events_of(const Topic& topic, ModelUse::Kind kind, const std::string& name,
                 const Topic::Reader* only = nullptr) const;
  // One step that is possible when the models of all readers take it; or one for each model.
  void add_write(const Topic& topic, const Statement& statement, const std::string& input,
                 ControlState target);
  // The writer takes what was collected from all models, or from the one that it was given to.
  void add_taking(const Topic& topic, const Arm& arm, const std::string& output,
                  ControlState target);
  // For a writer: no model has an output due, and what it wrote is not collected from all.
  std::vector<Uses> quiet_of(const Topic& topic);

  // ---- select -----------------------------------------------------------------------------------

  void expand_select(const Place& place, const Statement& statement, const Values& values);
  static std::string text_of(const SelectArm& arm);
  // The arm's steps where its guard holds, which asks for `conditions`.
  void expand_arm(const Place& place, const SelectArm& arm, const Values& values,
                  const std::vector<ModelUse>& conditions, std::uint32_t fair);
  // `otherwise` and `timeout`: no arm whose guard holds can be taken, and none of their models has
  // an output due.
  void expand_otherwise(const Place& place, const Statement& statement, const SelectArm& waiting,
                        const Values& values);
  // None: some arm can be taken whatever the models do.
  std::optional<std::vector<ModelUse>> idle_uses(const Statement& statement,
                                                 const std::vector<std::int8_t>& guards,
                                                 const Values& values);
  // What an arm for an input does with its model in one of its steps.
  struct InputWay {
    ModelUse use;
    std::optional<Symbol> output;  // that is taken, too
    bool is_beyond = false;        // the input was never tried there
  };
  std::vector<InputWay> ways_of(const SelectArm& arm, std::uint32_t model, Symbol input);

  bool may_die_ = false;
  std::map<std::tuple<int, int, Value>, std::uint32_t> fair_ids_;
};

}  // namespace maide::program_syntax
