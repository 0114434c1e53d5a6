// What front ends give: the functions of all sources as trees. There is one schema for every
// language.
//
//   function: parameters, initialisers (of constructors), statements
//   statement: expression, declaration, branch, loop, choice (switch), return, break, continue,
//              block, attempt (try), opaque
//   expression: name, member, call, lambda, assignment, logical and/or, conditional, other
//
// What a front end has no rule for is `opaque`, with a reason: it becomes a hole. Each statement
// and each expression has its place, file and line.
#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <tuple>
#include <vector>

namespace maide::extract {

inline constexpr int none = -1;

struct Place {
  std::string file;
  int line = 0;
  auto operator<=>(const Place&) const = default;
};

inline std::string to_string(const Place& place) {
  return place.file + ":" + std::to_string(place.line);
}

struct Expression {
  enum class Kind : std::uint8_t {
    absent,       // an argument that is not there
    literal,      // text
    text,         // a string, without quotes
    name,         // text, qualified; variable or function if the front end linked it
    self,         // this
    member,       // operands[0] . text
    call,         // operands[0] is called with the others
    construct,    // type{operands}
    list,         // {operands}
    lambda,       // function
    assign,       // operands[0] text operands[1]; text is `=`, `+=`, ...
    conjunction,  // &&
    disjunction,  // ||
    conditional,  // operands[0] ? operands[1] : operands[2]
    cast,         // operands[0] as type
    other,        // text is an operator
    opaque,       // text is the reason
  };
  Kind kind = Kind::absent;
  std::string text;
  std::string type;  // template arguments of a name; of a cast or construct what is made
  int variable = none, function = none;
  bool is_arrow = false;  // of a member: behind `->`
  std::vector<Expression> operands;
  Place place;
};

struct Statement {
  enum class Kind : std::uint8_t {
    expression,
    declaration,  // variable, with the arguments of its constructor or what it is set to
    branch,       // expressions[0]; blocks: then, else
    loop,         // expressions: condition, step; blocks: init, body
    range,        // over expressions[0]; variable; blocks: body
    repeat,       // do blocks[0] while expressions[0]
    choice,  // switch: expressions[0]; blocks: each arm, which falls into the next unless ended
    returns,
    breaks,
    continues,
    throws,
    block,
    attempt,  // blocks: what is tried, handlers
    opaque,   // text is the reason
  };
  Kind kind = Kind::expression;
  Place place;
  std::string text;
  int variable = none;
  bool is_set = false;       // a declaration with `=`: the only expression is its value
  bool has_default = false;  // of a choice; of an attempt: its last handler takes everything
  std::vector<Expression> expressions;
  std::vector<std::vector<Statement>> blocks;
};

struct Variable {
  std::string name, type;  // the type as it is written, without blanks
  std::string of_class;    // of a member; empty: a local, a parameter or a global
  bool is_local = false, is_static = false, is_extern = false;
  bool is_reference = false, is_pointer = false, is_array = false;
  bool has_value = false;  // initialiser: arguments
  bool is_set = false;     // with `=`
  std::vector<Expression> arguments;
  std::string text;  // of a member, from its name on, as the front end has it
  Place place;
};

struct Initialiser {
  std::string member;  // or a base, or the class itself
  std::vector<Expression> arguments;
  Place place;
};

struct Function {
  std::string name;             // without its class
  std::string of_class;         // qualified; empty: free
  std::string scope;            // namespace of a free function
  std::vector<int> parameters;  // variables; none: without a name
  std::vector<std::string> parameter_types;
  std::vector<std::vector<Expression>> defaults;  // none or one for each parameter
  std::vector<Initialiser> initialisers;
  std::vector<Statement> body;
  bool is_virtual = false, is_static = false, is_constructor = false, is_destructor = false;
  bool is_lambda = false, is_template = false, is_noexcept = false;
  std::string text;  // of the body, as the front end has it
  Place place;

  std::string full_name() const {
    if (!of_class.empty()) return of_class + "::" + name;
    return scope.empty() ? name : scope + "::" + name;
  }
};

// A function that is declared, without its body.
struct Declaration {
  std::string name;  // full
  bool is_method = false;
  std::vector<std::string> parameters;  // their types
};

struct Class {
  std::string name;  // qualified
  std::vector<std::string> bases;
  std::vector<int> members;        // variables
  std::set<std::string> declared;  // functions that are declared, with or without a body
  bool is_enumeration = false;
  Place place;
};

// An identifier at a place of the text: `file`, line, name.
using Mention = std::tuple<std::string, int, std::string>;

struct Sources {
  std::vector<Function> functions;
  std::map<std::string, Class> classes;
  std::vector<Variable> variables;
  std::vector<std::string> components;                // classes that are registered as such
  std::set<std::string> namespaces;                   // behind `using namespace`
  std::vector<Declaration> declarations;              // that had no body in their file
  std::map<Mention, int> mentions;                    // how often code that was read names it
  std::vector<std::pair<Place, std::string>> faults;  // what could not be read
  std::map<std::string, std::string> texts;           // of the files

  // The file in which functions of the class have their bodies.
  std::string text_of(const Class& entry) const {
    for (const Function& function : functions) {
      if (function.of_class != entry.name || !function.is_constructor) continue;
      const auto found = texts.find(function.place.file);
      return found == texts.end() ? std::string{} : found->second;
    }
    return {};
  }
};

}  // namespace maide::extract
