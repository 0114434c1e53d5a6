// What the readers of a program's text, of its procedures and of the file's declarations share: the
// text's tokens, its names and what they stand for, types and variables.
#pragma once

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "maide/check/language/expression_parser.hpp"
#include "maide/check/language/program_syntax.hpp"
#include "maide/check/text/tokens.hpp"

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
  Work(const Context& known, const ScalarText& text) : context(&known), position(text.position(0)) {
    scopes.emplace_back();  // of the indices of an array
    for (const auto& [name, index] : known.indices) {
      scopes.back().names[name] = {Binding::Kind::constant, index, {}, false, nullptr};
    }
  }

  const Context* context;   // of the text that is read next
  SourcePosition position;  // where the text begins
  Tree tree;
  std::vector<Scope> scopes;
  std::map<std::string, SourcePosition> label_places;
  std::map<std::tuple<int, int, std::string>, std::uint32_t> slot_places;
  std::map<std::string, Binding> own;  // variables of the file that are the program's alone
  std::vector<std::string> calls;
  std::set<std::uint32_t> asked;  // services that the callback which is read may ask
  std::set<std::uint32_t> names;
  std::size_t statements = 0;
  int nesting = 0, loops = 0;
};

class NameParser {
 public:
  NameParser(const ScalarText& text, Work& work);

 protected:
  template <typename Range>
  static bool contains(const Range& range, std::string_view what) {
    return std::find(std::begin(range), std::end(range), what) != std::end(range);
  }
  // Keywords that begin a statement.
  static bool begins_statement(const Token& word);
  // Those, and the keywords inside of statements.
  static bool is_reserved(const Token& word);
  static std::vector<std::string> statement_keywords();

  void expect_end();

  // ---- names ------------------------------------------------------------------------------------

  const Binding* find_binding(const std::string& name) const;
  // Variables that can be seen here, the program's own and the file's.
  std::vector<std::string> names_of_variables() const;
  // What the name stands for, here or in the file; nothing of a name that is not known.
  std::optional<Binding> find(const std::string& name) const;
  // "detector.seen", if in a callback of `detector` this is its variable; else "".
  std::string name_in_node(const std::string& name) const;
  void name_models(std::uint32_t first, const Dimensions& dimensions) const;
  Expression resolve(const Token& name);
  Expression without_shared(Expression expression, const Token& first, std::string_view where);
  Token parse_new_name(std::string_view what);

  // ---- types and variables ----------------------------------------------------------------------

  // [i in LOW..HIGH, ...], or [LOW..HIGH].
  Dimensions parse_dimensions(std::vector<std::string>* indices = nullptr);
  ValueType parse_type();
  // An expression of the type's kind. A word that is none of the type's is a slip; a number outside
  // of the range is an error of the run that comes there.
  Expression parse_value_for(const ValueType& type, const std::string& name);
  // The variable's place among the program's; that of the same declaration in another copy of its
  // procedure, for only one of them has it at a time.
  std::uint32_t make_slots(const Token& name, const ValueType& type, const Dimensions& dimensions);
  Expression declare(const Token& name, const ValueType& type, const Dimensions& dimensions,
                     bool is_counted = false);
  // Variables of the file that are this program's alone: in scope from its begin, to its end.
  void declare_own();
  // A variable that can be set, with its indices.
  std::pair<Expression, ValueType> parse_target();
  // What values the expression may have, from the types of its variables.
  ValueType type_of(const Expression& expression) const;
  ValueType range_of(const Expression& expression) const;

  TokenStream tokens_;
  Work& work_;
  const Context& context_;
  ExpressionParser expressions_;
};

}  // namespace maide::program_syntax
