#include "maide/check/engines/verdict.hpp"

#include <string>

namespace maide {

std::string to_string(Verdict verdict) {
  switch (verdict) {
    case Verdict::holds: return "holds";
    case Verdict::violated: return "violated";
    case Verdict::inconclusive: return "inconclusive";
  }
  return "";
}

}  // namespace maide
