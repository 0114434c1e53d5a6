// How names of symbols are written inside attributes and labels: as they are, or, where a name
// contains what separates names there, in double quotes with \" and \\ inside. Every name
// round-trips.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace maide {

// `name` in double quotes, with \ before each " and \.
std::string quote_name(std::string_view name);

// Takes a quoted name off the front of `text` (which begins with "). Returns false, and leaves
// `text` alone, if the closing quote is missing.
bool take_quoted_name(std::string_view& text, std::string& name);

// Without white space at both ends.
std::string_view trim(std::string_view text);

// "write,tryread": names separated by commas.
std::string join_names(std::span<const std::string> names);
// Inverse of join_names; white space around names is ignored, "" is no name at all. Throws
// UsageError "..." (without a place) for an empty name or an unfinished quote.
std::vector<std::string> split_names(std::string_view text);

// Text from a file for a message: on one line, in single quotes, at most some 60 bytes of it.
std::string shown(std::string_view text);

}  // namespace maide
