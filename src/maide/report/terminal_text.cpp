#include "maide/report/terminal_text.hpp"

#include <algorithm>
#include <cstdint>

namespace maide {
namespace {

constexpr char32_t unknown = U'?';

// The length of the sequence that begins with this byte; 0: none does.
std::size_t length_of(unsigned char first) {
  if (first < 0x80) return 1;
  if (first >= 0xC2 && first < 0xE0) return 2;
  if (first >= 0xE0 && first < 0xF0) return 3;
  return first >= 0xF0 && first < 0xF5 ? 4 : 0;
}

bool is_control(char32_t character) {
  return character < 0x20 || (character >= 0x7F && character < 0xA0);
}

}  // namespace

Characters to_characters(std::string_view utf8) {
  Characters result;
  for (std::size_t at = 0; at < utf8.size();) {
    const auto first = static_cast<unsigned char>(utf8[at]);
    const std::size_t length = length_of(first);
    char32_t character = length == 1 ? first : first & (0x7FU >> length);
    bool is_good = length > 0 && at + length <= utf8.size();
    for (std::size_t i = 1; is_good && i < length; ++i) {
      const auto next = static_cast<unsigned char>(utf8[at + i]);
      is_good = (next & 0xC0U) == 0x80U;
      character = character << 6U | (next & 0x3FU);
    }
    result += is_good && !is_control(character) ? character : unknown;
    at += is_good ? length : 1;
  }
  return result;
}

std::string to_utf8(const Characters& characters) {
  std::string result;
  const auto put = [&](std::uint32_t byte) { result += static_cast<char>(byte); };
  for (const char32_t character : characters) {
    const auto code = static_cast<std::uint32_t>(character);
    if (code < 0x80) {
      put(code);
    } else if (code < 0x800) {
      put(0xC0U | code >> 6U);
      put(0x80U | (code & 0x3FU));
    } else if (code < 0x10000) {
      put(0xE0U | code >> 12U);
      put(0x80U | (code >> 6U & 0x3FU));
      put(0x80U | (code & 0x3FU));
    } else {
      put(0xF0U | code >> 18U);
      put(0x80U | (code >> 12U & 0x3FU));
      put(0x80U | (code >> 6U & 0x3FU));
      put(0x80U | (code & 0x3FU));
    }
  }
  return result;
}

Characters clip(Characters text, std::size_t most, bool unicode) {
  if (text.size() <= most) return text;
  const Characters dots = unicode ? U"…" : U"...";
  if (most <= dots.size()) return text.substr(0, most);
  return text.substr(0, most - dots.size()) + dots;
}

std::string wrap(std::string_view utf8, std::size_t width, std::size_t indent) {
  const Characters text = to_characters(utf8);
  std::string result;
  Characters line(indent, U' ');
  for (std::size_t at = text.find_first_not_of(U' '); at < text.size();
       at = text.find_first_not_of(U' ', at)) {
    const std::size_t end = std::min(text.find(U' ', at), text.size());
    const bool is_first = line.size() == indent;
    if (!is_first && line.size() + 1 + (end - at) > width) {
      result += to_utf8(line) + "\n";
      line.assign(indent, U' ');
    } else if (!is_first) {
      line += U' ';
    }
    line += text.substr(at, end - at);
    at = end;
  }
  return line.size() == indent ? result : result + to_utf8(line) + "\n";
}

}  // namespace maide
