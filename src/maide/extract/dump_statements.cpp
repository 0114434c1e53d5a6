#include "maide/extract/dump_statements.hpp"

#include <algorithm>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace maide::extract {

Statement DumpStatements::make(Statement::Kind kind, int token) const {
  Statement statement;
  statement.kind = kind;
  statement.place = expressions_.place(token);
  return statement;
}

Statement DumpStatements::opaque(int begin, int end, std::string why) {
  expressions_.use_range(begin, end);
  Statement statement = make(Statement::Kind::opaque, begin);
  statement.text = std::move(why);
  return statement;
}

std::vector<Statement> DumpStatements::read_block(int open) {
  expressions_.use(open);
  expressions_.use(at(open).link);
  return read_list(open + 1, at(open).link);
}

std::vector<Statement> DumpStatements::read_list(int begin, int end) {
  std::vector<Statement> list;
  for (int token = begin; token < end;) {
    if (is(token, ";")) {
      expressions_.use(token++);
      continue;
    }
    list.push_back(read_one(token, end));
  }
  return list;
}

Statement DumpStatements::read_one(int& token, int end) {
  const std::string& word = at(token).text;
  if (word == "{") {
    const DumpScope& scope = dump_.scopes[static_cast<std::size_t>(at(token).scope)];
    const int close = at(token).link;
    if (scope.type != "Unconditional" || scope.begin != token || is(token - 1, "]") ||
        is(token - 1, ")")) {
      Statement hole = opaque(token, close + 1, "a block that belongs to nothing");
      token = close + 1;
      return hole;
    }
    Statement block = make(Statement::Kind::block, token);
    block.blocks.push_back(read_block(token));
    token = close + 1;
    return block;
  }
  if (word == "if") return read_branch(token);
  if (word == "while") return read_while(token);
  if (word == "for") return read_for(token);
  if (word == "do") return read_do(token);
  if (word == "switch") return read_switch(token);
  if (word == "try") return read_try(token);
  return read_simple(token, end);
}

Statement DumpStatements::read_branch(int& token) {
  Statement branch = make(Statement::Kind::branch, token);
  const int begin = token;
  expressions_.use(token++);
  if (is(token, "constexpr")) expressions_.use(token++);
  const int bracket = token;
  const int body = is(bracket, "(") ? at(bracket).link + 1 : bracket;
  if (!is(bracket, "(") || !is(body, "{") || at(bracket).right == nothing) {
    const int stop = end_of_simple(token, static_cast<int>(dump_.tokens.size()));
    token = stop;
    return opaque(begin, stop, "an if of no known form");
  }
  expressions_.use(bracket);
  expressions_.use(at(bracket).link);
  std::string why;
  int name = nothing;
  const int variable = declared_variable(bracket + 1, at(bracket).link, name);
  if (variable != nothing) {  // if (auto x = ...)
    branch.variable = variables_[static_cast<std::size_t>(variable)];
    if (is(name + 1, "=") && at(name + 1).right != nothing) {
      branch.expressions.push_back(expressions_.read(at(name + 1).right));
      for (int i = bracket + 1; i <= name + 1; ++i) {
        if (expressions_.uses(i) == 0) expressions_.use(i);
      }
    }
  } else {
    branch.expressions.push_back(expressions_.read(at(bracket).right));
  }
  const bool is_whole = are_all_used(bracket, body, why);
  branch.blocks.push_back(read_block(body));
  token = at(body).link + 1;
  branch.blocks.emplace_back();
  if (is(token, "else") && is(token + 1, "{")) {
    expressions_.use(token);
    branch.blocks[1] = read_block(token + 1);
    token = at(token + 1).link + 1;
  }
  if (!is_whole) return opaque(begin, begin, why);
  return branch;
}

Statement DumpStatements::read_while(int& token) {
  Statement loop = make(Statement::Kind::loop, token);
  const int begin = token, bracket = token + 1;
  const int body = is(bracket, "(") ? at(bracket).link + 1 : bracket;
  if (!is(bracket, "(") || !is(body, "{")) {
    token = end_of_simple(token, static_cast<int>(dump_.tokens.size()));
    return opaque(begin, token, "a while of no known form");
  }
  expressions_.use(token);
  expressions_.use(bracket);
  expressions_.use(at(bracket).link);
  loop.expressions.push_back(expressions_.read(at(bracket).right));
  loop.expressions.emplace_back();
  std::string why;
  const bool is_whole = are_all_used(bracket, body, why);
  loop.blocks.emplace_back();
  loop.blocks.push_back(read_block(body));
  token = at(body).link + 1;
  return is_whole ? loop : opaque(begin, begin, why);
}

