// Lines that somebody types, or that come through a pipe.
#pragma once

#include <optional>
#include <string>

#include "maide/base/run_control.hpp"

namespace maide::cli {

class LineReader {
 public:
  // Of an open file, which it does not close.
  explicit LineReader(int descriptor) : descriptor_(descriptor) {}

  // The next line without its end. Nothing at the end of the input, or when `control` says stop,
  // which is seen while nothing comes, too.
  std::optional<std::string> next(const RunControl& control);

 private:
  int descriptor_;
  std::string read_;  // and not handed out
  bool is_at_end_ = false;
};

}  // namespace maide::cli
