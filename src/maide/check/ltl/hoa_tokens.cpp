#include "maide/check/ltl/hoa_tokens.hpp"

#include <charconv>

#include "maide/formats/names.hpp"

namespace maide {
namespace {

bool begins_name(char c) { return is_letter(c) || c == '_'; }
bool continues_name(char c) { return begins_name(c) || is_digit(c) || c == '-'; }
bool continues_marker(char c) { return begins_name(c) || c == '-'; }

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

// Comments nest.
bool HoaTokens::skip_comment() {
  const TextPlace open = cursor_.place();
  if (!cursor_.accept("/*")) return false;
  for (int depth = 1; depth > 0;) {
    if (cursor_.at_end()) cursor_.fail("this comment is not closed", open);
    if (cursor_.accept("/*")) {
      ++depth;
    } else if (cursor_.accept("*/")) {
      --depth;
    } else {
      cursor_.take();
    }
  }
  return true;
}

void HoaTokens::scan_string(HoaToken& token) {
  token.kind = HoaToken::Kind::string;
  std::string_view rest = cursor_.rest();
  if (!take_quoted_name(rest, token.text)) fail("this string is not closed", token);
  cursor_.take(cursor_.rest().size() - rest.size());
}

// A word, or, with a colon at its end, a header.
void HoaTokens::scan_name(HoaToken& token) {
  token.text += cursor_.take_while(continues_name);
  token.kind = cursor_.accept(":") ? HoaToken::Kind::header : HoaToken::Kind::word;
}

HoaToken HoaTokens::scan() {
  using Kind = HoaToken::Kind;
  do {
    cursor_.skip_blanks();
  } while (skip_comment());
  HoaToken token;
  token.place = cursor_.place();
  if (cursor_.at_end()) return token;
  const char first = cursor_.peek();
  if (first == '"') {
    scan_string(token);
  } else if (begins_name(first)) {
    scan_name(token);
  } else if (first == '@') {
    token.text = cursor_.take();
    scan_name(token);
    token.kind = Kind::alias;
  } else if (is_digit(first)) {
    token.kind = Kind::number;
    token.text = cursor_.take_while(is_digit);
  } else if (cursor_.rest().starts_with("--")) {
    token.kind = Kind::marker;
    token.text = cursor_.take_while(continues_marker);
  } else {
    token.kind = Kind::symbol;
    token.text = cursor_.take();
  }
  return token;
}

}  // namespace maide
