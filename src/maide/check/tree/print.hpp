// One style for system files (`maide format`), and how a tree that was made or changed becomes a
// file. Each word, sign and comment is kept, in its order, and whether a map stands in braces.
// Blanks, indentation, line breaks, and quotes around programs and formulas are made alike.
//
//   q : {use: queue,      becomes   q: {use: queue, with: {size: 2}}
//     with: {size: 2}}
#pragma once

#include <cstddef>
#include <string>

#include "maide/check/text/yaml_node.hpp"

namespace maide {

inline constexpr std::size_t layout_width = 100;  // of a line, in bytes

// The text of the document. Values that were read keep their quotes, those that were made get some
// where YAML needs them. What stands in ways that this style has no form for (anchors, tags, lists
// with dashes, comments in braces) is written as it stands.
std::string print_system(const YamlDocument& document);

// The file in the one style. Throws ParseError if it is not YAML, has unknown keys, or a text in it
// does not parse. print_system() of the result is the result.
std::string format_system(const std::string& text, const std::string& file);

// A node of the document on one line, in braces: "{size: 2, depth: 3}".
std::string print_inline(const YamlDocument& document, const YamlNode& node);

}  // namespace maide
