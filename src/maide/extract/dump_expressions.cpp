#include "maide/extract/dump_expressions.hpp"

#include <cctype>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace maide::extract {

Place DumpExpressions::place(int token) const { return {at(token).file, at(token).line}; }

Expression DumpExpressions::make(Expression::Kind kind, int token, std::string text) const {
  Expression expression;
  expression.kind = kind;
  expression.text = std::move(text);
  expression.place = place(token);
  return expression;
}

void DumpExpressions::use_range(int begin, int end) {
  for (int i = begin; i < end; ++i) use(i);
}

std::string DumpExpressions::text(int begin, int end) const {
  const auto is_word = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) || c == '_';
  };
  std::string all;
  for (int i = begin; i < end; ++i) {
    const std::string& token = at(i).text;
    if (!all.empty() && !token.empty() && is_word(all.back()) && is_word(token.front())) all += ' ';
    all += token;
  }
  return all;
}

std::string DumpExpressions::use_template_arguments(int name) {
  const int next = name + 1;
  if (next >= static_cast<int>(dump_.tokens.size())) return {};
  if (at(next).text != "<" || at(next).link == nothing) return {};
  use_range(next, at(next).link + 1);
  return text(next + 1, at(next).link);
}

Expression DumpExpressions::read(int token) {
  if (token == nothing) return {};
  const DumpToken& here = at(token);
  if (here.text == "::" && here.left != nothing) return read_qualified(token);
  if (here.text == ".") {
    use(token);
    if (here.left == nothing || here.right == nothing || !at(here.right).is_name ||
        at(here.right).left != nothing) {
      return make(Expression::Kind::opaque, token, "a member that is no name");
    }
    Expression member = make(Expression::Kind::member, token, at(here.right).text);
    member.is_arrow = here.original == "->";
    use(here.right);
    member.type = use_template_arguments(here.right);
    member.operands.push_back(read(here.left));
    const DumpToken& name = at(here.right);
    if (name.variable != nothing) {
      member.variable = variables_[static_cast<std::size_t>(name.variable)];
    }
    if (const auto found = functions_.find(name.function); found != functions_.end()) {
      member.function = found->second;
    }
    return member;
  }
  if (here.text == "(") return read_call(token);
  if (here.text == "{") return read_braces(token);
  if (here.text == "[") {
    if (const int body = body_of_lambda(token); body != nothing) return read_lambda(token, body);
    if (here.left == nothing)
      return make(Expression::Kind::opaque, token, "brackets that are no index");
  }
  if (here.left != nothing) return read_operator(token);
  return read_name(token);
}

Expression DumpExpressions::read_name(int token) {
  const DumpToken& here = at(token);
  use(token);
  if (here.is_string) {
    const std::size_t begin = here.text.find('"'), end = here.text.rfind('"');
    if (begin == end) return make(Expression::Kind::literal, token, here.text);
    return make(Expression::Kind::text, token, here.text.substr(begin + 1, end - begin - 1));
  }
  if (!here.is_name) {
    static const std::set<std::string> words{"true", "false", "nullptr", "NULL"};
    if (here.is_number || words.contains(here.text) ||
        (!here.text.empty() && (std::isdigit(static_cast<unsigned char>(here.text[0])) != 0 ||
                                here.text[0] == '\'' || here.text[0] == '.'))) {
      return make(Expression::Kind::literal, token, here.text);
    }
    return make(Expression::Kind::opaque, token, "'" + here.text + "' without operands");
  }
  if (here.text == "this") return make(Expression::Kind::self, token);
  if (here.text == "true" || here.text == "false" || here.text == "nullptr") {
    return make(Expression::Kind::literal, token, here.text);
  }
  static const std::set<std::string> not_built{"co_await", "co_yield", "co_return", "asm",
                                               "goto",     "__asm__",  "throw"};
  if (not_built.contains(here.text)) return make(Expression::Kind::opaque, token, here.text);
  Expression name = make(Expression::Kind::name, token, here.text);
  name.type = use_template_arguments(token);
  if (here.variable != nothing) {
    name.variable = variables_[static_cast<std::size_t>(here.variable)];
  }
  if (const auto found = functions_.find(here.function); found != functions_.end()) {
    name.function = found->second;
  }
  return name;
}

