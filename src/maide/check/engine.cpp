#include "maide/check/engine.hpp"

#include "maide/base/error.hpp"
#include "maide/check/native_engine.hpp"
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
  if (name == "native") return std::make_unique<NativeEngine>();
  throw UsageError("there is no engine '" + name + "'; there is: native, spin");
}

}  // namespace maide
