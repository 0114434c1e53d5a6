#include "maide/base/run_control.hpp"

#include <string>

#include "maide/base/error.hpp"

namespace maide {

void RunControl::check(std::string_view what) const {
  if (stop.stop_requested()) throw Interrupted(std::string(what) + " was interrupted");
  if (should_stop()) throw Interrupted(std::string(what) + " ran out of time");
}

}  // namespace maide
