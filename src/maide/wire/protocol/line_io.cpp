#include "maide/wire/protocol/line_io.hpp"

#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <ctime>

#include "maide/wire/protocol/protocol.hpp"

namespace maide {
namespace {

// Keeps SIGPIPE from the calling thread while it writes to a pipe, and takes it back if it came.
class SigpipeBlock {
 public:
  SigpipeBlock() {
    sigset_t pending;
    ::sigpending(&pending);
    was_pending_ = ::sigismember(&pending, SIGPIPE) == 1;
    ::sigemptyset(&pipe_);
    ::sigaddset(&pipe_, SIGPIPE);
    ::pthread_sigmask(SIG_BLOCK, &pipe_, &before_);
  }
  ~SigpipeBlock() {
    const int error = errno;
    if (broke_ && !was_pending_) {
      const timespec now{};
      ::sigtimedwait(&pipe_, nullptr, &now);
    }
    ::pthread_sigmask(SIG_SETMASK, &before_, nullptr);
    errno = error;
  }
  SigpipeBlock(const SigpipeBlock&) = delete;
  SigpipeBlock& operator=(const SigpipeBlock&) = delete;
  void set_broke() { broke_ = true; }

 private:
  sigset_t pipe_{}, before_{};
  bool was_pending_ = false, broke_ = false;
};

ssize_t write_quietly(int descriptor, std::string_view bytes) {
  const ssize_t sent = ::send(descriptor, bytes.data(), bytes.size(), MSG_NOSIGNAL);
  if (sent >= 0 || errno != ENOTSOCK) return sent;
  SigpipeBlock block;
  const ssize_t written = ::write(descriptor, bytes.data(), bytes.size());
  if (written < 0 && errno == EPIPE) block.set_broke();
  return written;
}

}  // namespace

void LineSplitter::append(std::string_view bytes) {
  if (from_ > 0) {
    buffer_.erase(0, from_);
    scanned_ -= from_;
    from_ = 0;
  }
  buffer_ += bytes;
}

std::optional<std::string> LineSplitter::take_line() {
  const std::size_t end = buffer_.find('\n', scanned_);
  const std::size_t length = (end == std::string::npos ? buffer_.size() : end) - from_;
  if (length > protocol::max_line) {
    throw protocol::ProtocolError("a line is longer than " + std::to_string(protocol::max_line) +
                                  " bytes");
  }
  if (end == std::string::npos) {
    scanned_ = buffer_.size();
    return std::nullopt;
  }
  std::string line = buffer_.substr(from_, length);
  if (!line.empty() && line.back() == '\r') line.pop_back();
  from_ = scanned_ = end + 1;
  return line;
}

ReadResult read_some(int descriptor, std::string& bytes) {
  std::array<char, 65536> buffer;
  while (true) {
    const ssize_t count = ::read(descriptor, buffer.data(), buffer.size());
    if (count > 0) {
      bytes.assign(buffer.data(), static_cast<std::size_t>(count));
      return ReadResult::some;
    }
    if (count < 0 && errno == EINTR) continue;
    if (count < 0 && (errno == EAGAIN || errno == EWOULDBLOCK)) return ReadResult::nothing_yet;
    return ReadResult::ended;  // its end, or a connection that broke
  }
}

std::ptrdiff_t write_some(int descriptor, std::string_view bytes) {
  while (true) {
    const ssize_t count = write_quietly(descriptor, bytes);
    if (count >= 0) return count;
    if (errno == EINTR) continue;
    if (errno == EAGAIN || errno == EWOULDBLOCK) return 0;
    return -1;
  }
}

bool write_all(int descriptor, std::string_view bytes) {
  while (!bytes.empty()) {
    const std::ptrdiff_t count = write_some(descriptor, bytes);
    if (count < 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(count));
  }
  return true;
}

}  // namespace maide
