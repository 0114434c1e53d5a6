// What to say of a name that is unknown: the name that is near, or, if none is, all that are known.
// A list of fifteen names hides the one that was meant. Distance is that of base/text.hpp.
//
// Tables of named rows (algorithms, methods, formats) are looked up here, too, so that each unknown
// name gives the same message.
#pragma once

#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "maide/base/error.hpp"
#include "maide/base/text.hpp"

namespace maide {

// "; did you mean 'depth'?", or, if nothing is near, "; known are: history, depth". To be put
// behind an error message.
inline std::string near_or_known(std::string_view name, std::span<const std::string> known) {
  const std::string near = did_you_mean(name, known);
  return near.empty() ? "; known are: " + (known.empty() ? "none" : join(known)) : near;
}

// "unknown algorithm 'lsherp'; did you mean 'lsharp'?".
inline UsageError unknown_near_name(std::string_view what, std::string_view name,
                                    std::span<const std::string> known) {
  return UsageError("unknown " + std::string(what) + " '" + std::string(name) + "'" +
                    near_or_known(name, known));
}

// As find_row() (base/text.hpp), with that message. O(rows).
template <typename Row>
const Row& find_named_row(std::span<const Row> table, std::string_view what, std::string_view name,
                          std::initializer_list<std::string_view> besides = {}) {
  std::vector<std::string> known;
  for (const Row& row : table) {
    if (row.name == name) return row;
    known.emplace_back(row.name);
  }
  known.insert(known.end(), besides.begin(), besides.end());
  throw unknown_near_name(what, name, known);
}

}  // namespace maide
