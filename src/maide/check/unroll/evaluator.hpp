// What the values of a program's variables decide: the values of expressions, the member of an
// array that its indices name, the input that is given, the arm that takes an output.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "maide/check/language/program_tree.hpp"
#include "maide/check/system/model_actions.hpp"
#include "maide/check/unroll/make_program.hpp"

namespace maide::program_syntax {

using Values = std::vector<std::optional<Value>>;  // by slot

// What the evaluation of an expression comes to.
struct Result {
  std::optional<Value> value;
  std::string error;  // if there is no value
  int line = 0, column = 0;
  bool operator==(const Result&) const = default;
};

// Of `atomic`: what it leaves behind.
struct AtomicResult {
  bool is_blocked = false;  // its condition does not hold

  Values values;
  SharedValues writes;
  std::string error;
  int line = 0, column = 0;
  bool operator==(const AtomicResult&) const = default;
};

inline bool is_shared(const Expression& leaf) { return leaf.op == Expression::Operator::shared; }

class Evaluator {
 public:
  // `number`: of the program. Keeps references.
  Evaluator(std::uint32_t number, ModelActions& actions, const Names& names)
      : number_(number), actions_(actions), names_(names) {}
  virtual ~Evaluator() = default;
  Evaluator(const Evaluator&) = delete;
  Evaluator& operator=(const Evaluator&) = delete;

 protected:
  // `shared`: values of shared variables; null: it reads none.
  Value evaluate(const Expression& expression, const Values& values,
                 const SharedValues* shared = nullptr, const SharedValues* writes = nullptr) const;
  // One for each set of values of the shared variables that it reads. Throws ParseError (at
  // `where`) if they are too many.
  std::vector<Outcome<Result>> outcomes(const Expression& expression, const Values& values,
                                        const SourcePosition& where) const;
  std::vector<Outcome<AtomicResult>> outcomes_of_atomic(const Statement& statement,
                                                        const Values& values,
                                                        const SourcePosition& where) const;
  static const Block& branch(const Statement& statement, Value condition) {
    return condition != 0 ? *statement.body : *statement.otherwise;
  }
  // The slot or model that a variable or model with indices stands for.
  std::uint32_t element(const Expression& leaf, const Values& values) const;
  // The topic, if the reference is one and the program writes that; none of what stands for a
  // model.
  const Topic* written_topic(const ModelReference& model, const std::string& event,
                             const Values& values) const;
  // Throws EvaluationError: the program has no such end of the topic.
  void check_end(const ModelReference& model, const Event& event, const Values& values) const;
  void check_end(const ModelReference& model, bool writes, const Event& event,
                 const Values& values) const;
  // The instance: of a topic the one that this program reads; or the first, whose alphabet is that
  // of all.
  std::uint32_t model_of(const ModelReference& model, const Values& values) const;
  std::string text_of(Value value, ValueKind kind) const;
  // Throws EvaluationError: the value is outside of the type.
  void check_range(const Expression& target, const ValueType& type, Value value) const;
  void set(const Expression& target, const ValueType& type, Value value, Values& values) const;

  // ---- inputs and outputs -----------------------------------------------------------------------

  // The name with its values: "write(3)".
  std::string name_of(const Event& event, const Values& values) const;
  // Throws EvaluationError: the model has no such input.
  virtual Symbol input_of(std::uint32_t model, const Event& event, const Values& values) const;
  // Whether the arm is for an output of that name.
  bool matches(const Event& pattern, const NameParts& output, const std::string& symbol,
               const Values& values) const;
  static bool binds(const Event& pattern);
  // The arm that takes the output: one that names its values before one that does not; or null.
  const Arm* arm_for(const std::string& output, const std::vector<Arm>& arms,
                     const Values& values) const;
  // By output symbol of the model.
  std::vector<const Arm*> arms_of(std::uint32_t model, const std::vector<Arm>& arms,
                                  const Values& values) const;
  // The values after the output was taken. Throws EvaluationError: a value outside of its variable.
  Values bind(const Event& pattern, const std::string& output, Values values);

 private:
  void execute(const Block& block, const SharedValues& shared, AtomicResult& result) const;
  // Of an `atomic`: a `for`.
  void execute_rounds(const Statement& statement, const SharedValues& shared,
                      AtomicResult& result) const;

 protected:
  std::uint32_t number_ = 0;  // of the program
  ModelActions& actions_;
  const Names& names_;
};

}  // namespace maide::program_syntax