Statement DumpStatements::read_for(int& token) {
  Statement loop = make(Statement::Kind::loop, token);
  const int begin = token, bracket = token + 1;
  const int body = is(bracket, "(") ? at(bracket).link + 1 : bracket;
  const int head = is(bracket, "(") ? at(bracket).right : nothing;
  if (!is(body, "{") || head == nothing) {
    token = end_of_simple(token, static_cast<int>(dump_.tokens.size()));
    return opaque(begin, token, "a for of no known form");
  }
  expressions_.use(token);
  expressions_.use(bracket);
  expressions_.use(at(bracket).link);
  bool is_whole = true;
  std::string why;
  if (is(head, ":")) {
    loop.kind = Statement::Kind::range;
    expressions_.use_range(bracket + 1, head + 1);
    int name = nothing;
    const int variable = declared_variable(bracket + 1, head, name);
    if (variable != nothing) loop.variable = variables_[static_cast<std::size_t>(variable)];
    loop.expressions.push_back(expressions_.read(at(head).right));
  } else if (is(head, ";") && is(at(head).right, ";")) {
    const int first = head, second = at(head).right;
    expressions_.use(first);
    expressions_.use(second);
    if (first > bracket + 1) {
      int start = bracket + 1;
      loop.blocks.push_back({read_simple(start, first)});
    } else {
      loop.blocks.emplace_back();
    }
    loop.expressions.push_back(expressions_.read(at(second).left));
    loop.expressions.push_back(expressions_.read(at(second).right));
  } else {
    is_whole = false;
    why = "a for of no known form";
    expressions_.use_range(bracket + 1, at(bracket).link);
  }
  is_whole = is_whole && are_all_used(bracket, body, why);
  loop.blocks.push_back(read_block(body));
  token = at(body).link + 1;
  return is_whole ? loop : opaque(begin, begin, why);
}

Statement DumpStatements::read_do(int& token) {
  Statement loop = make(Statement::Kind::repeat, token);
  const int begin = token, body = token + 1;
  expressions_.use(token);
  if (!is(body, "{") || !is(at(body).link + 1, "while")) {
    token = end_of_simple(token, static_cast<int>(dump_.tokens.size()));
    return opaque(begin, token, "a do of no known form");
  }
  loop.blocks.push_back(read_block(body));
  const int bracket = at(body).link + 2;
  expressions_.use(bracket - 1);
  expressions_.use(bracket);
  expressions_.use(at(bracket).link);
  loop.expressions.push_back(expressions_.read(at(bracket).right));
  std::string why;
  const bool is_whole = are_all_used(bracket, at(bracket).link + 1, why);
  token = at(bracket).link + 1;
  return is_whole ? loop : opaque(begin, begin, why);
}

Statement DumpStatements::read_switch(int& token) {
  Statement choice = make(Statement::Kind::choice, token);
  const int begin = token, bracket = token + 1;
  const int body = is(bracket, "(") ? at(bracket).link + 1 : bracket;
  if (!is(bracket, "(") || !is(body, "{")) {
    token = end_of_simple(token, static_cast<int>(dump_.tokens.size()));
    return opaque(begin, token, "a switch of no known form");
  }
  for (const int sign : {begin, bracket, at(bracket).link, body, at(body).link}) {
    expressions_.use(sign);
  }
  choice.expressions.push_back(expressions_.read(at(bracket).right));
  const int end = at(body).link;
  token = end + 1;
  int arm = nothing;
  for (int i = body + 1; i < end;) {
    if (is(i, "case") || is(i, "default")) {
      choice.has_default = choice.has_default || is(i, "default");
      while (i < end && !(is(i, ":") && !is(i - 1, ":"))) expressions_.use(i++);
      expressions_.use(i++);
      arm = i;
      choice.blocks.emplace_back();
      continue;
    }
    if (is(i, ";")) {
      expressions_.use(i++);
      continue;
    }
    if (arm == nothing) return opaque(i, end, "code before the first case");
    choice.blocks.back().push_back(read_one(i, end));
  }
  return choice;
}

Statement DumpStatements::read_try(int& token) {
  Statement attempt = make(Statement::Kind::attempt, token);
  const int begin = token;
  expressions_.use(token++);
  if (!is(token, "{")) {
    token = end_of_simple(token, static_cast<int>(dump_.tokens.size()));
    return opaque(begin, token, "a try of no known form");
  }
  attempt.blocks.push_back(read_block(token));
  token = at(token).link + 1;
  while (is(token, "catch") && is(token + 1, "(") && is(at(token + 1).link + 1, "{")) {
    const int body = at(token + 1).link + 1;
    expressions_.use_range(token, body);
    attempt.has_default = is(token + 2, "...") || is(token + 2, ".");
    attempt.blocks.push_back(read_block(body));
    token = at(body).link + 1;
  }
  return attempt;
}

int DumpStatements::end_of_simple(int token, int end) const {
  while (token < end && !is(token, ";") && !is(token, "}")) {
    const int link = at(token).link;
    token = link > token ? link + 1 : token + 1;
  }
  return std::min(token, end);
}

int DumpStatements::declared_variable(int begin, int end, int& name) const {
  for (int i = begin; i < end; ++i) {
    const int link = at(i).link;
    if (link > i) {
      i = link;
      continue;
    }
    const int variable = at(i).variable;
    if (variable != nothing && dump_.variables[static_cast<std::size_t>(variable)].name == i) {
      name = i;
      return variable;
    }
  }
  return nothing;
}

