// POSIX calls, because std::ofstream cannot say why it failed, nor sync.
#include "maide/base/file.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <string>
#include <system_error>
#include <utility>

#include "maide/base/error.hpp"

namespace maide {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const char* what, int error, const fs::path& path) {
  throw_write_failure(std::string("cannot ") + what + " the file: " +
                          std::generic_category().message(error) + " (" + path.string() + ")",
                      error);
}

[[noreturn]] void refuse_to_read(const char* why, const fs::path& path) {
  throw UsageError(std::string("cannot read the file: ") + why + " (" + path.string() + ")");
}

// Returns 0 or the error number.
int write_all(int fd, std::string_view content) {
  while (!content.empty()) {
    const ssize_t count = ::write(fd, content.data(), content.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return errno;
    content.remove_prefix(static_cast<std::size_t>(count));
  }
  return 0;
}

// What `write` writes, into the open file.
void stream_into(const Descriptor& file, const fs::path& path,
                 const std::function<void(std::ostream& out)>& write) {
  ChunkedStream chunks([&](std::string_view piece) {
    if (const int error = write_all(file.get(), piece); error != 0) fail("write", error, path);
  });
  write(chunks.stream());
  chunks.finish();
}

// A new file beside `target`, which goes with this object unless it took the target's place. Not
// mkostemp, whose files are private whatever the umask, which cannot be asked for without changing
// it for all threads.
struct TemporaryFile {
  // `descriptor` is open, or errno says why not.
  explicit TemporaryFile(const fs::path& target) {
    static std::atomic<unsigned> counter{0};
    for (int attempt = 0; attempt < 1000; ++attempt) {
      path = target.string() + ".part-" + std::to_string(::getpid()) + "-" +
             std::to_string(counter.fetch_add(1));
      descriptor = Descriptor(::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666));
      if (descriptor.get() >= 0) return;
      if (errno != EEXIST) break;
    }
    path.clear();
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  ~TemporaryFile() {
    if (!path.empty()) ::unlink(path.c_str());
  }
  // Returns 0 or the error number.
  int become(const fs::path& target) {
    if (::rename(path.c_str(), target.c_str()) != 0) return errno;
    path.clear();
    return 0;
  }

  Descriptor descriptor;
  std::string path;
};

}  // namespace

std::string read_file(const fs::path& path, const RunControl& control) {
  // To open a pipe that nobody writes to yet would block else.
  Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  if (file.get() < 0) fail("read", errno, path);
  struct stat status {};
  if (::fstat(file.get(), &status) != 0) fail("read", errno, path);
  // Some devices never end.
  const bool is_device = S_ISBLK(status.st_mode) || S_ISCHR(status.st_mode);
  if (is_device && ::isatty(file.get()) == 0) refuse_to_read("it is a device", path);
  // What is there is read whatever the time is: a limit of time is for what is done with it.
  const bool may_wait = !S_ISREG(status.st_mode);
  constexpr int most_milliseconds = 100;  // until it is seen that a call is to stop
  std::string content;
  std::array<char, 65536> buffer{};
  for (;;) {
    if (may_wait) control.check("reading the file");
    pollfd data{file.get(), POLLIN, 0};
    if (::poll(&data, 1, most_milliseconds) <= 0) continue;  // nothing yet, or a signal
    const ssize_t count = ::read(file.get(), buffer.data(), buffer.size());
    if (count < 0 && (errno == EINTR || errno == EAGAIN)) continue;
    if (count < 0) fail("read", errno, path);
    if (count == 0) return content;
    content.append(buffer.data(), static_cast<std::size_t>(count));
  }
}

std::string read_regular_file(const fs::path& path) {
  std::error_code ignored;
  if (fs::is_other(path, ignored)) refuse_to_read("it is no regular file", path);
  return read_file(path);
}

void write_file_atomically(const fs::path& path, std::string_view content) {
  write_file_atomically(path, [&](std::ostream& out) { out << content; });
}

