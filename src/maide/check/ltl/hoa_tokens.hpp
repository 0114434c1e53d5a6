// The words of the Hanoi Omega-Automata format: headers (`States:`), names, aliases (`@a`),
// numbers, strings, `--BODY--` and its like, single characters. Comments nest.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "maide/base/error.hpp"
#include "maide/base/text_cursor.hpp"

namespace maide {

struct HoaToken {
  enum class Kind : std::uint8_t { header, word, alias, number, string, marker, symbol, end };
  Kind kind = Kind::end;
  std::string text;  // a header without its colon, a string without quotes and escapes
  TextPlace place;
};

// How it reads in a message.
std::string to_string(const HoaToken& token);

// Reads as it goes. Throws ParseError.
class HoaTokens {
 public:
  // Keeps a reference to the text.
  HoaTokens(std::string_view text, const std::string& file)
      : cursor_(text, file, TextCursor::Columns::bytes), token_(scan()) {}

  const HoaToken& peek() const { return token_; }
  HoaToken next();
  // Consumes the next token if it is that marker, word or symbol.
  bool accept(std::string_view what);
  void expect(std::string_view what);
  // The token must be a number, at most `most`.
  std::uint64_t value(const HoaToken& token, const char* what, std::uint64_t most) const;

  SourcePosition position(const HoaToken& token) const { return cursor_.in_file(token.place); }
  [[noreturn]] void fail(const std::string& message, const HoaToken& token) const {
    cursor_.fail(message, token.place);
  }

 private:
  HoaToken scan();
  bool skip_comment();
  void scan_string(HoaToken& token);
  void scan_name(HoaToken& token);

  TextCursor cursor_;
  HoaToken token_;
};

}  // namespace maide
