// Statements of a function's body. cppcheck has put braces around each part of a branch and a loop,
// so a statement is told by its first token.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "maide/extract/dump_expressions.hpp"

namespace maide::extract {

class DumpStatements {
 public:
  DumpStatements(const DumpConfiguration& dump, DumpExpressions& expressions,
                 const std::vector<int>& variables)
      : dump_(dump), expressions_(expressions), variables_(variables) {}

  // What stands between the braces.
  std::vector<Statement> read_block(int open);

  // The arguments of a variable's initialiser, whose name is this token; true: behind `=`.
  bool read_initialiser(int name, std::vector<Expression>& arguments);

 private:
  const DumpToken& at(int token) const { return dump_.tokens[static_cast<std::size_t>(token)]; }
  bool is(int token, std::string_view text) const {
    return token >= 0 && token < static_cast<int>(dump_.tokens.size()) && at(token).text == text;
  }
  std::vector<Statement> read_list(int begin, int end);
  Statement read_one(int& token, int end);
  Statement read_branch(int& token);
  Statement read_while(int& token);
  Statement read_for(int& token);
  Statement read_do(int& token);
  Statement read_switch(int& token);
  Statement read_try(int& token);
  Statement read_simple(int& token, int end);
  Statement read_declaration(int begin, int end, int variable, int name);
  Statement opaque(int begin, int end, std::string why);
  Statement make(Statement::Kind kind, int token) const;
  int end_of_simple(int token, int end) const;
  int declared_variable(int begin, int end, int& name) const;
  bool is_lambda_body(int token) const;
  bool are_all_used(int begin, int end, std::string& why) const;

  const DumpConfiguration& dump_;
  DumpExpressions& expressions_;
  const std::vector<int>& variables_;
};

}  // namespace maide::extract
