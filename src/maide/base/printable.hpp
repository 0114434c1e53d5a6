// Text that others wrote (what a wrapper says, names in a file) as a terminal may be given it. A
// control character can move the cursor, recolour or erase what stands there, even type: each that
// is not white space becomes '?', those of Unicode (U+0080 to U+009F) and bytes that are no UTF-8
// too. What goes to a file or a program is not changed.
#pragma once

#include <string>
#include <string_view>

namespace maide {

// Keeps lines and tabs.
std::string printable(std::string_view text);

// One line: each line break and tab is a blank.
std::string one_line(std::string_view text);

}  // namespace maide
