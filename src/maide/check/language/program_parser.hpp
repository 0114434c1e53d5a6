// Recursive descent over the program language; the grammar stands in program.hpp. A procedure is
// parsed anew wherever it is called, with its arguments standing for its parameters. Statements are
// read in program_parser.cpp; the arms of `switch` and `select` in arm_parser.cpp.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "maide/check/language/name_parser.hpp"

namespace maide::program_syntax {

// Models, topics and their inputs and outputs in a program's text: `M.write(e)`, `message(var x)`.
// An index whose value is not known before the run may name any member of its array.
class EventParser : public NameParser {
 public:
  using NameParser::NameParser;

 protected:
  ModelReference parse_model();
  // The instances or topics that the reference may mean: one, if its indices are known.
  template <typename Visit>
  void for_each_member(const ModelReference& model, const Visit& visit) const {
    std::vector<Value> indices;
    for (const Expression& index : model.leaf.operands) {
      if (index.is_constant()) indices.push_back(index.value);
    }
    if (indices.size() == model.leaf.operands.size()) {
      try {
        visit(model.leaf.index + element_of(model.leaf, indices));
      } catch (const EvaluationError&) {  // an error of the run that comes there
      }
      return;
    }
    const auto count = static_cast<std::uint32_t>(member_count(model.leaf.dimensions));
    for (std::uint32_t i = 0; i < count; ++i) visit(model.leaf.index + i);
  }
  template <typename Visit>
  void for_each_topic(const ModelReference& model, const Visit& visit) const {
    if (!model.is_topic) return;
    for_each_member(model, [&](std::uint32_t member) { visit(context_.names.topics[member]); });
  }
  [[noreturn]] void fail_unknown_model(const Token& name, bool is_unknown);
  // The model, or one like it: the first member's, the first reader's.
  const ModelInstance& instance(const ModelReference& model) const;
  // Whose callback this is code of, or starts; empty: a program's.
  std::string node() const {
    const Callback* const callback =
        context_.callback != nullptr ? context_.callback : context_.starts;
    return callback == nullptr ? "" : callback->node;
  }
  // The name in the model of what this program calls so: the second writer's `write` is `write2`.
  std::string name_at_end(const ModelReference& model, const std::string& name) const;
  // A topic's writers write, and its readers read. Which topic it is that an index names shows when
  // control comes there.
  void check_role(const ModelReference& model, const Event& event, const Token& name);
  // Of a service, by its members that the program or node stands at; null: it is none.
  const Service* service_of(const ModelReference& model) const;
  std::string name_at_service(const ModelReference& model, const std::string& name, bool is_input,
                              const Token& token);
  // Nothing is received in a callback but through its executor.
  void check_received(const ModelReference& model, const Event& event, bool is_input,
                      const Token& name);
  Event parse_event_name(const ModelReference& model, std::string_view what);
  // The model has a symbol of that name. A model whose alphabet is not known yet has any.
  void check_event(const ModelReference& model, const Event& event, const Token& name,
                   std::string_view what);
  Event parse_input(const ModelReference& model);
  // Tells it of all members of the array: they have one alphabet.
  void note_value(const ModelReference& model, const Event& event, const ValueType& type);
  // What is known at once is an input of the model.
  void check_constant_input(const ModelReference& model, const Event& event, const Token& name);
  // A value of a model's: its words need be known nowhere else.
  Expression parse_argument(const ModelReference& model);
  Event parse_output(const ModelReference& model);
  // A variable that takes the value, or a value.
  Event::Argument parse_pattern(const ModelReference& model, const Event& event);
};

class ProgramParser : public EventParser {
 public:
  using EventParser::EventParser;

  void parse_program();
  void parse_procedure(Block& block) { parse_statements(block); }
  // Of a text without statements: what runs the callbacks.
  void parse_thread(const Thread& thread);

 private:
  // ---- statements -------------------------------------------------------------------------------

  void parse_statements(Block& block);
  std::unique_ptr<Block> open_block();
  // Reads the rest of a block that open_block() began.
  std::unique_ptr<Block> close_block(std::unique_ptr<Block> block, std::string_view where);
  std::unique_ptr<Block> close_open_block(std::unique_ptr<Block> block, const Token& open);
  std::unique_ptr<Block> parse_block(std::string_view where);
  // Of a loop: `break` and `continue` may stand in it.
  std::unique_ptr<Block> parse_body(std::string_view where);
  Statement parse_statement();
  // A word before `.` names a model, whatever the word is.
  bool is_keyword(std::string_view word) const;
  bool accept_keyword(std::string_view word);
  void expect_semicolon(std::string_view where = "at the end of the statement");
  void parse_simple(const Token& first, Statement& statement);
  // The statement begins with a variable, and is not an input.
  bool is_target() const;
  // Of a word that is no keyword and has no '.' behind it: throws unless it is a model's name.
  void require_model(const Token& first) const;
  std::uint32_t parse_label();
  Expression parse_condition(const std::string& where);
  void parse_repeat(Statement& statement);
  void parse_if(Statement& statement);
  // LOW..HIGH, which may depend on the program's own variables.
  void parse_bounds(Statement& statement, std::string_view what);
  void parse_for(Statement& statement);
  void parse_declaration(Statement& statement);
  void parse_assignment(Statement& statement);
  void check_atomic(const Block& block);
  void parse_call(Statement& statement);
  [[noreturn]] void fail_argument_count(const Procedure& procedure, const Token& name);
  Binding parse_call_argument();
  void parse_give(Statement& statement);

  // ---- callbacks --------------------------------------------------------------------------------

  SelectArm parse_start(const Callback& callback);
  void parse_taken(SelectArm& arm, Event& pattern);
  // The code of a callback, into `procedure`, whose scope is open; and then its end.
  std::unique_ptr<Block> parse_code(const ScalarText* code, std::unique_ptr<Block> procedure);
  bool has_outputs(const SelectArm& arm) const;

  // ---- arms -------------------------------------------------------------------------------------

  Arm begin_arm(bool is_quiet);
  // Without a block of its own: a variable that it declares is the block's around it.
  Arm parse_awaited(const ModelReference& model);
  // An arm with a block, behind which its names end.
  Arm parse_arm(const ModelReference& model, bool may_be_quiet);
  // The same output, whatever it carries, or the same values.
  static bool is_same(const Arm& one, const Arm& other);
  static bool is_same(const Expression& one, const Expression& other);
  void add_arm(std::vector<Arm>& arms, Arm arm, const Token& name, std::string_view what);
  void parse_arms(const Token& first, Statement& statement);

  // ---- select -----------------------------------------------------------------------------------

  void parse_select(const Token& first, Statement& statement);
  void check_distinct(const std::vector<SelectArm>& arms, const SelectArm& arm, const Token& begin);
  SelectArm parse_select_arm();
  // Behind `on M.input {`: outputs and what is done then, no statements.
  bool begins_outputs() const;
};

}  // namespace maide::program_syntax
