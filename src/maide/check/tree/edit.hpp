// Small changes of a system file, of which all that they do not touch stays as it was written.
// Larger ones are made on a copy of the document (YamlNode::at(), set(), remove()) and printed.
#pragma once

#include <string>

#include "maide/check/text/yaml_node.hpp"

namespace maide {

// The text with another value in place of the node's, which was read from it. Where anchors stand
// in the file, they are written out, for the value may be that of an alias, too.
std::string with_value(const YamlDocument& document, const YamlNode& node,
                       const std::string& value);

// The text with another word or number in place of the one that stands at that place. Throws
// std::out_of_range: none stands there.
std::string with_word(const std::string& text, TextPlace place, const std::string& word);

// The entries of `after`, and of maps in it, that `before` has not, or has with another value.
YamlNode difference(const YamlNode& after, const YamlNode& before);

}  // namespace maide
