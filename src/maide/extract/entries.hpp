// Everything that is reached: main, static initialisers, components, callbacks, threads. What else
// does something is a hole.
#pragma once

#include <set>
#include <string>

#include "maide/extract/api_table.hpp"
#include "maide/extract/model.hpp"
#include "maide/extract/sources.hpp"

namespace maide::extract {

// Reads all entries. Fields that turn out to have several values make it begin anew, so the cost
// is that of a pass for each of them at most.
Model read_entries(const Sources& sources, const ApiTable& table);

}  // namespace maide::extract
