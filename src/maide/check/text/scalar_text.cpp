#include "maide/check/text/scalar_text.hpp"

#include <utility>

#include "maide/base/text_cursor.hpp"

namespace maide {
namespace {

bool is_line_break(char c) { return c == '\n' || c == '\r'; }

// Characters of the escape \c in a double-quoted scalar.
std::size_t escape_length(char c) {
  switch (c) {
    case 'x': return 4;
    case 'u': return 6;
    case 'U': return 10;
    default: return 2;
  }
}

// In the source, at the place.
TextCursor cursor_at(std::string_view source, const SourcePosition& place) {
  TextCursor cursor(source, "", TextCursor::Columns::bytes);
  while (cursor.place().line < place.line && !cursor.at_end()) cursor.take();
  while (cursor.place().column < place.column && !cursor.at_end() && cursor.peek() != '\n') {
    cursor.take();
  }
  return cursor;
}

}  // namespace

ScalarText::ScalarText(std::string value, std::string_view source, SourcePosition begin)
    : value_(std::move(value)), file_(std::move(begin.file)) {
  TextCursor cursor = cursor_at(source, begin);
  while (cursor.peek() == '!' || cursor.peek() == '&') {  // tag, anchor
    has_tag_ = has_tag_ || cursor.peek() == '!';
    cursor.take_while([](char c) { return !is_space(c); });
    cursor.skip_blanks();
  }
  const char style = cursor.peek();
  if (style == '|' || style == '>') {
    cursor.take_line();
    cursor.accept("\n");
  } else if (style == '"' || style == '\'') {
    cursor.take();
  }
  places_.reserve(value_.size() + 1);
  bool in_escape = false;  // the bytes of one character that an escape stands for share its place
  for (const char c : value_) {
    if (in_escape && is_continuation(c)) {
      places_.push_back(places_.back());
      continue;
    }
    if (!is_space(c)) cursor.skip_blanks();
    while (style == '"' && cursor.peek() == '\\' && is_line_break(cursor.peek(1))) {
      cursor.take();  // an escaped line break stands for nothing
      if (!is_space(c)) cursor.skip_blanks();
    }
    places_.push_back(cursor.place());
    in_escape = style == '"' && cursor.peek() == '\\';
    if (in_escape) {
      cursor.take(escape_length(cursor.peek(1)));
    } else if (!is_space(c) || cursor.peek() == c) {
      cursor.take(style == '\'' && c == '\'' ? 2 : 1);  // '' is one quote
    }
  }
  places_.push_back(cursor.place());
}

SourcePosition ScalarText::position(std::size_t offset) const {
  if (places_.empty()) return {file_, 0, 0};
  const TextPlace place = places_[offset < places_.size() ? offset : places_.size() - 1];
  return {file_, place.line, place.column};
}

}  // namespace maide
