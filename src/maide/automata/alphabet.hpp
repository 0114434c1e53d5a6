// Symbols, words and alphabets, and what is done with words everywhere. A symbol is a number: its
// place in an alphabet. An alphabet is an ordered list of distinct names. Output alphabets grow as
// outputs are seen (`intern`). A symbol keeps its number.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace maide {

using Symbol = std::uint32_t;
using Word = std::vector<Symbol>;

class Alphabet {
 public:
  Alphabet() = default;
  // Throws UsageError if a name is empty or appears twice.
  explicit Alphabet(std::span<const std::string> names);
  Alphabet(std::initializer_list<std::string> names)
      : Alphabet(std::span<const std::string>(names.begin(), names.size())) {}

  std::size_t size() const { return names_.size(); }
  bool empty() const { return names_.empty(); }
  const std::string& name(Symbol symbol) const { return names_[symbol]; }
  const std::vector<std::string>& names() const { return names_; }

  // The symbol of this name, if there is one. O(1).
  std::optional<Symbol> find(std::string_view name) const;
  // The symbol of this name; throws UsageError "unknown <what> 'name'; known are: ...".
  Symbol at(std::string_view name, std::string_view what = "symbol") const;
  // The symbol of this name, added at the end if it is new. O(1).
  Symbol intern(std::string_view name);

  bool operator==(const Alphabet& other) const { return names_ == other.names_; }

 private:
  struct Hash {
    using is_transparent = void;
    std::size_t operator()(std::string_view text) const {
      return std::hash<std::string_view>{}(text);
    }
  };
  std::vector<std::string> names_;
  std::unordered_map<std::string, Symbol, Hash, std::equal_to<>> index_;
};

// The word's symbols by name, separated by single spaces; "" for the empty word.
std::string to_string(std::span<const Symbol> word, const Alphabet& alphabet);

// FNV-1a over the symbols: for hash tables keyed by words.
struct WordHash {
  std::size_t operator()(const Word& word) const;
};

// ---- Words ----

// `word`, then `suffix`.
Word joined(Word word, const Word& suffix);

// The first `length` symbols.
Word head(const Word& word, std::size_t length);

// From the symbol number `start` on.
Word tail(const Word& word, std::size_t start);

// Length of the longest common prefix. O(that length).
std::size_t count_common(std::span<const Symbol> left, std::span<const Symbol> right);

// Every word is a prefix of itself.
bool is_prefix(std::span<const Symbol> prefix, std::span<const Symbol> word);

// The words that are no prefixes of others, none twice; sorted. O(n log n) comparisons.
std::vector<Word> without_prefixes(std::vector<Word> words);

}  // namespace maide
