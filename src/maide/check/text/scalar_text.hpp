// Where the characters of a YAML scalar stand in its file. Errors inside program text and formulas
// must name that place, but YAML folds lines, strips indentation and knows escapes, so an offset in
// a scalar's value says nothing about the file. The idea: a value holds the non-blank characters of
// its source in order. Walking both in parallel finds each one, whatever the scalar's style.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "maide/base/error.hpp"

namespace maide {

class ScalarText {
 public:
  ScalarText() = default;
  // `value` is the scalar's value, `source` the whole file, (`line`, `column`) where the scalar's
  // node begins, from 1. O(value + source read).
  ScalarText(std::string value, std::string_view source, SourcePosition begin);

  const std::string& value() const { return value_; }
  // A YAML tag stands before it: what looks like a leading `!` is no part of the value.
  bool has_tag() const { return has_tag_; }
  // Place of the character at `offset`; of the end if the offset is the value's size.
  SourcePosition position(std::size_t offset) const;

 private:
  std::string value_;
  std::string file_;
  bool has_tag_ = false;
  std::vector<TextPlace> places_;  // one for each character, and one for the end
};

}  // namespace maide
