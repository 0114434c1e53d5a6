#include "maide/check/scalar_text.hpp"

#include <utility>

namespace maide {
namespace {

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

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
  for (const char c : value_) {
    if (!is_blank(c)) {
      cursor.skip_blanks();
      // An escape stands for the character: the two are not compared.
      if (style == '"' && cursor.peek() == '\\') cursor.advance();
      if (style == '\'' && c == '\'') cursor.advance();  // '' is one quote
    }
    places_.push_back({cursor.line(), cursor.column()});
    if (!is_blank(c) || cursor.peek() == c) cursor.advance();
  }
  places_.push_back({cursor.line(), cursor.column()});
}

SourcePosition ScalarText::position(std::size_t offset) const {
  if (places_.empty()) return {file_, 0, 0};
  const Place place = places_[offset < places_.size() ? offset : places_.size() - 1];
  return {file_, place.line, place.column};
}

}  // namespace maide
