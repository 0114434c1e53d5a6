// The three answers to a question about a system.
#pragma once

#include <cstdint>
#include <string>

namespace maide {

enum class Verdict : std::uint8_t {
  holds,         // of all runs of the models
  violated,      // some run shows it
  inconclusive,  // a limit was reached, a run leaves what was learned, or a model is weak
};
std::string to_string(Verdict verdict);  // "holds"

}  // namespace maide
