// Readers of the file's declarations: variables, constants, and the keys of models, programs,
// arrays and procedures.
#include <string>
#include <utility>
#include <vector>

#include "maide/check/language/name_parser.hpp"

namespace maide::program_syntax {
namespace {

class DeclarationParser : public NameParser {
 public:
  using NameParser::NameParser;

  std::vector<VariableName> parse_variables() {
    std::vector<VariableName> result;
    work_.scopes.push_back({{}, nullptr, false});
    while (tokens_.peek().kind != Token::Kind::end) {
      tokens_.expect("var", "before a variable");
      const Token name = parse_new_name("a variable");
      VariableName variable;
      variable.position = tokens_.position(name);
      variable.leaf.name = name.text;
      variable.leaf.dimensions = parse_dimensions();
      tokens_.expect(":", "between a variable and its type");
      variable.type = parse_type();
      variable.leaf.kind = variable.type.kind;
      variable.initial = variable.type.at(0);
      if (tokens_.accept("=")) {
        const Token first = tokens_.peek();
        const Expression value = parse_value_for(variable.type, name.text);
        if (!value.is_constant()) tokens_.fail("the first value must be known here", first);
        if (!variable.type.contains(value.value)) {
          tokens_.fail("the first value is outside of " + to_string(variable.type, context_.words),
                       first);
        }
        variable.initial = value.value;
      }
      tokens_.expect(";", "at the end of a variable");
      result.push_back(std::move(variable));
    }
    return result;
  }

  Expression parse_constant() {
    const Token first = tokens_.peek();
    Expression value = expressions_.parse();
    if (!value.is_constant()) {
      tokens_.fail("this constant has no value: it divides by zero, or is too large for 64 bits",
                   first);
    }
    expect_end();
    return value;
  }

  Declared parse_declared() {
    const Token name = tokens_.next();
    if (!name.is_name()) tokens_.fail("expected a name, not " + to_string(name), name);
    Declared declared;
    declared.name = name.text;
    declared.dimensions = parse_dimensions(&declared.indices);
    expect_end();
    return declared;
  }

  std::vector<Value> parse_member(const Dimensions& dimensions, bool is_whole) {
    const Token name = tokens_.next();
    std::vector<Value> indices;
    for (const Expression& index : expressions_.parse_indices(dimensions, name)) {
      if (!index.is_constant()) tokens_.fail("an index is known here", name);
      indices.push_back(index.value);
    }
    if (is_whole) expect_end();
    return indices;
  }

  Procedure parse_head(std::string& name) {
    const Token first = tokens_.next();
    if (!first.is_name())
      tokens_.fail("expected a procedure's name, not " + to_string(first), first);
    name = first.text;
    Procedure procedure;
    procedure.position = tokens_.position(first);
    tokens_.expect("(", "behind a procedure's name");
    while (!tokens_.accept(")")) {
      if (!procedure.parameters.empty()) tokens_.expect(",", "between parameters");
      const Token parameter = tokens_.next();
      if (!parameter.is_name()) {
        tokens_.fail("expected a parameter, not " + to_string(parameter), parameter);
      }
      if (contains(procedure.parameters, parameter.text)) {
        tokens_.fail("the parameter '" + parameter.text + "' is there twice", parameter);
      }
      procedure.parameters.push_back(parameter.text);
    }
    expect_end();
    return procedure;
  }
};

// Reads one text with a parser of its own.
template <typename Read>
auto read(const ScalarText& text, const Context& context, Read&& read) {
  Work work(context, text);
  DeclarationParser parser(text, work);
  return read(parser);
}

}  // namespace

std::vector<VariableName> parse_variables(const ScalarText& text, const Context& context) {
  return read(text, context, [](DeclarationParser& parser) { return parser.parse_variables(); });
}

Expression parse_constant(const ScalarText& text, const Context& context) {
  return read(text, context, [](DeclarationParser& parser) { return parser.parse_constant(); });
}

Declared parse_declared(const ScalarText& text, const Context& context) {
  return read(text, context, [](DeclarationParser& parser) { return parser.parse_declared(); });
}

std::vector<Value> parse_member(const ScalarText& text, const Context& context,
                                const Dimensions& dimensions) {
  return read(text, context,
              [&](DeclarationParser& parser) { return parser.parse_member(dimensions, true); });
}

std::vector<Value> parse_member_before(const ScalarText& text, const Context& context,
                                       const Dimensions& dimensions) {
  return read(text, context,
              [&](DeclarationParser& parser) { return parser.parse_member(dimensions, false); });
}

Procedure parse_head(const ScalarText& text, const Context& context, std::string& name) {
  return read(text, context, [&](DeclarationParser& parser) { return parser.parse_head(name); });
}

}  // namespace maide::program_syntax
