// The secret that a client names to a wrapper that listens. Both sides read it the same way, and
// never from the command line, which others can see.
#pragma once

#include <optional>
#include <string>

namespace maide {

// The first line of `file`; without a file the variable MAIDE_TOKEN; nothing if that is not set or
// empty. Throws UsageError if the file cannot be read or begins with an empty line.
std::optional<std::string> read_token(const std::optional<std::string>& file);

}  // namespace maide
