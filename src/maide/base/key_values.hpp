// Options as people type them: words key=value, in which '-' and '_' are the same in keys. What
// keys there are and what values they take is the business of the system that they are given to.
#pragma once

#include <map>
#include <span>
#include <string>
#include <string_view>

namespace maide {

// The key with '-' turned into '_'.
std::string normalised_key(std::string_view key);

// Splits "key=value" words; the keys of the result are normalised. Throws UsageError for a word
// without '=', an empty key and a key that is given twice.
std::map<std::string, std::string> parse_key_values(std::span<const std::string> words);

}  // namespace maide
