// Tables of algorithms, methods and formats whose rows have a member `name`: what a user types
// finds its row, or an error that lists the others.
#pragma once

#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "maide/base/error.hpp"
#include "maide/base/join.hpp"

namespace maide {

// "unknown algorithm 'x'; known are: rs, lmplus".
inline UsageError unknown_name(std::string_view what, std::string_view name,
                               std::span<const std::string> known) {
  return UsageError("unknown " + std::string(what) + " '" + std::string(name) +
                    "'; known are: " + (known.empty() ? "none" : join(known)));
}

// The row of this name; throws unknown_name() if there is none. `besides` are names that a user may
// type, too, for that message. O(rows).
template <typename Row>
const Row& find_row(std::span<const Row> table, std::string_view what, std::string_view name,
                    std::initializer_list<std::string_view> besides = {}) {
  std::vector<std::string> known;
  for (const Row& row : table) {
    if (row.name == name) return row;
    known.emplace_back(row.name);
  }
  known.insert(known.end(), besides.begin(), besides.end());
  throw unknown_name(what, name, known);
}

}  // namespace maide