Expression DumpExpressions::read_qualified(int token) {
  const DumpToken& here = at(token);
  use(token);
  Expression left = here.right == nothing ? Expression{} : read(here.left);
  Expression name = read(here.right == nothing ? here.left : here.right);
  if (name.kind != Expression::Kind::name ||
      (left.kind != Expression::Kind::name && left.kind != Expression::Kind::absent)) {
    return make(Expression::Kind::opaque, token, "a qualified name that is none");
  }
  if (!left.text.empty()) name.text = left.text + "::" + name.text;
  if (name.type.empty()) name.type = left.type;
  return name;
}

std::vector<Expression> DumpExpressions::read_arguments(int token) {
  if (token == nothing) return {};
  const DumpToken& here = at(token);
  if (here.text == "," && here.left != nothing && here.right != nothing) {
    use(token);
    std::vector<Expression> all = read_arguments(here.left);
    for (Expression& next : read_arguments(here.right)) all.push_back(std::move(next));
    return all;
  }
  std::vector<Expression> one;
  one.push_back(read(token));
  return one;
}

bool DumpExpressions::is_type_in_brackets(int token) const {
  // ( void ( A :: * ) ( ... ) ): a pointer to a member.
  const int end = at(token).link;
  if (end == nothing || at(token).text != "(") return false;
  for (int i = token + 1; i + 3 < end; ++i) {
    if (at(i).text == "::" && at(i + 1).text == "*" && at(i + 2).text == ")" &&
        at(i + 3).text == "(" && at(i + 3).link == end - 1) {
      return true;
    }
  }
  return false;
}

Expression DumpExpressions::read_call(int token) {
  const DumpToken& here = at(token);
  use(token);
  if (here.link != nothing) use(here.link);
  if (here.is_cast && here.right == nothing) {  // (int) x
    Expression cast = make(Expression::Kind::cast, token);
    cast.type = text(token + 1, here.link);
    use_range(token + 1, here.link);
    cast.operands.push_back(read(here.left));
    return cast;
  }
  if (here.left == nothing)
    return make(Expression::Kind::opaque, token, "brackets without a function");
  Expression callee = read(here.left);
  static const std::set<std::string> casts{"static_cast", "dynamic_cast", "const_cast",
                                           "reinterpret_cast"};
  if (callee.kind == Expression::Kind::name && casts.contains(callee.text)) {
    Expression cast = make(Expression::Kind::cast, token, callee.text);
    cast.type = callee.type;
    cast.operands.push_back(read(here.right));
    return cast;
  }
  if (callee.kind == Expression::Kind::name &&
      (callee.text == "sizeof" || callee.text == "decltype" || callee.text == "alignof" ||
       callee.text == "typeid")) {
    use_range(token + 1, here.link);
    return make(Expression::Kind::literal, token, "0");
  }
  Expression call = make(Expression::Kind::call, token);
  call.operands.push_back(std::move(callee));
  for (Expression& argument : read_arguments(here.right)) {
    call.operands.push_back(std::move(argument));
  }
  return call;
}

Expression DumpExpressions::read_braces(int token) {
  const DumpToken& here = at(token);
  use(token);
  if (here.link != nothing) use(here.link);
  const DumpToken& before = at(token - 1);
  const bool has_type =
      here.left != nothing && (before.is_name || before.text == ">") && here.left < token;
  Expression braces = make(has_type ? Expression::Kind::construct : Expression::Kind::list, token);
  if (has_type) {
    const Expression type = read(here.left);
    if (type.kind != Expression::Kind::name)
      return make(Expression::Kind::opaque, token, "braces behind no type");
    braces.text = type.text;
    braces.type = type.type;
    braces.variable = type.variable;
  }
  braces.operands = read_arguments(has_type ? here.right : here.left);
  return braces;
}

