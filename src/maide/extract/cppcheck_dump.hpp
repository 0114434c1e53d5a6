// What `cppcheck --dump` says of a translation unit: for each configuration its tokens, with the
// trees of expressions, and the scopes, functions and variables that it found. References are
// indices into these lists.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace maide::extract {

inline constexpr int nothing = -1;

struct DumpToken {
  std::string text, original;  // `->` is `.`, and stands in original
  std::string file;
  int line = 0, column = 0;  // column 0: made by cppcheck
  int link = nothing;        // the other bracket
  int parent = nothing, left = nothing, right = nothing;
  int scope = nothing, function = nothing, variable = nothing;
  bool is_name = false, is_string = false, is_number = false, is_cast = false;
  bool is_macro = false;  // it came out of a macro
};

struct DumpScope {
  std::string type, name;
  int begin = nothing, end = nothing;  // the braces
  int outer = nothing, function = nothing;
  bool is_read = false;
};

struct DumpFunction {
  std::string name, type;
  int token = nothing, declared = nothing;
  int scope = nothing;  // in which it is declared
  std::vector<int> arguments;
  bool is_virtual = false, is_static = false;
};

struct DumpVariable {
  int name = nothing, type_begin = nothing, type_end = nothing;
  int scope = nothing;
  std::string access;
  bool is_reference = false, is_pointer = false, is_static = false, is_extern = false;
  bool is_const = false;
};

struct DumpClass {
  int scope = nothing;
  std::vector<int> bases;  // the first token of each base's name
};

struct DumpConfiguration {
  std::string name;
  std::vector<DumpToken> tokens;
  std::vector<DumpScope> scopes;
  std::vector<DumpFunction> functions;
  std::vector<DumpVariable> variables;
  std::vector<DumpClass> classes;
};

struct Dump {
  std::vector<std::string> files;
  std::vector<DumpConfiguration> configurations;
};

// Throws ParseError where the text is no such dump. O(text).
Dump read_cppcheck_dump(std::string_view text, const std::string& file);

}  // namespace maide::extract
