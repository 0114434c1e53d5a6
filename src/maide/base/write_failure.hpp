// What could not be written, as an error: a disk that is full is a limit of the machine, met half
// way (exit status 3, inconclusive); no permission, no such folder, a closed pipe are arguments
// that cannot be used (exit status 2).
#pragma once

#include <cerrno>
#include <string>

#include "maide/base/error.hpp"

namespace maide {

// Whether the errno says that there is no room: on the disk, in a quota, in a file.
inline bool is_out_of_space(int error) {
  return error == ENOSPC || error == EDQUOT || error == EFBIG;
}

[[noreturn]] inline void throw_write_failure(const std::string& message, int error) {
  if (is_out_of_space(error)) throw Error(ExitStatus::inconclusive, message);
  throw UsageError(message);
}

}  // namespace maide