bool DumpStatements::read_initialiser(int name, std::vector<Expression>& arguments) {
  int next = name + 1;
  while (is(next, "[")) {
    for (int i = next + 1; i < at(next).link; ++i) {
      if (!is(i, "(") && !is(i, "{")) continue;
      arguments.push_back(
          expressions_.make(Expression::Kind::opaque, i, "a size that is called for"));
      break;
    }
    expressions_.use_range(next, at(next).link + 1);
    next = at(next).link + 1;
  }
  if (is(next, ";") && is(next + 1, at(name).text) && is(next + 2, "=") &&
      at(next + 1).variable == at(name).variable) {
    expressions_.use_range(next, next + 2);
    next += 2;
  }
  if (is(next, "=") && at(next).right != nothing) {
    expressions_.use(next);
    arguments.push_back(expressions_.read(at(next).right));
    return true;
  }
  if (is(next, "(") || is(next, "{")) {
    expressions_.use(next);
    expressions_.use(at(next).link);
    const int inner = at(next).right != nothing               ? at(next).right
                      : is(next, "{") && at(next).left > next ? at(next).left
                                                              : nothing;
    for (Expression& argument : expressions_.read_arguments(inner)) {
      arguments.push_back(std::move(argument));
    }
  }
  return false;
}

Statement DumpStatements::read_declaration(int begin, int end, int variable, int name) {
  Statement statement = make(Statement::Kind::declaration, name);
  statement.variable = variables_[static_cast<std::size_t>(variable)];
  for (int i = begin; i <= name; ++i) {
    if (expressions_.uses(i) == 0) expressions_.use(i);
  }
  statement.is_set = read_initialiser(name, statement.expressions);
  (void)end;
  return statement;
}

Statement DumpStatements::read_simple(int& token, int end) {
  const int begin = token;
  const int stop = end_of_simple(token, end);
  token = stop;
  const std::string& word = at(begin).text;
  static const std::set<std::string> passive{"using", "typedef", "static_assert"};
  if (passive.contains(word)) {
    expressions_.use_range(begin, stop);
    return make(Statement::Kind::block, begin);
  }
  if ((word == "struct" || word == "class" || word == "enum" || word == "union") &&
      dump_.scopes[static_cast<std::size_t>(at(begin).scope)].begin != begin) {
    bool has_body = false;
    for (int i = begin; i < stop; ++i) has_body = has_body || is(i, "{");
    if (has_body) {  // its functions are read as those of other classes
      expressions_.use_range(begin, stop);
      return make(Statement::Kind::block, begin);
    }
  }
  static const std::set<std::string> no_rule{"goto",  "co_await", "co_return", "co_yield",
                                             "asm",   "__asm__",  "case",      "default",
                                             "catch", "else"};
  if (no_rule.contains(word)) return opaque(begin, stop, word);
  if (is(begin + 1, ":") && at(begin).is_name && !is(begin + 2, ":")) {
    token = begin + 2;
    return opaque(begin, begin + 2, "a label, '" + word + "'");
  }
  Statement statement = make(Statement::Kind::expression, begin);
  std::string why;
  if (word == "break" || word == "continue") {
    expressions_.use(begin);
    statement.kind = word == "break" ? Statement::Kind::breaks : Statement::Kind::continues;
  } else if (word == "return") {
    expressions_.use(begin);
    statement.kind = Statement::Kind::returns;
    if (at(begin).left != nothing)
      statement.expressions.push_back(expressions_.read(at(begin).left));
  } else if (word == "throw") {
    expressions_.use(begin);
    statement.kind = Statement::Kind::throws;
    if (at(begin).left != nothing) {
      statement.expressions.push_back(expressions_.read(at(begin).left));
    }
  } else {
    int name = nothing;
    const int variable = declared_variable(begin, stop, name);
    if (variable != nothing) {
      statement = read_declaration(begin, stop, variable, name);
    } else {
      for (int i = begin; i < stop; ++i) {
        if (is_lambda_body(i)) i = at(i).link;
        if (at(i).parent == nothing && at(i).left != nothing && expressions_.uses(i) == 0) {
          statement.expressions.push_back(expressions_.read(i));
        }
      }
    }
  }
  if (!are_all_used(begin, stop, why)) {
    Statement hole = make(Statement::Kind::opaque, begin);
    hole.text = why;
    return hole;
  }
  return statement;
}

bool DumpStatements::is_lambda_body(int token) const {
  if (at(token).text != "{" || at(token).link <= token) return false;
  const DumpScope& scope = dump_.scopes[static_cast<std::size_t>(at(token).scope)];
  return scope.type == "Lambda" && scope.begin == token;
}

bool DumpStatements::are_all_used(int begin, int end, std::string& why) const {
  static const std::set<std::string> silent{"(", ")", ",", "]", "}", ">"};
  for (int i = begin; i < end; ++i) {
    const DumpToken& token = at(i);
    if (is_lambda_body(i)) {  // it is read as a function
      i = token.link;
      continue;
    }
    if (expressions_.uses(i) > 0) continue;
    if (silent.contains(token.text) && token.left == nothing) continue;
    why = "'" + token.text + "' is in no tree of the front end";
    return false;
  }
  return true;
}

}  // namespace maide::extract
