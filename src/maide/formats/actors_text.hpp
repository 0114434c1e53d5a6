// Actors in one attribute: "writer: ?write !written; reader: ?read !message". Names that hold white
// space, ':', ';' or '"' are quoted.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "maide/automata/mealy.hpp"

namespace maide {

std::string actors_to_text(std::span<const Actor> actors);
// Throws UsageError (without a place).
std::vector<Actor> actors_from_text(std::string_view text);

}  // namespace maide
