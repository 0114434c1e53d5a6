#include "maide/automata/alphabet.hpp"

#include "maide/base/error.hpp"
#include "maide/base/hash.hpp"
#include "maide/base/named_table.hpp"

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

}  // namespace maide
