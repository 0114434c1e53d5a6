#include "maide/cli/chart_style.hpp"

#include <unistd.h>

#include "maide/base/log.hpp"

namespace maide::cli {

ChartTextStyle chart_style() {
  ChartTextStyle style;
  style.unicode = is_utf8_locale();
  if (const auto width = terminal_width(STDOUT_FILENO)) style.width = *width;
  return style;
}

}  // namespace maide::cli
