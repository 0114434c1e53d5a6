// How charts are written to standard output.
#pragma once

#include "maide/report/sequence_chart.hpp"

namespace maide::cli {

// As wide as the terminal, and with lines where the environment has UTF-8.
ChartTextStyle chart_style();

}  // namespace maide::cli
