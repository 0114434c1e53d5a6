// Expressions of a dump as trees, and the account of which tokens were used.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "maide/extract/cppcheck_dump.hpp"
#include "maide/extract/sources.hpp"

namespace maide::extract {

class DumpExpressions {
 public:
  // The maps say where the variables and functions of the dump are among those of the sources.
  DumpExpressions(const DumpConfiguration& dump, const std::vector<int>& variables,
                  const std::map<int, int>& functions)
      : dump_(dump), variables_(variables), functions_(functions), uses_(dump.tokens.size(), 0) {}

  Expression make(Expression::Kind kind, int token, std::string text = {}) const;
  Expression read(int token);
  // The arguments of a bracket: none, one or several between commas.
  std::vector<Expression> read_arguments(int token);

  void use(int token) { ++uses_[static_cast<std::size_t>(token)]; }
  void use_range(int begin, int end);  // end is not in it
  int uses(int token) const { return uses_[static_cast<std::size_t>(token)]; }
  Place place(int token) const;
  // The tokens of [begin, end) without blanks, but for those between words.
  std::string text(int begin, int end) const;

 private:
  const DumpToken& at(int token) const { return dump_.tokens[static_cast<std::size_t>(token)]; }
  Expression read_name(int token);
  Expression read_qualified(int token);
  Expression read_call(int token);
  Expression read_braces(int token);
  Expression read_lambda(int token, int body);
  Expression read_operator(int token);
  bool is_type_in_brackets(int token) const;
  std::string use_template_arguments(int name);
  int body_of_lambda(int token) const;

  const DumpConfiguration& dump_;
  const std::vector<int>& variables_;
  const std::map<int, int>& functions_;
  std::vector<unsigned char> uses_;
};

}  // namespace maide::extract
