// Text that is laid out in columns: names in UTF-8 as characters, one a column, and back. What is
// no UTF-8, and control characters, become `?`. Wide and combining characters are not treated
// specially: a column may be off by one there.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace maide {

using Characters = std::u32string;

Characters to_characters(std::string_view utf8);
std::string to_utf8(const Characters& characters);

// At most `most` characters; what is longer ends in "…", or in "..." without `unicode`.
Characters clip(Characters text, std::size_t most, bool unicode);

// The words of the text in lines of at most `width` columns, each begun with `indent` blanks and
// ended with a line break. A word that is longer has a line of its own.
std::string wrap(std::string_view utf8, std::size_t width, std::size_t indent);

}  // namespace maide
