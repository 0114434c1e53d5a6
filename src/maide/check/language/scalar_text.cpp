#include "maide/check/language/scalar_text.hpp"

#include <utility>

#include "maide/base/text.hpp"

namespace maide {
namespace {

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

bool is_line_break(char c) { return c == '\n' || c == '\r'; }

// Characters of the escape \c in a double-quoted scalar.
int escape_length(char c) {
  switch (c) {
    case 'x': return 4;
    case 'u': return 6;
    case 'U': return 10;
    default: return 2;
  }
}

// A place in the source that walks forward and counts lines and columns.
class Cursor {
 public:
  Cursor(std::string_view source, int line, int column) : source_(source) {
    while (line_ < line && at_ < source_.size()) advance();
    while (column_ < column && at_ < source_.size() && source_[at_] != '\n') advance();
  }
  bool at_end() const { return at_ >= source_.size(); }
  char peek(std::size_t ahead = 0) const {
    return at_ + ahead < source_.size() ? source_[at_ + ahead] : '\0';
  }
  void advance() {
    if (at_end()) return;
    if (source_[at_] == '\n') {
      ++line_;
      column_ = 1;
    } else {
      ++column_;
    }
    ++at_;
  }
  void skip(int count) {
    for (; count > 0; --count) advance();
  }
  void skip_blanks() {
    while (!at_end() && is_blank(peek())) advance();
  }
  void skip_word() {
    while (!at_end() && !is_blank(peek())) advance();
  }
  void skip_line() {
    while (!at_end() && peek() != '\n') advance();
    advance();
  }
  int line() const { return line_; }
  int column() const { return column_; }

 private:
  std::string_view source_;
  std::size_t at_ = 0;
  int line_ = 1, column_ = 1;
};

}  // namespace

ScalarText::ScalarText(std::string value, std::string_view source, SourcePosition begin)
    : value_(std::move(value)), file_(std::move(begin.file)) {
  Cursor cursor(source, begin.line, begin.column);
  while (cursor.peek() == '!' || cursor.peek() == '&') {  // tag, anchor
    has_tag_ = has_tag_ || cursor.peek() == '!';
    cursor.skip_word();
    cursor.skip_blanks();
  }
  const char style = cursor.peek();
  if (style == '|' || style == '>') {
    cursor.skip_line();
  } else if (style == '"' || style == '\'') {
    cursor.advance();
  }
  places_.reserve(value_.size() + 1);
  bool in_escape = false;  // the bytes of one character that an escape stands for share its place
  for (const char c : value_) {
    if (in_escape && is_continuation(c)) {
      places_.push_back(places_.back());
      continue;
    }
    if (!is_blank(c)) cursor.skip_blanks();
    while (style == '"' && cursor.peek() == '\\' && is_line_break(cursor.peek(1))) {
      cursor.advance();  // an escaped line break stands for nothing
      if (!is_blank(c)) cursor.skip_blanks();
    }
    places_.push_back({cursor.line(), cursor.column()});
    in_escape = style == '"' && cursor.peek() == '\\';
    if (in_escape) {
      cursor.skip(escape_length(cursor.peek(1)));
    } else if (!is_blank(c) || cursor.peek() == c) {
      cursor.skip(style == '\'' && c == '\'' ? 2 : 1);  // '' is one quote
    }
  }
  places_.push_back({cursor.line(), cursor.column()});
}

SourcePosition ScalarText::position(std::size_t offset) const {
  if (places_.empty()) return {file_, 0, 0};
  const Place place = places_[offset < places_.size() ? offset : places_.size() - 1];
  return {file_, place.line, place.column};
}

}  // namespace maide
