#include "maide/check/reduce/reduction_kind.hpp"

#include <string>
#include <vector>

#include "maide/base/error.hpp"
#include "maide/base/text.hpp"

namespace maide {

std::string to_string(Reduction reduction) {
  switch (reduction) {
    case Reduction::none: return "none";
    case Reduction::calls: return "calls";
    case Reduction::order: return "order";
    case Reduction::full: return "full";
  }
  return "";
}

Reduction reduction_of(const std::string& name) {
  std::vector<std::string> known;
  for (const Reduction reduction :
       {Reduction::none, Reduction::calls, Reduction::order, Reduction::full}) {
    known.emplace_back(to_string(reduction));
    if (known.back() == name) return reduction;
  }
  throw UsageError("there is no reduction '" + name + "'; there is: " + join(known) +
                   did_you_mean(name, known));
}

bool merges_calls(Reduction reduction) {
  return reduction == Reduction::calls || reduction == Reduction::full;
}

bool leaves_out_orders(Reduction reduction) {
  return reduction == Reduction::order || reduction == Reduction::full;
}

}  // namespace maide
