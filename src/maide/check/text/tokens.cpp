#include "maide/check/text/tokens.hpp"

#include <fmt/format.h>

#include <utility>

#include "maide/base/text.hpp"
#include "maide/base/text_cursor.hpp"

namespace maide {
namespace {

bool begins_identifier(char c) { return is_letter(c) || c == '_'; }
bool in_identifier(char c) { return begins_identifier(c) || is_digit(c); }

std::string describe(char c) {
  static constexpr char digits[] = "0123456789abcdef";
  const auto byte = static_cast<unsigned char>(c);
  if (byte >= 0x20 && byte < 0x7f) return "'" + std::string(1, c) + "'";
  return std::string("the byte 0x") + digits[byte >> 4] + digits[byte & 15];
}

Token scan(const ScalarText& text, TextCursor& cursor, std::span<const std::string_view> symbols) {
  using Kind = Token::Kind;
  const std::size_t begin = cursor.offset();
  const auto token = [&](Kind kind, std::string_view taken) {
    return Token{kind, std::string(taken), begin};
  };
  const char first = cursor.peek();
  if (begins_identifier(first)) return token(Kind::identifier, cursor.take_while(in_identifier));
  if (is_digit(first)) return token(Kind::number, cursor.take_while(in_identifier));
  if (cursor.accept("\"")) {
    const auto name = cursor.take_while([](char c) { return c != '"' && c != '\n'; });
    if (!cursor.accept("\"")) throw ParseError("a quoted name is not closed", text.position(begin));
    if (name.empty()) throw ParseError("a name is empty", text.position(begin));
    return token(Kind::quoted, name);
  }
  for (const std::string_view symbol : symbols) {
    if (cursor.accept(symbol)) return token(Kind::symbol, symbol);
  }
  throw ParseError("unexpected " + describe(first), text.position(begin));
}

}  // namespace

std::string to_string(const Token& token) {
  switch (token.kind) {
    case Token::Kind::end: return "the end of the text";
    case Token::Kind::quoted: return "\"" + token.text + "\"";
    default: return "'" + token.text + "'";
  }
}

std::string known_instead(std::string_view name, std::span<const std::string> known) {
  constexpr std::size_t most_listed = 24;
  if (known.empty()) return "none";
  const std::size_t listed = std::min(known.size(), most_listed);
  std::string text = join(known.first(listed));
  if (listed < known.size()) text += " and " + std::to_string(known.size() - listed) + " more";
  return text + did_you_mean(name, known);
}

TokenStream::TokenStream(const ScalarText& text, std::span<const std::string_view> symbols)
    : text_(text) {
  TextCursor cursor(text.value(), "", TextCursor::Columns::bytes);
  std::size_t end = 0;  // of the last token: there something may be missing
  for (cursor.skip_blanks(); !cursor.at_end(); cursor.skip_blanks()) {
    if (cursor.accept("#") || cursor.accept("//")) {
      cursor.take_line();
    } else {
      tokens_.push_back(scan(text, cursor, symbols));
      end = cursor.offset();
    }
  }
  tokens_.push_back({Token::Kind::end, "", end});
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
  if (peek().is("=") && peek(1).is(">")) fail("'=>' is no sign here: it is '->'", peek());
  if (!peek().is("=") && !peek(1).is(".")) fail_foreign(peek());
  fail("expected '" + std::string(what) + "' " + std::string(where) + ", not " + to_string(peek()),
       peek());
}

void TokenStream::fail_foreign(const Token& token) const {
  static constexpr std::pair<std::string_view, std::string_view> foreign[] = {
      {"=>", "->"}, {"implies", "->"}, {"iff", "<->"}, {"and", "&&"}, {"AND", "&&"},
      {"or", "||"}, {"OR", "||"},      {"not", "!"},   {"NOT", "!"},  {"=", "=="}};
  for (const auto& [theirs, ours] : foreign) {
    if (token.kind == Token::Kind::quoted || token.text != theirs) continue;
    fail(fmt::format("'{}' is no sign here: it is '{}'", theirs, ours), token);
  }
}

void TokenStream::fail(const std::string& message, const Token& token) const {
  throw ParseError(message, position(token));
}

}  // namespace maide
