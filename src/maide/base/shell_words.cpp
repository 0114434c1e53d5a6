#include "maide/base/shell_words.hpp"

#include "maide/base/error.hpp"

namespace maide {

std::vector<std::string> split_shell_words(std::string_view line) {
  std::vector<std::string> words;
  bool in_word = false;
  char quote = 0;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    const bool is_blank = c == ' ' || c == '\t' || c == '\n';
    if (quote == 0 && is_blank) {
      in_word = false;
      continue;
    }
    if (!in_word) words.emplace_back();
    in_word = true;
    if (quote != 0 && c == quote) {
      quote = 0;
    } else if (quote == 0 && (c == '\'' || c == '"')) {
      quote = c;
    } else if (c == '\\' && quote != '\'' && i + 1 < line.size()) {
      const char next = line[i + 1];
      const bool is_escape = quote == 0 || next == '"' || next == '\\';
      words.back() += is_escape ? next : c;
      if (is_escape) ++i;
    } else {
      words.back() += c;
    }
  }
  if (quote != 0) {
    throw UsageError(std::string("a quote ") + quote + " is not closed in '" + std::string(line) +
                     "'");
  }
  return words;
}

std::string quote_shell_word(const std::string& word) {
  if (!word.empty() && word.find_first_of(" \t\n'\"\\") == std::string::npos) return word;
  std::string quoted = "'";
  for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

}  // namespace maide
