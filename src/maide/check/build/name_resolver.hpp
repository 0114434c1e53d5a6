// What the names of a text mean where they stand: variables and constants of the file, of a node,
// of a block, and words. Expressions and types of the syntax tree become those of the system.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "maide/check/language/code.hpp"
#include "maide/check/language/program_tree.hpp"

namespace maide::program_syntax {

// What a name stands for in a block.
struct Binding {
  enum class Kind : std::uint8_t { variable, constant, model };
  Kind kind = Kind::variable;
  Expression expression;             // of a variable or model its leaf
  ValueType type;                    // of a variable
  bool is_counted = false;           // by a `for`
  const ModelName* model = nullptr;  // of a model or topic
};

struct Scope {
  std::map<std::string, Binding> names;
  Block* block = nullptr;
  bool is_barrier = false;  // of a procedure: what is around it is not seen
};

// What a program's text and the procedures that it calls share.
struct Work {
  Work(const Context& known, SourcePosition begin);

  const Context* context;                    // of the text that is resolved
  const Thread* thread = nullptr;            // whose callbacks its text may spin
  std::map<std::uint32_t, Expression> came;  // by callback that comes once
  SourcePosition position;                   // where the program's text begins
  Tree tree;
  std::vector<Scope> scopes;
  std::map<std::string, TextPlace> label_places;
  std::map<std::tuple<int, int, std::string>, std::uint32_t> slot_places;
  std::map<std::string, Binding> own;  // variables of the file that are the program's alone
  std::vector<std::string> calls;
  std::set<std::uint32_t> asked;  // services that the callback which is resolved may ask
  std::set<std::uint32_t> names;
  std::size_t statements = 0;
  int nesting = 0;
};

class NameResolver {
 public:
  // Keeps a reference.
  explicit NameResolver(Work& work) : work_(work) {}

  SourcePosition position(TextPlace place) const {
    return {work_.position.file, place.line, place.column};
  }
  [[noreturn]] void fail(const std::string& message, TextPlace place) const {
    throw ParseError(message, position(place));
  }
  const Context& context() const { return *work_.context; }

  // ---- Names ----

  // What the name stands for, here or in the file; nothing of a name that is not known.
  std::optional<Binding> find(const std::string& name) const;
  // As above, where a word may stand, too: nothing of a word in quotes.
  std::optional<Binding> find_value(const syntax::Name& name) const;
  void name_models(std::uint32_t first, const Dimensions& dimensions) const;
  // A name that may be given to a variable here.
  void check_new(const syntax::Name& name) const;

  // ---- Expressions ----

  Expression expression(const syntax::Term& term) const;
  // An expression of that kind. `what`: "a condition".
  Expression expression(const syntax::Term& term, ValueKind kind, std::string_view what) const;
  // One that no shared variable stands in. `where`: "an index".
  Expression without_shared(Expression expression, TextPlace begin, std::string_view where) const;
  // The indices behind a name, if it is an array's.
  std::vector<Expression> indices(const syntax::Term& name, const Dimensions& dimensions) const;
  // A number that is known at once. `what`: "a bound".
  Value constant(const syntax::Term& term, std::string_view what) const;
  // LOW..HIGH, known at once, LOW at most HIGH.
  Expression::Dimension range(const syntax::Range& range, std::string_view what) const;

  // ---- Types and variables ----

  Dimensions dimensions(const std::vector<syntax::Index>& indices) const;
  ValueType type(const syntax::Type& type) const;
  // An expression of the type's kind. A word that is none of the type's is a slip; a number outside
  // of the range is an error of the run that comes there.
  Expression value_for(const syntax::Term& term, const ValueType& type,
                       const std::string& name) const;
  // A variable of the innermost block.
  Expression declare(const syntax::Name& name, const ValueType& type, const Dimensions& dimensions,
                     bool is_counted = false);
  // Variables of the file that are this program's alone: in scope from its begin, to its end.
  void declare_own();
  // Whether the service is there, as an expression: `true` of one that is so from the begin.
  Expression presence(const syntax::Term& service) const;
  // A variable that can be set, with its indices.
  std::pair<Expression, ValueType> target(const syntax::Term& term) const;
  // What values the expression may have, from the types of its variables.
  ValueType type_of(const Expression& expression) const;

 private:
  const Binding* find_binding(const std::string& name) const;
  // Variables that can be seen here, the program's own and the file's.
  std::vector<std::string> names_of_variables() const;
  // "detector.seen", if in a callback of `detector` this is its variable; else "".
  std::string name_in_node(const std::string& name) const;
  // The expression that a name is. While models are not known, a name that is nothing else may be a
  // word of theirs; expression() fails where no word can stand.
  Expression named(const syntax::Term& term) const;
  [[noreturn]] void fail_unknown(const syntax::Term& term) const;
  // The variable's place among the program's; that of the same declaration in another copy of its
  // procedure, for only one of them has it at a time.
  std::uint32_t make_slots(const syntax::Name& name, const ValueType& type,
                           const Dimensions& dimensions);
  ValueType range_of(const Expression& expression) const;

  Work& work_;
};

}  // namespace maide::program_syntax
