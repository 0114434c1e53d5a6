// A place in a text that a lexer walks from the begin to the end, and the line and column where it
// stands. It looks ahead as far as it likes, and goes back nowhere.
#pragma once

#include <algorithm>
#include <cstddef>
#include <string>
#include <string_view>
#include <utility>

#include "maide/base/error.hpp"
#include "maide/base/text.hpp"

namespace maide {

// Digits and letters of ASCII, and white space, whatever the locale is.
constexpr bool is_digit(char c) { return c >= '0' && c <= '9'; }
constexpr bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }
constexpr bool is_space(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }

// Behind the mark with which some editors begin a file of UTF-8.
constexpr std::string_view without_byte_order_mark(std::string_view text) {
  return text.substr(text.starts_with("\xEF\xBB\xBF") ? 3 : 0);
}

class TextCursor {
 public:
  // What a column is: a character of UTF-8 or a byte.
  enum class Columns : bool { characters, bytes };

  // Keeps a reference to the text. `file` is for messages.
  TextCursor(std::string_view text, std::string file, Columns columns)
      : text_(text), file_(std::move(file)), columns_(columns) {}

  bool at_end() const { return offset_ >= text_.size(); }
  std::size_t offset() const { return offset_; }
  TextPlace place() const { return place_; }
  std::string_view rest() const { return text_.substr(offset_); }
  // '\0' behind the end.
  char peek(std::size_t ahead = 0) const {
    return offset_ + ahead < text_.size() ? text_[offset_ + ahead] : '\0';
  }

  // Not at the end.
  char take() {
    const char c = text_[offset_++];
    if (c == '\n') {
      ++place_.line;
      place_.column = 1;
    } else if (columns_ == Columns::bytes || !is_continuation(c)) {
      ++place_.column;
    }
    return c;
  }
  // At most what is there.
  std::string_view take(std::size_t count) {
    const std::string_view taken = rest().substr(0, count);
    for (std::size_t i = 0; i < taken.size(); ++i) take();
    return taken;
  }
  template <typename Predicate>
  std::string_view take_while(Predicate&& belongs) {
    const std::string_view ahead = rest();
    return take(static_cast<std::size_t>(std::ranges::find_if_not(ahead, belongs) - ahead.begin()));
  }
  std::string_view take_line() {  // without its end
    return take_while([](char c) { return c != '\n'; });
  }
  void skip_blanks() { take_while(is_space); }
  // Takes `what` if it is next.
  bool accept(std::string_view what) {
    const bool is_next = rest().starts_with(what);
    if (is_next) take(what.size());
    return is_next;
  }

  SourcePosition in_file(TextPlace place) const { return {file_, place.line, place.column}; }
  // Throws ParseError.
  [[noreturn]] void fail(const std::string& message, TextPlace place) const {
    throw ParseError(message, in_file(place));
  }

 private:
  std::string_view text_;
  std::string file_;
  Columns columns_;
  std::size_t offset_ = 0;
  TextPlace place_{1, 1};
};

}  // namespace maide