void write_file_atomically(const fs::path& path,
                           const std::function<void(std::ostream& out)>& write) {
  if (path.empty() || !path.has_filename()) fail("write", EISDIR, path);
  struct stat status {};
  const bool exists = ::stat(path.c_str(), &status) == 0;
  if (exists && S_ISDIR(status.st_mode)) fail("write", EISDIR, path);
  if (exists && !S_ISREG(status.st_mode)) {
    const Descriptor device(::open(path.c_str(), O_WRONLY | O_CLOEXEC));
    if (device.get() < 0) fail("write", errno, path);
    stream_into(device, path, write);
    return;
  }
  // A file that must not be written to is not to be replaced either, though the folder allows it.
  if (exists && ::access(path.c_str(), W_OK) != 0) fail("write", errno, path);
  std::error_code ignored;
  fs::path target = path;
  if (exists) target = fs::canonical(path, ignored);
  if (ignored) fail("write", ignored.value(), path);
  TemporaryFile file(target);
  if (file.descriptor.get() < 0) fail("write", errno, path);
  stream_into(file.descriptor, path, write);
  int error = 0;
  if (exists && ::fchmod(file.descriptor.get(), status.st_mode & 07777) != 0) error = errno;
  if (error == 0 && ::fsync(file.descriptor.get()) != 0) error = errno;
  if (const int close_error = file.descriptor.close(); error == 0) error = close_error;
  if (error == 0) error = file.become(target);
  if (error != 0) fail("write", error, path);
}

void check_can_write(const fs::path& path) {
  struct stat status {};
  const bool exists = !path.empty() && ::stat(path.c_str(), &status) == 0;
  if (path.empty() || !path.has_filename() || (exists && S_ISDIR(status.st_mode))) {
    fail("write", EISDIR, path);
  }
  if (exists && ::access(path.c_str(), W_OK) != 0) fail("write", errno, path);
  if (exists && !S_ISREG(status.st_mode)) return;
  std::error_code ignored;
  const fs::path target = exists ? fs::canonical(path, ignored) : path;
  const fs::path folder = target.has_parent_path() ? target.parent_path() : fs::path(".");
  if (::access(folder.c_str(), W_OK | X_OK) != 0) fail("write", errno, path);
  if (!fs::is_directory(folder, ignored)) fail("write", ENOTDIR, path);
}

bool is_same_file(const fs::path& left, const fs::path& right) {
  std::error_code error;
  if (fs::equivalent(left, right, error)) return true;
  const fs::path a = fs::weakly_canonical(left, error), b = fs::weakly_canonical(right, error);
  return !a.empty() && a == b;
}

Descriptor::Descriptor(Descriptor&& other) noexcept : value_(std::exchange(other.value_, -1)) {}

Descriptor& Descriptor::operator=(Descriptor&& other) noexcept {
  if (this != &other) {
    reset();
    value_ = std::exchange(other.value_, -1);
  }
  return *this;
}

void Descriptor::reset() {
  if (value_ >= 0) ::close(value_);
  value_ = -1;
}

int Descriptor::close() {
  const int value = std::exchange(value_, -1);
  return value < 0 || ::close(value) == 0 ? 0 : errno;
}

Pipe::Pipe() {
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0) {
    throw std::system_error(errno, std::generic_category(), "cannot make a pipe");
  }
  read_end = Descriptor(ends[0]);
  write_end = Descriptor(ends[1]);
}

// mkdtemp makes name and folder in one step, so that nobody can slip in between.
TempDir::TempDir(std::string_view prefix) {
  std::error_code error;
  std::filesystem::path parent = std::filesystem::temp_directory_path(error);
  if (error) parent = "/tmp";
  std::string name = (parent / prefix).string() + "XXXXXX";
  if (::mkdtemp(name.data()) == nullptr) {
    const int reason = errno;
    throw_write_failure("cannot make a temporary folder: " +
                            std::generic_category().message(reason) + " (" + parent.string() + ")",
                        reason);
  }
  path_ = name;
}

TempDir::~TempDir() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

namespace {
constexpr std::size_t piece_size = 65536;
}

ChunkedStream::ChunkedStream(Sink sink) : buffer_(std::move(sink)), stream_(&buffer_) {
  stream_.exceptions(std::ios::badbit);  // else the standard library swallows what the sink throws
}

ChunkedStream::Buffer::Buffer(Sink sink) : sink_(std::move(sink)), bytes_(piece_size) {
  setp(bytes_.data(), bytes_.data() + bytes_.size());
}

void ChunkedStream::Buffer::hand_on() {
  const std::string_view piece(pbase(), static_cast<std::size_t>(pptr() - pbase()));
  setp(bytes_.data(), bytes_.data() + bytes_.size());
  if (!piece.empty()) sink_(piece);
}

std::streambuf::int_type ChunkedStream::Buffer::overflow(int_type letter) {
  hand_on();
  if (!traits_type::eq_int_type(letter, traits_type::eof())) {
    *pptr() = traits_type::to_char_type(letter);
    pbump(1);
  }
  return traits_type::not_eof(letter);
}

}  // namespace maide
