// What the terminal can show: how wide it is, and whether it is told to expect UTF-8.
#pragma once

#include <cstddef>
#include <optional>

namespace maide {

// Columns of the terminal behind the descriptor; nothing if it is none or does not say.
std::optional<std::size_t> terminal_width(int descriptor);

// Whether the environment asks for UTF-8: the first of LC_ALL, LC_CTYPE and LANG that is set.
bool is_utf8_locale();

}  // namespace maide
