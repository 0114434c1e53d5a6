// Lists of words in one text, as a shell has them: blanks between words, quotes around blanks.
// Nothing is expanded.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace maide {

// Splits a command line into words: blanks, '...', "...", backslash. Throws UsageError on an
// unclosed quote.
std::vector<std::string> split_shell_words(std::string_view line);

// The word as it is written in a line: in quotes, where split_shell_words() would not give it back.
std::string quote_shell_word(const std::string& word);

}  // namespace maide
