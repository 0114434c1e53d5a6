// The words of the Hanoi Omega-Automata format: headers (`States:`), names, aliases (`@a`),
// numbers, strings, `--BODY--` and its like, single characters. Comments nest.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "maide/base/error.hpp"

namespace maide {

struct HoaToken {
  enum class Kind : std::uint8_t { header, word, alias, number, string, marker, symbol, end };
  Kind kind = Kind::end;
  std::string text;  // a header without its colon, a string without quotes and escapes
  int line = 0, column = 0;
};

// How it reads in a message.
std::string to_string(const HoaToken& token);

// Reads as it goes. Throws ParseError.
class HoaTokens {
 public:
  // Keeps references.
  HoaTokens(std::string_view text, const std::string& file) : text_(text), file_(file) {
    token_ = scan();
  }

  const HoaToken& peek() const { return token_; }
  HoaToken next();
  // Consumes the next token if it is that marker, word or symbol.
  bool accept(std::string_view what);
  void expect(std::string_view what);
  // The token must be a number, at most `most`.
  std::uint64_t value(const HoaToken& token, const char* what, std::uint64_t most) const;

  SourcePosition position(const HoaToken& token) const { return {file_, token.line, token.column}; }
  [[noreturn]] void fail(const std::string& message, const HoaToken& token) const;

 private:
  HoaToken scan();
  void skip_blanks();
  void scan_string(HoaToken& token);
  void scan_name(HoaToken& token);
  char here(std::size_t ahead = 0) const {
    return at_ + ahead < text_.size() ? text_[at_ + ahead] : '\0';
  }
  char take();

  std::string_view text_;
  const std::string& file_;
  std::size_t at_ = 0;
  int line_ = 1, column_ = 1;
  HoaToken token_;
};

}  // namespace maide
