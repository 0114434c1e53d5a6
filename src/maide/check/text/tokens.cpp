#include "maide/check/text/tokens.hpp"

#include <fmt/format.h>

#include <algorithm>
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

// Longest first.
constexpr std::string_view symbols[] = {
    "<->", "->", "=>", "[]", "<>", "&&", "||", "==", "!=", "<=", ">=", "..",
    "&",   "|",  "{",  "}",  ";",  ".",  "@",  "*",  "<",  ">",  "+",  "-",
    "/",   "%",  "!",  "(",  ")",  "[",  "]",  ",",  "=",  ":"};

Token scan(const ScalarText& text, TextCursor& cursor) {
  using Kind = Token::Kind;
  const std::size_t begin = cursor.offset();
  const auto token = [&](Kind kind, std::string_view taken) {
    return Token{kind, std::string(taken), begin};
  };
  const char first = cursor.peek();
  if (first == '#' || (first == '/' && cursor.peek(1) == '/')) {
    const std::string_view line = cursor.take_line();
    return token(Kind::comment, line.substr(0, line.find_last_not_of(" \t\r") + 1));
  }
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

bool is_identifier(std::string_view name) {
  return !name.empty() && begins_identifier(name.front()) &&
         std::ranges::all_of(name, in_identifier);
}

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

std::vector<Token> read_tokens(const ScalarText& text) {
  TextCursor cursor(text.value(), "", TextCursor::Columns::bytes);
  std::vector<Token> tokens;
  for (;;) {
    const auto blanks = cursor.take_while(is_space);
    const auto breaks = static_cast<int>(std::ranges::count(blanks, '\n'));
    Token token{Token::Kind::end, "", cursor.offset()};
    if (!cursor.at_end()) token = scan(text, cursor);
    token.breaks = breaks;
    token.has_blank = !blanks.empty();
    tokens.push_back(std::move(token));
    if (tokens.back().kind == Token::Kind::end) return tokens;
  }
}

TokenStream::TokenStream(const ScalarText& text) : text_(text), tokens_(read_tokens(text)) {
  std::erase_if(tokens_, [](const Token& token) { return token.kind == Token::Kind::comment; });
  // Behind the last token something may be missing, not behind the comments that follow it.
  tokens_.back().offset = 0;
  if (tokens_.size() == 1) return;
  const Token& last = tokens_[tokens_.size() - 2];
  tokens_.back().offset =
      last.offset + last.text.size() + (last.kind == Token::Kind::quoted ? 2 : 0);
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
  if (!peek().is("=") && !peek(1).is(".")) fail_foreign(peek());
  fail("expected '" + std::string(what) + "' " + std::string(where) + ", not " + to_string(peek()),
       peek());
}

std::string_view own_sign(std::string_view foreign) {
  static constexpr std::pair<std::string_view, std::string_view> signs[] = {
      {"=>", "->"}, {"implies", "->"}, {"iff", "<->"}, {"and", "&&"}, {"AND", "&&"},
      {"or", "||"}, {"OR", "||"},      {"not", "!"},   {"NOT", "!"},  {"=", "=="}};
  for (const auto& [theirs, ours] : signs) {
    if (foreign == theirs) return ours;
  }
  return "";
}

void TokenStream::fail_foreign(const Token& token) const {
  const std::string_view ours = own_sign(token.text);
  if (token.kind == Token::Kind::quoted || ours.empty()) return;
  fail(fmt::format("'{}' is no sign here: it is '{}'", token.text, ours), token);
}

void TokenStream::fail(const std::string& message, const Token& token) const {
  throw ParseError(message, position(token));
}

}  // namespace maide
