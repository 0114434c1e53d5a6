// What a verdict rests on beside the search: how far models were learned and tested, what the
// system file says of places that were never tried, and fairness.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "maide/check/explore/engine.hpp"
#include "maide/check/language/system.hpp"

namespace maide {

// A use of an input by some program: the first place of each.
struct InputUse {
  std::uint32_t model = 0;
  Symbol input = 0;
  const Program* program = nullptr;
  const ProgramEdge* edge = nullptr;
};

std::vector<InputUse> find_uses(const System& system);

// A call that really blocks, and whose return the model does not show; in words, with what to do.
std::optional<std::string> find_hidden_return(const System& system,
                                              const std::vector<InputUse>& uses);

// Why a "holds" is none, as far as that is because of weak models.
std::optional<std::string> find_weakness(const System& system);

// Callbacks whose code may go round for ever: what their threads and groups keep from starting then
// `stuck` does not look at. None if there are none. O(edges).
std::optional<std::string> find_endless_callbacks(const System& system);

// One line each.
struct StatedAssumptions {
  std::vector<std::string> lines;
  std::vector<std::string> doubts;           // those of them that say what is weak or not known
  std::map<std::string, std::string> brief;  // a short form of those that are long
};

// Of verdicts on these properties, with these results. `uses` are find_uses().
StatedAssumptions state_assumptions(const System& system, const std::vector<InputUse>& uses,
                                    const std::vector<Property>& properties,
                                    const std::vector<PropertyResult>& results);

}  // namespace maide
