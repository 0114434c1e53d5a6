// The tokens of the language of programs and formulas: identifiers, quoted names, numbers and
// signs, each with its place in the system file. Comments (`//`, `#` to the end of the line) and
// blanks separate tokens; the list of all tokens keeps them, so that a text can be written as it
// stands.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "maide/check/text/scalar_text.hpp"

namespace maide {

struct Token {
  enum class Kind : std::uint8_t { identifier, quoted, number, symbol, comment, end };
  Kind kind = Kind::end;
  std::string text;        // without quotes; a comment begins with its sign
  std::size_t offset = 0;  // of its first character in the text
  int breaks = 0;          // line breaks before it
  bool has_blank = false;  // something blank stands before it
  bool is_name() const { return kind == Kind::identifier || kind == Kind::quoted; }
  bool is(std::string_view what) const {
    return (kind == Kind::symbol || kind == Kind::identifier) && text == what;
  }
};

// All tokens of the text in order, comments among them; the last one is the end. Throws ParseError
// on any other character.
std::vector<Token> read_tokens(const ScalarText& text);

class TokenStream {
 public:
  // Passes over comments. Keeps a reference to the text.
  explicit TokenStream(const ScalarText& text);

  const Token& peek(std::size_t ahead = 0) const {
    return tokens_[std::min(at_ + ahead, tokens_.size() - 1)];
  }
  Token next();
  bool at_end() const { return peek().kind == Token::Kind::end; }
  // Consumes the next token if it is this operator or keyword.
  bool accept(std::string_view what);
  // Consumes it, or throws "expected 'what' after ..., not ...", or what fail_foreign() says.
  void expect(std::string_view what, std::string_view where);
  // Throws if the token is an operator of other languages: "'and' is no sign here: it is '&&'".
  void fail_foreign(const Token& token) const;
  SourcePosition position(const Token& token) const { return text_.position(token.offset); }
  TextPlace place(const Token& token) const {
    const SourcePosition position = text_.position(token.offset);
    return {position.line, position.column};
  }
  [[noreturn]] void fail(const std::string& message, const Token& token) const;

 private:
  const ScalarText& text_;
  std::vector<Token> tokens_;  // the last one is the end
  std::size_t at_ = 0;
};

// A name that needs no quotes, unless it is a word of the language.
bool is_identifier(std::string_view name);

// The sign that another language writes so: "&&" of "and"; "" of a text that is none of theirs.
std::string_view own_sign(std::string_view foreign);

// How a token reads in a message: 'text', or "the end of the text".
std::string to_string(const Token& token);

// "depth, history; did you mean 'depth'?", "none": what there is, of many the first ones, where
// `name` is none of it.
std::string known_instead(std::string_view name, std::span<const std::string> known);

}  // namespace maide
