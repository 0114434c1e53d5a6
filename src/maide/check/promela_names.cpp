#include "maide/check/promela_names.hpp"

#include <algorithm>
#include <utility>
#include <vector>

namespace maide {
namespace {

constexpr std::size_t longest_name = 40;  // of a name's bytes in its identifier

bool is_digit(char c) { return c >= '0' && c <= '9'; }

// What the text itself uses, what the translator of formulas reads, and what C makes of it.
std::vector<std::string_view> reserved_words() {
  const auto promela = promela_reserved();
  std::vector<std::string_view> words(promela.begin(), promela.end());
  words.insert(words.end(), {"InChannel", "OutChannel", "quiet", "event", "cut", "idling"});
  words.insert(words.end(), {"and", "or", "not", "next", "strong", "cond_expr", "R"});
  words.insert(words.end(), {"const", "define", "ifdef", "include"});
  return words;
}

// Labels with a meaning for SPIN, and the names of labels and macros of the text: s0, p0, is_cut.
// Of bytes that are not ASCII some are left out of identifiers, so they might hide one of these.
bool may_have_a_meaning(std::string_view word) {
  for (const std::string_view prefix : {"end", "accept", "progress", "T0", "is_cut", "never"}) {
    if (word.starts_with(prefix)) return true;
  }
  if (word.size() > 1 && (word[0] == 's' || word[0] == 'p') &&
      std::all_of(word.begin() + 1, word.end(), is_digit)) {
    return true;
  }
  return std::any_of(word.begin(), word.end(),
                     [](char c) { return static_cast<unsigned char>(c) >= 0x80; });
}

}  // namespace

PromelaNames::PromelaNames() : identifiers_(reserved_words()) {}

const std::string& PromelaNames::of(std::string_view prefix, std::string_view name) {
  const auto [entry, is_new] =
      known_.try_emplace({std::string(prefix), std::string(name)}, std::string());
  if (!is_new) return entry->second;
  std::string word = std::string(prefix) + std::string(name.substr(0, longest_name));
  if (may_have_a_meaning(word)) word.insert(0, "n_");
  return entry->second = identifiers_.unique(word);
}

}  // namespace maide
