#include "maide/report/graphviz.hpp"

#include <chrono>

#include "maide/base/subprocess.hpp"
#include "maide/workflow/wrapper_search.hpp"

namespace maide {

bool can_draw() { return find_on_path("dot").has_value(); }

std::string draw_svg(const std::string& dot, const RunControl& control) {
  if (!can_draw()) return "";
  SubprocessOptions options;
  options.input = dot;
  options.time_limit = std::chrono::seconds(20);
  const SubprocessResult drawn = run_program({"dot", "-Tsvg"}, options, control);
  const std::size_t begin = drawn.out.find("<svg");
  return drawn.succeeded() && begin != std::string::npos ? drawn.out.substr(begin) : "";
}

}  // namespace maide
