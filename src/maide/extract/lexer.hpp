// A lexer of C++ that shares nothing with the front end. It says which names stand in the text in
// front of a bracket; what the front end did not show of them was lost on the way.
#pragma once

#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "maide/extract/sources.hpp"

namespace maide::extract {

struct LexedFile {
  std::vector<Mention> calls;  // names in front of `(`, `<...>(` or `{`, outside of directives
  std::vector<std::pair<int, std::string>> directives;  // line, text
  std::vector<std::string> macros;                      // that are defined here
  std::vector<std::string> namespaces;                  // behind `using namespace`
  std::set<int> code_lines;                             // lines of what is no directive
  std::vector<std::string> aliases;  // using NAME = ...: the front end puts the type in its place
};

LexedFile lex_cpp(std::string_view text, const std::string& file);

// The text as cppcheck 2.10 can read it: times such as `500ms` are calls; formats such as PRId64
// and the registration of components, whose classes are returned, are blank. Lines stay where they
// are.
std::string prepare_cpp(std::string_view text, std::vector<std::string>& components);

}  // namespace maide::extract
