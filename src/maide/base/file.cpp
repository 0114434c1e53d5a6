// POSIX calls, because std::ofstream cannot say why it failed, nor sync.
#include "maide/base/file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <system_error>

#include "maide/base/descriptor.hpp"
#include "maide/base/error.hpp"

namespace maide {

namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const char* what, int error, const fs::path& path) {
  throw UsageError(std::string("cannot ") + what + " the file: " +
                   std::generic_category().message(error) + " (" + path.string() + ")");
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

void write_directly(const fs::path& path, std::string_view content) {
  Descriptor file(::open(path.c_str(), O_WRONLY | O_CLOEXEC));
  if (file.get() < 0) fail("write", errno, path);
  if (const int error = write_all(file.get(), content); error != 0) fail("write", error, path);
  if (const int error = file.close(); error != 0) fail("write", error, path);
}

// A new file beside `target`; `path` is set to its name. Not mkostemp, whose files are private
// whatever the umask, which cannot be asked for without changing it for all threads. Returns a
// descriptor, or -1 with errno.
int make_temporary(const fs::path& target, std::string& path) {
  static std::atomic<unsigned> counter{0};
  for (int attempt = 0; attempt < 1000; ++attempt) {
    path = target.string() + ".part-" + std::to_string(::getpid()) + "-" +
           std::to_string(counter.fetch_add(1));
    const int file = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (file >= 0 || errno != EEXIST) return file;
  }
  return -1;
}

}  // namespace

std::string read_file(const fs::path& path) {
  Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  if (file.get() < 0) fail("read", errno, path);
  std::string content;
  std::array<char, 65536> buffer{};
  for (;;) {
    const ssize_t count = ::read(file.get(), buffer.data(), buffer.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) fail("read", errno, path);
    if (count == 0) return content;
    content.append(buffer.data(), static_cast<std::size_t>(count));
  }
}

void write_file_atomically(const fs::path& path, std::string_view content) {
  if (path.empty() || !path.has_filename()) fail("write", EISDIR, path);
  struct stat status {};
  const bool exists = ::stat(path.c_str(), &status) == 0;
  if (exists && S_ISDIR(status.st_mode)) fail("write", EISDIR, path);
  if (exists && !S_ISREG(status.st_mode)) {
    write_directly(path, content);
    return;
  }
  // A file that must not be written to is not to be replaced either, though the folder allows it.
  if (exists && ::access(path.c_str(), W_OK) != 0) fail("write", errno, path);
  std::error_code ignored;
  fs::path target = path;
  if (exists) target = fs::canonical(path, ignored);
  if (ignored) fail("write", ignored.value(), path);

  std::string temporary;
  Descriptor file(make_temporary(target, temporary));
  if (file.get() < 0) fail("write", errno, path);
  int error = write_all(file.get(), content);
  if (error == 0 && exists && ::fchmod(file.get(), status.st_mode & 07777) != 0) error = errno;
  if (error == 0 && ::fsync(file.get()) != 0) error = errno;
  if (const int close_error = file.close(); error == 0) error = close_error;
  if (error == 0 && ::rename(temporary.c_str(), target.c_str()) != 0) error = errno;
  if (error != 0) {
    ::unlink(temporary.c_str());
    fail("write", error, path);
  }
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

}  // namespace maide
