// UTF-8 by the table of well-formed byte sequences (The Unicode Standard, table 3-7).
#include "maide/base/printable.hpp"

#include <algorithm>
#include <cstddef>

namespace maide {
namespace {

bool is_between(unsigned byte, unsigned first, unsigned last) {
  return byte >= first && byte <= last;
}

// Bytes of the well-formed character that `text` begins with; 0 if there is none.
std::size_t character_length(std::string_view text) {
  const auto byte = [&](std::size_t place) -> unsigned {
    return place < text.size() ? static_cast<unsigned char>(text[place]) : 0;
  };
  const unsigned first = byte(0);
  std::size_t length = 0;
  unsigned low = 0x80, high = 0xbf;  // of the second byte
  if (first < 0x80) {
    return 1;
  } else if (is_between(first, 0xc2, 0xdf)) {
    length = 2;
  } else if (is_between(first, 0xe0, 0xef)) {
    length = 3;
    if (first == 0xe0) low = 0xa0;   // else overlong
    if (first == 0xed) high = 0x9f;  // else a surrogate
  } else if (is_between(first, 0xf0, 0xf4)) {
    length = 4;
    if (first == 0xf0) low = 0x90;   // else overlong
    if (first == 0xf4) high = 0x8f;  // else beyond U+10FFFF
  } else {
    return 0;
  }
  if (!is_between(byte(1), low, high)) return 0;
  for (std::size_t place = 2; place < length; ++place) {
    if (!is_between(byte(place), 0x80, 0xbf)) return 0;
  }
  return length;
}

bool is_control(std::string_view character) {
  const auto first = static_cast<unsigned char>(character.front());
  if (character.size() == 2 && first == 0xc2) {
    return static_cast<unsigned char>(character[1]) < 0xa0;
  }
  return first < 0x20 || first == 0x7f;
}

}  // namespace

std::string printable(std::string_view text) {
  std::string result;
  result.reserve(text.size());
  while (!text.empty()) {
    const std::size_t length = character_length(text);
    const std::string_view character = text.substr(0, std::max<std::size_t>(length, 1));
    const bool is_kept =
        character == "\n" || character == "\t" || (length > 0 && !is_control(character));
    result += is_kept ? character : "?";
    text.remove_prefix(character.size());
  }
  return result;
}

std::string one_line(std::string_view text) {
  std::string blanks(text);
  std::replace_if(
      blanks.begin(), blanks.end(), [](char c) { return c == '\n' || c == '\r' || c == '\t'; },
      ' ');
  return printable(blanks);
}

}  // namespace maide
