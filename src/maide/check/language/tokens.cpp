#include "maide/check/language/tokens.hpp"

#include <cctype>

namespace maide {
namespace {

bool starts_identifier(char c) { return std::isalpha(static_cast<unsigned char>(c)) || c == '_'; }
bool in_identifier(char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_'; }
bool is_digit(char c) { return std::isdigit(static_cast<unsigned char>(c)); }
bool is_space(char c) { return std::isspace(static_cast<unsigned char>(c)); }

std::string printable(char c) {
  static constexpr char digits[] = "0123456789abcdef";
  const auto byte = static_cast<unsigned char>(c);
  if (std::isprint(byte)) return "'" + std::string(1, c) + "'";
  return std::string("the byte 0x") + digits[byte >> 4] + digits[byte & 15];
}

// The token of each kind that begins at `at`, which it moves behind the token.
Token scan(const ScalarText& text, std::size_t& at, std::span<const std::string_view> symbols) {
  const std::string& value = text.value();
  const std::size_t begin = at;
  const auto token = [&](Token::Kind kind) {
    return Token{kind, value.substr(begin, at - begin), begin};
  };
  if (starts_identifier(value[at])) {
    while (at < value.size() && in_identifier(value[at])) ++at;
    return token(Token::Kind::identifier);
  }
  if (is_digit(value[at])) {
    while (at < value.size() && in_identifier(value[at])) ++at;
    return token(Token::Kind::number);
  }
  if (value[at] == '"') {
    const std::size_t close = value.find_first_of("\"\n", at + 1);
    if (close == std::string::npos || value[close] != '"') {
      throw ParseError("a quoted name is not closed", text.position(begin));
    }
    if (close == at + 1) throw ParseError("a name is empty", text.position(begin));
    at = close + 1;
    return {Token::Kind::quoted, value.substr(begin + 1, close - begin - 1), begin};
  }
  for (const std::string_view symbol : symbols) {
    if (value.compare(at, symbol.size(), symbol) == 0) {
      at += symbol.size();
      return token(Token::Kind::symbol);
    }
  }
  throw ParseError("unexpected " + printable(value[at]), text.position(begin));
}

}  // namespace

std::string to_string(const Token& token) {
  switch (token.kind) {
    case Token::Kind::end: return "the end of the text";
    case Token::Kind::quoted: return "\"" + token.text + "\"";
    default: return "'" + token.text + "'";
  }
}

TokenStream::TokenStream(const ScalarText& text, std::span<const std::string_view> symbols)
    : text_(text) {
  const std::string& value = text.value();
  std::size_t at = 0;
  while (at < value.size()) {
    if (is_space(value[at])) {
      ++at;
    } else if (value[at] == '#' || value.compare(at, 2, "//") == 0) {
      at = std::min(value.find('\n', at), value.size());
    } else {
      tokens_.push_back(scan(text, at, symbols));
    }
  }
  tokens_.push_back({Token::Kind::end, "", value.size()});
}

Token TokenStream::next() {
  Token token = peek();
  if (at_ + 1 < tokens_.size()) ++at_;
  return token;
}

bool TokenStream::accept(std::string_view what) {
  if (!peek().is(what)) return false;
  next();
  return true;
}

void TokenStream::expect(std::string_view what, std::string_view where) {
  if (accept(what)) return;
  fail("expected '" + std::string(what) + "' " + std::string(where) + ", not " + to_string(peek()),
       peek());
}

void TokenStream::fail(const std::string& message, const Token& token) const {
  throw ParseError(message, position(token));
}

}  // namespace maide
