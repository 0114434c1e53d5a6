// From the syntax tree of a program to the tree that is unrolled: names have their meaning, and a
// procedure stands wherever it is called, with its arguments for its parameters.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "maide/check/build/event_resolver.hpp"
#include "maide/check/build/name_resolver.hpp"

namespace maide::program_syntax {

class CodeResolver {
 public:
  // Keeps a reference.
  explicit CodeResolver(Work& work) : work_(work), names_(work), events_(names_, work) {}

  void resolve_program(const syntax::Code& code);
  // What runs callbacks: a loop that rests until one of them can start, and then does its code and
  // its end.
  void resolve_thread(const Thread& thread);

 private:
  // ---- Statements ----

  void resolve_statements(const syntax::Block& from, Block& to);
  // A block of its own; `names` are seen in it alone.
  std::unique_ptr<Block> resolve_block(const syntax::Block& block);
  std::unique_ptr<Block> open_block();
  std::unique_ptr<Block> close_block(std::unique_ptr<Block> open, const syntax::Block& block);
  Statement resolve_statement(const syntax::Statement& from);
  std::uint32_t resolve_label(const syntax::Name& name);
  void resolve_kind(const syntax::Statement& from, Statement& to);
  void resolve_wait(const syntax::Statement& from, Statement& to);
  // The number of `matched` or `matched(2)`.
  std::uint32_t count_of_matched(const syntax::Event& matched) const;
  void resolve_wait_for_server(const syntax::Statement& from, Statement& to);
  void resolve_offer(const syntax::Statement& from, Statement& to);
  void resolve_kill(const syntax::Statement& from, Statement& to);
  void resolve_run(const syntax::Statement& from, Statement& to);
  // `cv.wait;`, perhaps with a time-out: gives the mutex back, waits, and has it again.
  void resolve_condition_wait(const syntax::Statement& from, Statement& to);
  void resolve_spin(const syntax::Statement& from, Statement& to);
  // Its arms, and what it may do beside.
  void resolve_spin_of(const std::vector<const Callback*>& callbacks, const syntax::Statement& from,
                       Statement& to);
  // `spin some n;`, of a constant n.
  bool names_a_count(const syntax::Statement& from) const;
  void resolve_until(const syntax::Statement& from, Statement& to);
  // A variable of the program that no text names, 0 at first.
  Expression add_slot(const std::string& name, const ValueType& type,
                      const SourcePosition& position);
  // For ever: a loop around what can start.
  Statement make_spinning(const std::vector<const Callback*>& callbacks, int line, int column);
  void resolve_repeat(const syntax::Statement& from, Statement& to);
  // LOW..HIGH, which may depend on the program's own variables.
  void resolve_bounds(const syntax::Range& range, Statement& to, std::string_view what);
  void resolve_for(const syntax::Statement& from, Statement& to);
  void resolve_declaration(const syntax::Statement& from, Statement& to);
  // The steps that choose the first value of each slot of the declaration.
  std::vector<Statement> choices_of(const Statement& declaration) const;
  // Those of the file's and the nodes' variables that are this program's own.
  void choose_own(Block& block);
  void resolve_choice_of_value(const syntax::Statement& from, Statement& to);
  void resolve_call(const syntax::Statement& from, Statement& to);
  [[noreturn]] void fail_argument_count(const Procedure& procedure, const syntax::Name& name) const;
  Binding resolve_call_argument(const syntax::Term& term) const;

  // ---- Arms ----

  Arm resolve_arm(const ModelReference& model, const syntax::Arm& from);
  // Without a block of its own: a variable that it declares is the block's around it.
  Arm resolve_awaited(const ModelReference& model, const syntax::Arm& from);
  void add_arm(std::vector<Arm>& arms, Arm arm, const syntax::Name& name,
               std::string_view what) const;
  SelectArm resolve_select_arm(const syntax::SelectArm& from);
  void check_distinct(const std::vector<SelectArm>& arms, const SelectArm& arm) const;

  // ---- Callbacks ----

  SelectArm resolve_start(const Callback& callback);
  // Where the callback may start, beyond what came for it.
  void resolve_when(const Callback& callback, SelectArm& arm);
  // The start of a node, or what spins: its code and its end.
  void resolve_node_start(const Callback& callback, Block& block);
  void note_that_it_came(const Expression& came, Block& code) const;
  void resolve_taken(const syntax::Taken& taken, SelectArm& arm, Event& pattern) const;
  void resolve_subscription(const Callback& callback, const Context& inside, SelectArm& arm);
  std::unique_ptr<Block> open_procedure();
  // The code of a callback, into `procedure`, whose scope is open; and then its end. Null: it has
  // no code.
  std::unique_ptr<Block> resolve_code(const syntax::Code* code, const Context& inside,
                                      std::unique_ptr<Block> procedure);
  bool has_outputs(const SelectArm& arm) const;

  Work& work_;
  NameResolver names_;
  EventResolver events_;
};

// Throw ParseError: unknown names, kinds that do not fit. `begin`: where the program's text begins.
Tree resolve_program(const syntax::Code& code, const Context& context);
Tree resolve_thread(const Thread& thread, const SourcePosition& begin, const Context& context);

}  // namespace maide::program_syntax
