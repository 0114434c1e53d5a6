// Text in HTML and SVG: the characters that mean something there, escaped.
#pragma once

#include <string>
#include <string_view>

namespace maide {

// Line breaks and tabs stay; other control characters become blanks.
std::string escape_markup(std::string_view text);

}  // namespace maide