int DumpExpressions::body_of_lambda(int token) const {
  const int left = at(token).left;
  if (left == nothing) return nothing;
  if (at(left).text == "{") return left;
  if (at(left).text != "(" || at(left).left == nothing) return nothing;
  const int body = at(left).left;
  return at(body).text == "{" && body > left ? body : nothing;
}

Expression DumpExpressions::read_lambda(int token, int body) {
  Expression lambda = make(Expression::Kind::lambda, token);
  use_range(token, body);  // captures, parameters, what is returned
  // Captures with values are expressions of their own: they need a rule.
  for (int i = token + 1; i < at(token).link; ++i) {
    const bool is_value = at(i).text == "=" && at(i + 1).text != "," && at(i + 1).text != "]";
    if (is_value || at(i).text == "(" || at(i).text == "{") {
      return make(Expression::Kind::opaque, token, "a lambda that captures a value");
    }
  }
  for (int i = at(token).link + 1; i < body; ++i) {
    if (at(i).text != "=" && at(i).text != "noexcept") continue;
    return make(Expression::Kind::opaque, token,
                "a lambda with '" + at(i).text + "' behind its captures");
  }
  const DumpScope& scope = dump_.scopes[static_cast<std::size_t>(at(body).scope)];
  const auto found = functions_.find(scope.function);
  if (scope.type != "Lambda" || found == functions_.end()) {
    return make(Expression::Kind::opaque, token, "a lambda without a body");
  }
  lambda.function = found->second;
  return lambda;
}

Expression DumpExpressions::read_operator(int token) {
  const DumpToken& here = at(token);
  use(token);
  if (here.text == "&" && here.right != nothing && is_type_in_brackets(here.left)) {
    Expression cast = make(Expression::Kind::cast, token);
    use_range(here.left, at(here.left).link + 1);
    cast.operands.push_back(read(here.right));
    return cast;
  }
  static const std::set<std::string> assignments{
      "=", "+=", "-=", "*=", "/=", "%=", "&=", "|=", "^=", "<<=", ">>="};
  static const std::set<std::string> known{
      "+", "-", "*", "/", "%", "<",  ">",  "<=", ">=", "==",  "!=",  "<<",    ">>",
      "&", "|", "^", "!", "~", "++", "--", "[",  ",",  "<=>", "new", "delete"};
  if (here.text == "new" && at(token + 1).text == "(") {
    use_range(token + 1, at(token + 1).link + 1);
    return make(Expression::Kind::opaque, token, "'new' at a place, or one that may fail");
  }
  Expression node = make(Expression::Kind::other, token, here.text);
  if (here.text == "?") {
    node.kind = Expression::Kind::conditional;
    node.operands.push_back(read(here.left));
    if (here.right == nothing || at(here.right).text != ":") {
      return make(Expression::Kind::opaque, token, "a conditional without its sides");
    }
    use(here.right);
    node.operands.push_back(read(at(here.right).left));
    node.operands.push_back(read(at(here.right).right));
    return node;
  }
  if (here.text == "&&" || here.text == "||") {
    if (here.right == nothing)
      return make(Expression::Kind::opaque, token, "'" + here.text + "' of one value");
    node.kind = here.text == "&&" ? Expression::Kind::conjunction : Expression::Kind::disjunction;
  } else if (assignments.contains(here.text)) {
    node.kind = Expression::Kind::assign;
  } else if (!known.contains(here.text)) {
    return make(Expression::Kind::opaque, token, "'" + here.text + "'");
  }
  if (here.text == "[" && here.link != nothing) use(here.link);
  node.operands.push_back(read(here.left));
  if (here.right != nothing) node.operands.push_back(read(here.right));
  return node;
}

}  // namespace maide::extract
