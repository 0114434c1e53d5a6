#include "maide/cli/line_reader.hpp"

#include <poll.h>
#include <unistd.h>

#include <array>
#include <cerrno>

namespace maide::cli {

std::optional<std::string> LineReader::next(const RunControl& control) {
  constexpr int most_milliseconds = 100;  // until it is seen that it is to stop
  while (!control.should_stop()) {
    const std::size_t end = read_.find('\n');
    if (end != std::string::npos || (is_at_end_ && !read_.empty())) {
      const std::string line = read_.substr(0, end);
      read_.erase(0, end == std::string::npos ? end : end + 1);
      return line;
    }
    if (is_at_end_) return std::nullopt;
    pollfd data{descriptor_, POLLIN, 0};
    if (::poll(&data, 1, most_milliseconds) <= 0) continue;  // nothing yet, or a signal
    std::array<char, 4096> buffer{};
    const ssize_t count = ::read(descriptor_, buffer.data(), buffer.size());
    if (count > 0) {
      read_.append(buffer.data(), static_cast<std::size_t>(count));
    } else if (count == 0 || (errno != EINTR && errno != EAGAIN)) {
      is_at_end_ = true;
    }
  }
  return std::nullopt;
}

}  // namespace maide::cli
