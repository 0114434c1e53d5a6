#include "maide/check/ltl/hoa_tokens.hpp"

#include <charconv>

#include "maide/formats/names.hpp"

namespace maide {
namespace {

bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }
bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

}  // namespace

std::string to_string(const HoaToken& token) {
  return token.kind == HoaToken::Kind::end ? "the end of the file" : shown(token.text);
}

HoaToken HoaTokens::next() {
  HoaToken token = std::move(token_);
  token_ = scan();
  return token;
}

bool HoaTokens::accept(std::string_view what) {
  using Kind = HoaToken::Kind;
  if (token_.text != what || token_.kind == Kind::string || token_.kind == Kind::header) {
    return false;
  }
  next();
  return true;
}

void HoaTokens::expect(std::string_view what) {
  if (accept(what)) return;
  fail("expected '" + std::string(what) + "', not " + to_string(token_), token_);
}

std::uint64_t HoaTokens::value(const HoaToken& token, const char* what, std::uint64_t most) const {
  std::uint64_t number = 0;
  const char* end = token.text.data() + token.text.size();
  const bool is_number =
      token.kind == HoaToken::Kind::number &&
      std::from_chars(token.text.data(), end, number).ec != std::errc::invalid_argument;
  if (!is_number) fail(std::string("expected ") + what + ", not " + to_string(token), token);
  const bool fits = std::from_chars(token.text.data(), end, number).ec == std::errc();
  if (!fits || number > most) {
    fail(std::string(what) + " goes up to " + std::to_string(most) + " here", token);
  }
  return number;
}

void HoaTokens::fail(const std::string& message, const HoaToken& token) const {
  throw ParseError(message, position(token));
}

char HoaTokens::take() {
  const char c = text_[at_++];
  if (c == '\n') {
    ++line_;
    column_ = 1;
  } else {
    ++column_;
  }
  return c;
}

void HoaTokens::skip_blanks() {
  int depth = 0;
  HoaToken open;  // the comment
  while (at_ < text_.size()) {
    if (here() == '/' && here(1) == '*') {
      if (depth++ == 0) open = {HoaToken::Kind::symbol, "/*", line_, column_};
      take();
      take();
    } else if (depth > 0 && here() == '*' && here(1) == '/') {
      --depth;
      take();
      take();
    } else if (depth > 0 || is_blank(here())) {
      take();
    } else {
      return;
    }
  }
  if (depth > 0) fail("this comment is not closed", open);
}

void HoaTokens::scan_string(HoaToken& token) {
  token.kind = HoaToken::Kind::string;
  take();
  for (;;) {
    if (at_ >= text_.size()) fail("this string is not closed", token);
    char c = take();
    if (c == '"') return;
    if (c == '\\' && at_ < text_.size()) c = take();
    token.text += c;
  }
}

// A word, or, with a colon at its end, a header.
void HoaTokens::scan_name(HoaToken& token) {
  token.kind = HoaToken::Kind::word;
  while (is_letter(here()) || is_digit(here()) || here() == '-') token.text += take();
  if (here() != ':') return;
  take();
  token.kind = HoaToken::Kind::header;
}

HoaToken HoaTokens::scan() {
  using Kind = HoaToken::Kind;
  skip_blanks();
  HoaToken token;
  token.line = line_;
  token.column = column_;
  if (at_ >= text_.size()) return token;
  if (here() == '"') {
    scan_string(token);
  } else if (is_letter(here())) {
    scan_name(token);
  } else if (here() == '@') {
    token.text += take();
    scan_name(token);
    token.kind = Kind::alias;
  } else if (is_digit(here())) {
    token.kind = Kind::number;
    while (is_digit(here())) token.text += take();
  } else if (here() == '-' && here(1) == '-') {
    token.kind = Kind::marker;
    while (here() == '-' || is_letter(here())) token.text += take();
  } else {
    token.kind = Kind::symbol;
    token.text += take();
  }
  return token;
}

}  // namespace maide
