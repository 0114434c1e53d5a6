// What a verdict rests on beside the search: how far models were learned and tested, what the
// system file says of places that were never tried, and fairness.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "maide/check/engines/engine.hpp"
#include "maide/check/search/search.hpp"
#include "maide/check/system/system.hpp"

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

// A select of a program's text that waits in vain: from some point of some run on its time-outs
// alone end it, because whatever happens then, none of its other arms can be taken again. One in
// all rounds of its loops and copies of its procedure.
struct LoneTimeOut {
  std::uint32_t program = 0;
  std::vector<ProgramEdge> arms;  // that are waited for in vain
};

// Some select has a time-out. O(steps of programs).
bool has_time_outs(const System& system);

// In the order of the programs and their texts. None if the limits end the search.
std::vector<LoneTimeOut> find_lone_time_outs(const System& system, const SearchLimits& limits);

// One line each.
struct StatedAssumptions {
  std::vector<std::string> lines;
  std::vector<std::string> doubts;           // those of them that say what is weak or not known
  std::map<std::string, std::string> brief;  // a short form of those that are long
};

// What verdicts on these properties rest on, with these results. `uses` are find_uses().
StatedAssumptions state_assumptions(const System& system, const std::vector<InputUse>& uses,
                                    const std::vector<Property>& properties,
                                    const std::vector<PropertyResult>& results);

}  // namespace maide
