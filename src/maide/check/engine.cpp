#include "maide/check/engine.hpp"

#include "maide/base/error.hpp"
#include "maide/check/spin_engine.hpp"

namespace maide {

std::string to_string(Verdict verdict) {
  switch (verdict) {
    case Verdict::holds: return "holds";
    case Verdict::violated: return "violated";
    case Verdict::inconclusive: return "inconclusive";
  }
  return "";
}

std::unique_ptr<Engine> make_engine(const std::string& name) {
  if (name == "spin") return std::make_unique<SpinEngine>();
  if (name == "native") throw UsageError("the engine native is not built yet: use --engine spin");
  throw UsageError("there is no engine '" + name + "'; there is: spin");
}

}  // namespace maide
