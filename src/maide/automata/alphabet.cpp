#include "maide/automata/alphabet.hpp"

#include <algorithm>
#include <utility>

#include "maide/base/error.hpp"
#include "maide/base/hash.hpp"
#include "maide/base/text.hpp"

namespace maide {

Alphabet::Alphabet(std::span<const std::string> names) {
  for (const std::string& name : names) {
    if (name.empty()) throw UsageError("a symbol of an alphabet has no name");
    if (find(name)) throw UsageError("'" + name + "' appears twice in an alphabet");
    intern(name);
  }
}

std::optional<Symbol> Alphabet::find(std::string_view name) const {
  const auto place = index_.find(name);
  if (place == index_.end()) return std::nullopt;
  return place->second;
}

Symbol Alphabet::at(std::string_view name, std::string_view what) const {
  if (const auto symbol = find(name)) return *symbol;
  throw unknown_name(what, name, names_);
}

Symbol Alphabet::intern(std::string_view name) {
  if (const auto symbol = find(name)) return *symbol;
  const auto symbol = static_cast<Symbol>(names_.size());
  names_.emplace_back(name);
  index_.emplace(names_.back(), symbol);
  return symbol;
}

std::string to_string(std::span<const Symbol> word, const Alphabet& alphabet) {
  std::string text;
  for (const Symbol symbol : word) {
    if (!text.empty()) text += ' ';
    text += alphabet.name(symbol);
  }
  return text;
}

std::size_t WordHash::operator()(const Word& word) const {
  std::uint64_t hash = hash_start;
  for (const Symbol symbol : word) hash = hash_step(hash, symbol);
  return hash;
}

Word joined(Word word, const Word& suffix) {
  word.insert(word.end(), suffix.begin(), suffix.end());
  return word;
}

Word head(const Word& word, std::size_t length) {
  return {word.begin(), word.begin() + static_cast<std::ptrdiff_t>(length)};
}

Word tail(const Word& word, std::size_t start) {
  return {word.begin() + static_cast<std::ptrdiff_t>(start), word.end()};
}

std::size_t count_common(std::span<const Symbol> left, std::span<const Symbol> right) {
  return static_cast<std::size_t>(std::ranges::mismatch(left, right).in1 - left.begin());
}

bool is_prefix(std::span<const Symbol> prefix, std::span<const Symbol> word) {
  return prefix.size() <= word.size() && std::equal(prefix.begin(), prefix.end(), word.begin());
}

// Sorted, a word comes right before one that goes on from it, if there is any.
std::vector<Word> without_prefixes(std::vector<Word> words) {
  std::ranges::sort(words);
  std::vector<Word> kept;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const bool goes_on = i + 1 < words.size() && is_prefix(words[i], words[i + 1]);
    if (!goes_on) kept.push_back(std::move(words[i]));
  }
  return kept;
}

}  // namespace maide
